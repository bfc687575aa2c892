-- SPDX-License-Identifier: Apache-2.0
-- The path data of SVG: all commands; curves become short straight pieces.
local M = {}

local PIECES = 24  -- of a Bezier curve
local ARC_STEP = math.rad(5)

-- Reads the numbers of path data one after another; flags of arcs may stand without blanks.
function M.reader(text)
  local at = 1
  local R = {}
  function R.skip() at = text:match("^[%s,]*()", at) end
  function R.command()
    R.skip()
    local letter = text:match("^%a", at)
    if letter then at = at + 1 end
    return letter
  end
  function R.done() R.skip() return at > #text end
  function R.number()
    R.skip()
    local number, after = text:match("^([+-]?%d*%.?%d*)()", at)
    local exponent, behind = text:match("^([eE][+-]?%d+)()", after)
    local value = tonumber(number .. (exponent or ""))
    if not value then
      error("path data: expected a number at '" .. text:sub(at, at + 12) .. "'")
    end
    at = behind or after
    return value
  end
  function R.flag()
    R.skip()
    local flag = text:match("^[01]", at)
    if not flag then error("path data: expected a flag 0 or 1") end
    at = at + 1
    return flag == "1"
  end
  return R
end

-- From the end points to the middle of the ellipse (SVG 1.1, F.6.5).
local function arc(points, x0, y0, rx, ry, turn, large, sweep, x, y)
  if (x0 == x and y0 == y) then return end
  rx, ry = math.abs(rx), math.abs(ry)
  if rx == 0 or ry == 0 then points[#points + 1] = { x, y } return end
  local c, s = math.cos(turn), math.sin(turn)
  local dx, dy = (x0 - x) / 2, (y0 - y) / 2
  local x1, y1 = c * dx + s * dy, -s * dx + c * dy
  local scale = (x1 / rx) ^ 2 + (y1 / ry) ^ 2
  if scale > 1 then rx, ry = rx * math.sqrt(scale), ry * math.sqrt(scale) end
  local below = (rx * y1) ^ 2 + (ry * x1) ^ 2
  local root = math.sqrt(math.max(0, (rx * ry) ^ 2 / below - 1)) * (large == sweep and -1 or 1)
  local cx1, cy1 = root * rx * y1 / ry, -root * ry * x1 / rx
  local cx, cy = c * cx1 - s * cy1 + (x0 + x) / 2, s * cx1 + c * cy1 + (y0 + y) / 2
  local from = math.atan((y1 - cy1) / ry, (x1 - cx1) / rx)
  local span = math.atan((-y1 - cy1) / ry, (-x1 - cx1) / rx) - from
  if sweep and span < 0 then span = span + 2 * math.pi end
  if not sweep and span > 0 then span = span - 2 * math.pi end
  local pieces = math.max(2, math.ceil(math.abs(span) / ARC_STEP))
  for i = 1, pieces do
    local a = from + span * i / pieces
    points[#points + 1] = { cx + c * rx * math.cos(a) - s * ry * math.sin(a),
                            cy + s * rx * math.cos(a) + c * ry * math.sin(a) }
  end
end

local function bezier(points, p)
  local degree = #p // 2 - 1
  for i = 1, PIECES do
    local t, q = i / PIECES, table.move(p, 1, #p, 1, {})
    for level = degree, 1, -1 do  -- de Casteljau
      for k = 1, 2 * level do q[k] = q[k] + t * (q[k + 2] - q[k]) end
    end
    points[#points + 1] = { q[1], q[2] }
  end
end

-- The strokes that path data draws, lists of {x, y}.
function M.strokes(data)
  local r, strokes = M.reader(data), {}
  local x, y, start_x, start_y, points = 0, 0, 0, 0, nil
  local control_x, control_y, last
  local function begin()
    if not points then
      points = { { x, y } }
      strokes[#strokes + 1] = points
    end
  end
  local command
  while not r.done() do
    local letter = r.command()
    if letter then
      command = letter
    elseif not command or command == "z" or command == "Z" then
      error("path data must begin with a command")
    end
    if not last and command:upper() ~= "M" then
      error("path data must begin with a move, M or m, not with '" .. command .. "'")
    end
    local upper, relative = command:upper(), command:lower() == command
    local ox, oy = relative and x or 0, relative and y or 0
    local function pair() return r.number() + ox, r.number() + oy end
    if upper == "M" then
      x, y = pair()
      start_x, start_y, points = x, y, nil
      command = relative and "l" or "L"
    elseif upper == "Z" then
      begin()
      points[#points + 1] = { start_x, start_y }
      x, y, points = start_x, start_y, nil
    elseif upper == "L" or upper == "H" or upper == "V" then
      begin()
      if upper == "L" then x, y = pair()
      elseif upper == "H" then x = r.number() + ox
      else y = r.number() + oy end
      points[#points + 1] = { x, y }
    elseif upper == "C" or upper == "S" or upper == "Q" or upper == "T" then
      begin()
      local cubic = upper == "C" or upper == "S"
      local mirrored = last and (cubic and (last == "C" or last == "S")
                                 or not cubic and (last == "Q" or last == "T"))
      local p = { x, y }
      if upper == "S" or upper == "T" then
        p[3] = mirrored and 2 * x - control_x or x
        p[4] = mirrored and 2 * y - control_y or y
      else
        p[3], p[4] = pair()
      end
      if cubic then p[5], p[6] = pair() end
      control_x, control_y = p[#p - 1], p[#p]
      x, y = pair()
      p[#p + 1], p[#p + 2] = x, y
      bezier(points, p)
    elseif upper == "A" then
      begin()
      local rx, ry, turn = r.number(), r.number(), math.rad(r.number())
      local large, sweep = r.flag(), r.flag()
      local from_x, from_y = x, y
      x, y = pair()
      arc(points, from_x, from_y, rx, ry, turn, large, sweep, x, y)
    else
      error("unknown path command '" .. command .. "'")
    end
    last = upper
  end
  return strokes
end

return M
