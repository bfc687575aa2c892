-- What of an SVG file's styles matters to a light: whether a shape is seen, and in what colour.
-- Read from attributes, `style` and rules for one tag, class or id; the rest is said.
local M = {}

local INHERITED = { "stroke", "fill", "visibility", "color", "stroke-dasharray" }

local function declarations_of(text, into)
  for declaration in (text .. ";"):gmatch("([^;]*);") do
    local name, value = declaration:match("^%s*([%w%-]+)%s*:%s*(.-)%s*$")
    if name then into[name] = value:gsub("%s*!important$", "") end
  end
  return into
end

-- Rules of all <style> elements, in order: { selector =, declarations = }. `note(line, what)` hears
-- of selectors that are not read.
function M.rules(root, note)
  local rules = {}
  local function visit(element)
    if element.name == "style" then
      local text = element.text:gsub("/%*.-%*/", "")
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
    if own[name] == nil or own[name] == "inherit" then own[name] = parent[name] end
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

-- How a shape is seen: "stroke", "fill" (no line, a filled face) or nil.
function M.seen_by(style)
  if style.visibility == "hidden" or style.visibility == "collapse" then return nil end
  local stroke, fill = style.stroke or "none", style.fill or "black"
  if stroke ~= "none" and stroke ~= "transparent" and not zero(style["stroke-opacity"])
     and not zero(style["stroke-width"] and style["stroke-width"]:gsub("%a+$", "")) then
    return "stroke"
  end
  if fill ~= "none" and fill ~= "transparent" and not zero(style["fill-opacity"]) then
    return "fill"
  end
  return nil
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
