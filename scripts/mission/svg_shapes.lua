-- SPDX-License-Identifier: Apache-2.0
-- Shapes of an SVG picture as path data, and its transforms as matrices.
local path = require "mission.svg_path"

local M = {}

M.IDENTITY = { 1, 0, 0, 1, 0, 0 }  -- a b c d e f: x' = a x + c y + e, y' = b x + d y + f

-- User units in one of a length's unit, at the 96 to an inch of SVG.
local UNITS = { [""] = 1, px = 1, ["in"] = 96, cm = 96 / 2.54, mm = 96 / 25.4, pt = 96 / 72,
                pc = 16 }

function M.times(m, n)
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

-- How many numbers each takes: either of two counts.
local COUNTS = { matrix = { 6, 6 }, translate = { 1, 2 }, scale = { 1, 2 }, rotate = { 1, 3 },
                 skewX = { 1, 1 }, skewY = { 1, 1 } }

function M.transform(text)
  local matrix = M.IDENTITY
  local rest = text or ""
  while rest:find("(", 1, true) do
    local open, close = rest:find("(", 1, true), rest:find(")", 1, true)
    if not close then error("transform '" .. rest .. "' lacks its ')'", 0) end
    local before = rest:sub(1, open - 1)
    local name = before:match("^[%s,]*(%a+)%s*$")
    local make = TRANSFORMS[name] or error("unknown transform '" .. before .. "'", 0)
    local given, few, many = numbers_of(rest:sub(open + 1, close - 1)), table.unpack(COUNTS[name])
    if #given ~= few and #given ~= many then
      error(("transform %s: expected %s numbers, got %d"):format(
        name, few == many and few or few .. " or " .. many, #given), 0)
    end
    matrix = M.times(matrix, make(given))
    rest = rest:sub(close + 1)
  end
  if rest:find("[^%s,]") then
    error("transform '" .. rest .. "' has no numbers in parentheses", 0)
  end
  return matrix
end

-- A length in user units; `default` where it is absent.
function M.length(a, key, default)
  if a[key] == nil then return default end
  local number, unit = a[key]:match("^%s*([+-]?[%d%.]+[eE]?[+-]?%d*)%s*(%a*)%s*$")
  local value = tonumber(number)
  if value and UNITS[unit] then return value * UNITS[unit] end
  if a[key]:find("%", 1, true) then
    error(("%s is '%s': percentages are not read; write a number"):format(key, a[key]), 0)
  end
  error(("%s is '%s': expected a number, or one with px, in, cm, mm, pt or pc")
        :format(key, a[key]), 0)
end

local function rectangle(a)
  local x, y = M.length(a, "x", 0), M.length(a, "y", 0)
  local w, h = M.length(a, "width", 0), M.length(a, "height", 0)
  if w < 0 or h < 0 then error("width and height must not be below 0", 0) end
  if w == 0 or h == 0 then return nil end
  local rx, ry = M.length(a, "rx"), M.length(a, "ry")
  rx, ry = math.min(rx or ry or 0, w / 2), math.min(ry or rx or 0, h / 2)
  if rx <= 0 or ry <= 0 then return ("M%.9g,%.9g h%.9g v%.9g h%.9g Z"):format(x, y, w, h, -w) end
  local corner = ("a%.9g,%.9g 0 0 1 "):format(rx, ry)
  return ("M%.9g,%.9g h%.9g %s%.9g,%.9g v%.9g %s%.9g,%.9g h%.9g %s%.9g,%.9g v%.9g %s%.9g,%.9g Z")
         :format(x + rx, y, w - 2 * rx, corner, rx, ry, h - 2 * ry, corner, -rx, ry, 2 * rx - w,
                 corner, -rx, -ry, 2 * ry - h, corner, rx, -ry)
end

local function ellipse(a, key_x, key_y)
  local rx, ry = M.length(a, key_x, 0), M.length(a, key_y, 0)
  if rx < 0 or ry < 0 then error("its radius must not be below 0", 0) end
  if rx == 0 or ry == 0 then return nil end
  return ("M%.9g,%.9g a%.9g,%.9g 0 1 1 %.9g,0 a%.9g,%.9g 0 1 1 %.9g,0")
         :format(M.length(a, "cx", 0) - rx, M.length(a, "cy", 0), rx, ry, 2 * rx, rx, ry, -2 * rx)
end

-- Path data of each shape, from its attributes; nil of one without a size, which SVG does not draw.
M.data = {
  path = function(a) return a.d or "" end,
  line = function(a)
    return ("M%.9g,%.9g L%.9g,%.9g"):format(M.length(a, "x1", 0), M.length(a, "y1", 0),
                                            M.length(a, "x2", 0), M.length(a, "y2", 0))
  end,
  polyline = function(a) return (a.points or ""):match("%S") and "M" .. a.points or "" end,
  polygon = function(a) return (a.points or ""):match("%S") and "M" .. a.points .. "Z" or "" end,
  rect = rectangle,
  circle = function(a) return ellipse(a, "r", "r") end,
  ellipse = function(a) return ellipse(a, "rx", "ry") end,
}

-- A length of a root, or nil where it says none: shares and other units are the window's.
local function stated(a, key)
  local good, value = pcall(M.length, a, key)
  return good and value and value > 0 and value or nil
end

local SHARES = { Min = 0, Mid = 0.5, Max = 1 }

-- What the root <svg> shows, { left, top, right, bottom } in its own units; nil where it states
-- neither a viewBox nor a size. A window of another shape than the viewBox shows more of it.
function M.frame(a)
  local good, box = pcall(numbers_of, a.viewBox or "")
  local w, h = stated(a, "width"), stated(a, "height")
  if not good or #box ~= 4 or box[3] <= 0 or box[4] <= 0 then
    if not w and not h then return nil end
    return { 0, 0, w or math.huge, h or math.huge }
  end
  local x, y, seen_w, seen_h = table.unpack(box)
  local fit = a.preserveAspectRatio or "xMidYMid"
  if w and h and not fit:find("none", 1, true) then
    local nearest = fit:find("slice", 1, true) and math.max or math.min
    local scale = nearest(w / seen_w, h / seen_h)
    local at_x, at_y = fit:match("x(M%a%a)Y(M%a%a)")
    x = x - (w / scale - seen_w) * (SHARES[at_x] or 0.5)
    y = y - (h / scale - seen_h) * (SHARES[at_y] or 0.5)
    seen_w, seen_h = w / scale, h / scale
  end
  return { x, y, x + seen_w, y + seen_h }
end

-- From the units within a viewBox to those around it: <svg> and <symbol> with a size. The picture
-- is fitted in and stands in the middle, as SVG has it where nothing else is said.
function M.viewport(a, size)
  local place = { 1, 0, 0, 1, M.length(a, "x", 0), M.length(a, "y", 0) }
  local box = a.viewBox and numbers_of(a.viewBox)
  if not box then return place end
  if #box ~= 4 or box[3] <= 0 or box[4] <= 0 then error("viewBox: expected four numbers", 0) end
  local w, h = M.length(size, "width", box[3]), M.length(size, "height", box[4])
  local scale = math.min(w / box[3], h / box[4])
  return M.times(place, { scale, 0, 0, scale, (w - scale * box[3]) / 2 - scale * box[1],
                          (h - scale * box[4]) / 2 - scale * box[2] })
end

return M
