-- SPDX-License-Identifier: Apache-2.0
-- The strokes of a drawing, from a text, an SVG picture or points: placed in the world and joined.
local fonts = require "mission.stroke_font"
local paths = require "mission.paths"
local svg = require "mission.svg"

local M = {}

-- Strokes of the SVG file of the option, y up, and notes on the parts that are not drawn.
local function picture(run, option)
  local name = run.options[option]
  local function fail(text) run:fail(option, name .. ": " .. text) end
  local good, strokes, notes = pcall(svg.strokes, lapwing.read_text(name, "strokes"))
  if not good then fail((tostring(strokes):gsub("^[^ ]*:%d+: ", ""))) end
  for _, stroke in ipairs(strokes) do
    for _, p in ipairs(stroke) do
      p[2] = -p[2]
      if p[1] ~= p[1] or p[2] ~= p[2] or math.abs(p[1]) > 1e9 or math.abs(p[2]) > 1e9 then
        fail("a path holds a number that is not finite or too large")
      end
    end
  end
  for i, note in ipairs(notes) do notes[i] = name .. ", " .. note end
  if #strokes == 0 then
    fail("no path is drawn in it" .. (#notes > 0 and "; " .. table.concat(notes, "; ") or ""))
  end
  return strokes, notes
end

-- Strokes as {{x, y}, ...}, y up, the height of what is 1 high in the drawing (nil: all of it is
-- `height` high), and notes of what is not drawn.
function M.read(run)
  local o = run.options
  local given = 0
  for _, source in ipairs { "text", "svg", "strokes", "input" } do
    if o[source] and #o[source] > 0 then given = given + 1 end
  end
  if given ~= 1 then
    lapwing.fail("give one of text, svg, strokes and --set input=PICTURE.svg")
  end
  if o.text and #o.text > 0 then
    local strokes, missing
    if o.font then
      strokes, missing = fonts.hershey_strokes(o.text, lapwing.read_text(o.font, "strokes/hershey"))
    else
      strokes, missing = fonts.strokes(o.text)
    end
    if not strokes then
      run:fail("text", "the font has no glyph for " .. missing
                       .. (o.font and "" or "; it has " .. fonts.CHARACTERS))
    end
    if #strokes == 0 then run:fail("text", "there is nothing to draw") end
    local lower = not o.font and o.text:find("%l")
    return strokes, 1, lower and { "lower case letters are drawn as capitals" } or nil
  elseif o.strokes and #o.strokes > 0 then
    local strokes = {}
    for i, stroke in ipairs(o.strokes) do
      local points = {}
      if #stroke.points < 4 or #stroke.points % 2 ~= 0 then
        run:fail("strokes[" .. i .. "].points", "expected x, y of two points or more")
      end
      for k = 1, #stroke.points, 2 do
        points[#points + 1] = { stroke.points[k], stroke.points[k + 1] }
      end
      strokes[i] = points
    end
    return strokes
  end
  local strokes, notes = picture(run, o.svg and #o.svg > 0 and "svg" or "input")
  return strokes, nil, notes
end

-- Points that repeat the one before, and strokes without a length, left out.
function M.without_repeats(strokes)
  local kept = {}
  for _, stroke in ipairs(strokes) do
    local points = { stroke[1] }
    for i = 2, #stroke do
      local p, q = points[#points], stroke[i]
      if lapwing.norm(lapwing.vector(p) - q) > 1e-6 then points[#points + 1] = q end
    end
    if #points > 1 then kept[#kept + 1] = points end
  end
  return kept
end

-- Into the world: {{x, y, z}, ...} per stroke.
function M.placed(strokes, unit, o)
  local left, right, low, high = math.huge, -math.huge, math.huge, -math.huge
  for _, stroke in ipairs(strokes) do
    for _, p in ipairs(stroke) do
      left, right = math.min(left, p[1]), math.max(right, p[1])
      low, high = math.min(low, p[2]), math.max(high, p[2])
    end
  end
  -- A drawing without a height, a level line, is as wide as the height says.
  local scale = o.height / (unit or (high - low > 1e-6 * (right - left) and high - low)
                            or right - left)
  local yaw = math.rad(o.view_yaw_deg)
  local across = lapwing.vector(math.sin(yaw), -math.cos(yaw), 0)  -- right of who looks that way
  local world = {}
  for i, stroke in ipairs(strokes) do
    world[i] = {}
    for k, p in ipairs(stroke) do
      local u, up = scale * (p[1] - (left + right) / 2), scale * (p[2] - low)
      world[i][k] = u * across + { 0, 0, up } + o.base
    end
  end
  return world
end

-- One path through all strokes, and per stroke the shares of its length that are lit.
function M.joined(strokes)
  local points, lit, length = {}, {}, 0
  for i, stroke in ipairs(strokes) do
    for k, p in ipairs(stroke) do
      if #points > 0 then length = length + paths.distance(points[#points], p) end
      points[#points + 1] = p
      if k == 1 then lit[i] = { length } end
    end
    lit[i][2] = length
  end
  for _, span in ipairs(lit) do span[1], span[2] = span[1] / length, span[2] / length end
  return points, lit
end

return M
