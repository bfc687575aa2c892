-- SPDX-License-Identifier: Apache-2.0
-- An SVG file as a tree: { name =, attributes =, line =, children = { ... }, text = } per element.
-- Names lose an `svg:` before them; entities of XML itself are read, those of a file's own are not.
local M = {}

local ENTITIES = { lt = "<", gt = ">", amp = "&", quot = '"', apos = "'" }

local function entity(name)
  if ENTITIES[name] then return ENTITIES[name] end
  local code = name:match("^#(%d+)$") or name:match("^#x(%x+)$") and "0x" .. name:sub(3)
  code = tonumber(code)
  return code and code < 0x110000 and utf8.char(code) or nil
end

local LONGEST_NAME = 200  -- characters, with the '=' and the quote

-- name="value" pairs of a tag.
local function attributes_of(text)
  local a, at = {}, text:find("%S")
  while at do
    -- Patterns read no more than a name can be: path data may be long.
    local head = text:sub(at, at + LONGEST_NAME)
    local name, equals = head:match("^([^%s=<>\"'/]+)()")
    local quote, first
    if name then quote, first = head:match("^%s*=%s*([\"'])()", equals) end
    if not quote then
      error(("an attribute is no name=\"value\": '%s'"):format(
        head:sub(1, 40):match("^(.-)%s*$")), 0)
    end
    first = at + first - 1
    local close = text:find(quote, first, true)
    if not close then error("an attribute lacks its closing quote", 0) end
    local value = text:sub(first, close - 1)
    if value:find("&", 1, true) then value = value:gsub("&([%w#]+);", entity) end
    a[name] = value
    at = text:find("%S", close + 1)
  end
  return a
end

-- The '>' that ends the tag, outside of quotes.
local function tag_end(text, at)
  while true do
    local found = text:find("[\"'>]", at)
    if not found or text:sub(found, found) == ">" then return found end
    local close = text:find(text:sub(found, found), found + 1, true)
    if not close then return nil end
    at = close + 1
  end
end

-- What begins with `open` and ends with `close` is passed over: comments, CDATA, instructions.
local PASSED = { { "<!--", "-->" }, { "<![CDATA[", "]]>" }, { "<?", "?>" } }

local function passed_end(text, open)
  for _, pair in ipairs(PASSED) do
    if text:sub(open, open + #pair[1] - 1) == pair[1] then
      local _, close = text:find(pair[2], open + #pair[1], true)
      return close or error("the file ends within " .. pair[1], 0), true
    end
  end
  if text:sub(open + 1, open + 1) == "!" then return tag_end(text, open), true end
  return tag_end(text, open), false
end

-- Lines of the file, asked for from front to back.
local function line_counter(text)
  local line, at = 1, 1
  return function(to)
    while true do
      local found = text:find("\n", at, true)
      if not found or found >= to then return line end
      line, at = line + 1, found + 1
    end
  end
end

-- The root: the element <svg>, or whatever comes first.
function M.read(text)
  local top = { name = "", attributes = {}, children = {}, line = 1, text = "" }
  local open_elements, at, line_at = { top }, 1, line_counter(text)
  while true do
    local open = text:find("<", at, true)
    if not open then break end
    local parent, line = open_elements[#open_elements], line_at(open)
    parent.text = parent.name == "style" and parent.text .. text:sub(at, open - 1) or ""
    local close, passed = passed_end(text, open)
    if not close then error("line " .. line .. ": the file ends within a tag", 0) end
    if passed and parent.name == "style" then
      parent.text = parent.text .. text:sub(open, close):gsub("^<!%[CDATA%[", ""):gsub("%]%]>$", "")
    elseif not passed then
      local inside = text:sub(open + 1, close - 1)
      local closing, empty = inside:sub(1, 1) == "/", inside:sub(-1) == "/"
      if closing then inside = inside:sub(2) end
      if empty then inside = inside:sub(1, -2) end
      local name = inside:match("^[%w:_%-%.]+") or ""
      local plain = name:gsub("^svg:", "")
      if closing then
        if #open_elements == 1 or parent.name ~= plain then
          error(("line %d: </%s> has no opening tag"):format(line, name), 0)
        end
        table.remove(open_elements)
      else
        local good, attributes = pcall(attributes_of, inside:sub(#name + 1))
        if not good then error(("line %d: %s"):format(line, attributes), 0) end
        local element = { name = plain, attributes = attributes, children = {}, line = line,
                          text = "" }
        parent.children[#parent.children + 1] = element
        if not empty then
          if #open_elements > 60 then
            error(("line %d: elements are nested more than 60 deep"):format(line), 0)
          end
          open_elements[#open_elements + 1] = element
        end
      end
    end
    at = close + 1
  end
  if #open_elements > 1 then
    local last = open_elements[#open_elements]
    error(("line %d: <%s> is not closed"):format(last.line, last.name), 0)
  end
  return top
end

return M
