-- SPDX-License-Identifier: Apache-2.0
-- The styles of an SVG file, as far as a light can show them: visibility and colour of a shape.
-- They are read from attributes, `style` and rules for one tag, class or id. Notes list the rest.
local M = {}

local INHERITED = { "stroke", "fill", "visibility", "color", "stroke-dasharray", "stroke-width",
                    "stroke-opacity", "fill-opacity" }

local function declarations_of(text, into)
  for declaration in (text .. ";"):gmatch("([^;]*);") do
    local name, value = declaration:match("^%s*([%w%-]+)%s*:%s*(.-)%s*$")
    if name then into[name] = value:gsub("%s*!important$", "") end
  end
  return into
end

-- A style sheet with the rules of `@media screen` as rules like others. Rules that hold elsewhere
-- are said; fonts and moves of a picture are no matter of a light.
local function conditions(text, line, note)
  local kept, at = {}, 1
  while true do
    local found = text:find("@", at, true)
    kept[#kept + 1] = text:sub(at, (found or 0) - 1)
    if not found then return table.concat(kept) end
    local stop = text:match("^[^{};]*()", found)
    local head = text:sub(found, stop - 1):gsub("%s+", " "):gsub(" $", "")
    if text:sub(stop, stop) == "{" then
      local body = text:match("^%b{}", stop) or text:sub(stop)
      at = stop + #body
      if head == "@media screen" or head == "@media all" then
        kept[#kept + 1] = body:sub(2, -2)
      elseif head:find("^@media") or head:find("^@supports") then
        note(line, ("the style rules of '%s' are not read"):format(head:sub(1, 40)))
      end
    else
      at = stop + 1
    end
  end
end

-- Rules of all <style> elements, in order: { selector =, declarations = }. `note(line, what)` hears
-- of selectors that are not read.
function M.rules(root, note)
  local rules = {}
  local function visit(element)
    if element.name == "style" then
      local text = conditions(element.text:gsub("/%*.-%*/", ""), element.line, note)
      for selectors, body in text:gmatch("([^{}]*){([^{}]*)}") do
        local declarations = declarations_of(body, {})
        for selector in (selectors .. ","):gmatch("%s*(.-)%s*,") do
          if selector:match("^[%.#]?[%w_%-]+$") or selector == "*" then
            rules[#rules + 1] = { selector = selector, declarations = declarations }
          elseif selector ~= "" then
            note(element.line, ("the style rule '%s' is not read"):format(selector:sub(1, 40)))
          end
        end
      end
    end
    for _, child in ipairs(element.children) do visit(child) end
  end
  visit(root)
  return rules
end

local function applies(selector, element)
  if selector == "*" or selector == element.name then return true end
  local kind, name = selector:sub(1, 1), selector:sub(2)
  if kind == "#" then return element.attributes.id == name end
  if kind ~= "." then return false end
  for class in (element.attributes.class or ""):gmatch("%S+") do
    if class == name then return true end
  end
  return false
end

-- Ranks of selectors: a tag gives way to a class, a class to an id.
local RANKS = { ["."] = 2, ["#"] = 3 }

-- The properties of an element, its parent's inherited ones below its own.
function M.of(element, parent, rules)
  local own = {}
  for name, value in pairs(element.attributes) do own[name] = value end
  for rank = 1, 3 do
    for _, rule in ipairs(rules) do
      if (RANKS[rule.selector:sub(1, 1)] or 1) == rank and applies(rule.selector, element) then
        for name, value in pairs(rule.declarations) do own[name] = value end
      end
    end
  end
  if element.attributes.style then declarations_of(element.attributes.style, own) end
  for _, name in ipairs(INHERITED) do
    if own[name] == nil or own[name] == "inherit" then
      own[name] = parent[name]
      if name == "stroke" then own.stroke_from = parent.stroke_from end
    end
  end
  return own
end

local function zero(text)
  return tonumber((text or "1"):match("^%s*([%d%.eE+-]+)%%?%s*$")) == 0
end

-- Whether an element, with all in it, is not shown at all.
function M.hidden(style)
  return style.display == "none" or zero(style.opacity)
end

-- Elements that a url(#...) may paint with.
local SERVERS = { linearGradient = true, radialGradient = true, pattern = true, solidColor = true,
                  meshgradient = true, hatch = true }

-- Whether a colour's alpha is 0: #rgba, #rrggbbaa, rgba(r, g, b, a), rgb(r g b / a), hsl likewise.
local function clear(colour)
  local digits = colour:match("^#(%x+)$")
  if digits then
    return #digits == 4 and digits:sub(4) == "0" or #digits == 8 and digits:sub(7) == "00"
  end
  local inside = colour:match("^%a+%((.*)%)$")
  if not inside then return false end
  local alpha = inside:match("/([^/]*)$") or inside:match("^[^,]*,[^,]*,[^,]*,([^,]*)$")
  return alpha ~= nil and zero(alpha)
end

-- Whether a `stroke` or `fill` shows. `named` are the file's elements by id; `missing(reference)`
-- hears of what a url(...) names and the file has not.
local function shows(paint, style, named, missing)
  paint = paint:match("^%s*(.-)%s*$")
  local plain = paint:lower()
  if plain == "none" or plain == "transparent" then return false end
  if plain == "currentcolor" then
    local colour = style.color or "black"
    return colour:lower() ~= "currentcolor" and shows(colour, style, named, missing)
  end
  local reference, instead = paint:match("^[uU][rR][lL]%(%s*[\"']?(.-)[\"']?%s*%)%s*(.*)$")
  if reference then
    local server = named[reference:match("^#(.+)$") or ""]
    if server and SERVERS[server.name] then return true end
    missing(reference)
    return instead ~= "" and shows(instead, style, named, missing)
  end
  return not clear(plain)
end

-- Whether a shape is made invisible together with its place in the picture.
function M.invisible(style)
  return style.visibility == "hidden" or style.visibility == "collapse"
end

-- How a shape is seen: "stroke", "fill" (no line, a filled face) or nil. `named` and `missing` are
-- those of `shows`.
function M.seen_by(style, named, missing)
  local stroke, fill = style.stroke or "none", style.fill or "black"
  if not zero(style["stroke-opacity"]) and M.line_width(style) ~= 0
     and shows(stroke, style, named, missing) then
    return "stroke"
  end
  if not zero(style["fill-opacity"]) and shows(fill, style, named, missing) then return "fill" end
  return nil
end

-- The width of a shape's line in its own units; 1 where it is not a number.
function M.line_width(style)
  local text = (style["stroke-width"] or "1"):gsub("[%a%%]+%s*$", "")
  return tonumber(text) or 1
end

local BLACK = { black = true, ["#000"] = true, ["#000000"] = true, currentColor = true,
                ["rgb(0,0,0)"] = true }

-- The colour of a shape's line where it is another than black.
function M.colour(style)
  local colour = (style.stroke or "none"):gsub("%s", "")
  if colour == "currentColor" then colour = (style.color or "black"):gsub("%s", "") end
  if colour == "none" or BLACK[colour] or BLACK[colour:lower()] then return nil end
  return colour
end

return M
