-- Paths of an SVG picture as strokes: lists of {x, y}, y down as in the file. All path commands,
-- basic shapes, transforms of elements and groups; curves become short straight pieces.
local path = require "mission.svg_path"

local M = {}

local IDENTITY = { 1, 0, 0, 1, 0, 0 }  -- a b c d e f: x' = a x + c y + e, y' = b x + d y + f

local function times(m, n)
  return { m[1] * n[1] + m[3] * n[2], m[2] * n[1] + m[4] * n[2],
           m[1] * n[3] + m[3] * n[4], m[2] * n[3] + m[4] * n[4],
           m[1] * n[5] + m[3] * n[6] + m[5], m[2] * n[5] + m[4] * n[6] + m[6] }
end

local function numbers_of(text)
  local r, list = path.reader(text), {}
  while not r.done() do list[#list + 1] = r.number() end
  return list
end

local TRANSFORMS = {
  matrix = function(n) return n end,
  translate = function(n) return { 1, 0, 0, 1, n[1], n[2] or 0 } end,
  scale = function(n) return { n[1], 0, 0, n[2] or n[1], 0, 0 } end,
  rotate = function(n)
    local c, s = math.cos(math.rad(n[1])), math.sin(math.rad(n[1]))
    local x, y = n[2] or 0, n[3] or 0
    return { c, s, -s, c, x - c * x + s * y, y - s * x - c * y }
  end,
  skewX = function(n) return { 1, 0, math.tan(math.rad(n[1])), 1, 0, 0 } end,
  skewY = function(n) return { 1, math.tan(math.rad(n[1])), 0, 1, 0, 0 } end,
}

local function transform_of(text)
  local matrix = IDENTITY
  local rest = text or ""
  while rest:find("(", 1, true) do
    local open, close = rest:find("(", 1, true), rest:find(")", 1, true)
    if not close then error("transform '" .. rest .. "' lacks its ')'") end
    local name = rest:sub(1, open - 1):match("%a+")
    local make = TRANSFORMS[name] or error("unknown transform '" .. tostring(name) .. "'")
    local given = numbers_of(rest:sub(open + 1, close - 1))
    if #given < (name == "matrix" and 6 or 1) then
      error("transform " .. name .. " lacks numbers")
    end
    matrix = times(matrix, make(given))
    rest = rest:sub(close + 1)
  end
  return matrix
end

-- Basic shapes as path data.
local function shape_data(name, a)
  local function n(key)
    return tonumber(a[key] or 0)
      or error(("%s: %s is '%s', expected a plain number"):format(name, key, a[key]))
  end
  local function positive(key)
    return n(key) > 0 and n(key) or error(("%s: %s must be above 0"):format(name, key))
  end
  if name == "line" then
    return ("M%f,%f L%f,%f"):format(n "x1", n "y1", n "x2", n "y2")
  elseif name == "polyline" or name == "polygon" then
    return "M" .. (a.points or "") .. (name == "polygon" and "Z" or "")
  elseif name == "rect" then
    if n "rx" ~= 0 or n "ry" ~= 0 then error("rect: rounded corners are not read; use a path") end
    return ("M%f,%f h%f v%f h%f Z"):format(n "x", n "y", positive "width", positive "height",
                                           -n "width")
  elseif name == "circle" or name == "ellipse" then
    local rx = positive(name == "circle" and "r" or "rx")
    local ry = name == "circle" and rx or positive "ry"
    return ("M%f,%f a%f,%f 0 1 1 %f,0 a%f,%f 0 1 1 %f,0"):format(n "cx" - rx, n "cy", rx, ry,
                                                                   2 * rx, rx, ry, -2 * rx)
  end
end

-- name="value" pairs of a tag.
local function attributes_of(text)
  local a, at = {}, 1
  while true do
    local equals = text:find("=", at, true)
    if not equals then return a end
    local quote_at = text:find("[\"']", equals)
    if not quote_at then return a end
    local close = text:find(text:sub(quote_at, quote_at), quote_at + 1, true)
    if not close then error("an attribute lacks its closing quote") end
    local words = text:sub(at, equals - 1)
    a[words:match("[%w:_%-]+", 1) or ""] = text:sub(quote_at + 1, close - 1)
    at = close + 1
  end
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

-- Calls f(closing, name, attributes, empty) for every tag.
local function for_each_tag(text, f)
  local at = 1
  while true do
    local open = text:find("<", at, true)
    if not open then return end
    local comment = text:sub(open, open + 3) == "<!--"
    local close = comment and text:find("-->", open, true) or tag_end(text, open)
    if not close then error("the file ends within a tag") end
    if comment then
      close = close + 2
    elseif not text:match("^<[!?]", open) then
      local inside = text:sub(open + 1, close - 1)
      local closing, empty = inside:sub(1, 1) == "/", inside:sub(-1) == "/"
      if closing then inside = inside:sub(2) end
      if empty then inside = inside:sub(1, -2) end
      local name = inside:match("^[%w:_%-]+") or ""
      f(closing, name, closing and {} or attributes_of(inside:sub(#name + 1)), empty)
    end
    at = close + 1
  end
end

local HIDDEN = { defs = true, clipPath = true, mask = true, symbol = true }

-- Strokes of a whole picture.
function M.strokes(text)
  local strokes, stack, hides, hidden = {}, { IDENTITY }, {}, 0
  for_each_tag(text, function(closing, name, a, empty)
    if closing then
      if #stack > 1 then table.remove(stack) end
      if table.remove(hides) then hidden = hidden - 1 end
      return
    end
    local matrix = times(stack[#stack], transform_of(a.transform))
    local hide = HIDDEN[name] or a.display == "none" or a.visibility == "hidden"
                 or (a.style or ""):gsub("%s", ""):find("display:none", 1, true)
    if name == "use" and hidden == 0 and not hide then
      error("<use> is not read; write the path itself")
    end
    local data = not hide and (name == "path" and a.d or shape_data(name, a))
    for _, stroke in ipairs(data and hidden == 0 and path.strokes(data) or {}) do
      for i, p in ipairs(stroke) do
        stroke[i] = { matrix[1] * p[1] + matrix[3] * p[2] + matrix[5],
                      matrix[2] * p[1] + matrix[4] * p[2] + matrix[6] }
      end
      strokes[#strokes + 1] = stroke
    end
    if not empty then
      stack[#stack + 1] = matrix
      hides[#hides + 1] = hide and true or false
      if hide then hidden = hidden + 1 end
    end
  end)
  return strokes
end

return M
