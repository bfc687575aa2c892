-- SPDX-License-Identifier: Apache-2.0
-- Orders and reverses strokes so that the flight between them is short.
local M = {}

local MOST_ROUNDS = 50

local function apart(a, b)
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2)
end

local function reversed(stroke)
  local made = {}
  for i = #stroke, 1, -1 do made[#made + 1] = stroke[i] end
  return made
end

local function gap(order, i)
  local from, to = order[i], order[i + 1]
  return from and to and apart(from[#from], to[1]) or 0
end

-- Turns the strokes from i to j around.
local function turn(order, i, j)
  while i < j do
    order[i], order[j] = reversed(order[j]), reversed(order[i])
    i, j = i + 1, j - 1
  end
  if i == j then order[i] = reversed(order[i]) end
end

-- The strokes, some turned round: the nearest next one, then parts of the order turned around while
-- that shortens the way (2-opt). The first stroke given stays first.
function M.short(strokes)
  local left, order = table.move(strokes, 2, #strokes, 1, {}), { strokes[1] }
  while #left > 0 do
    local at = order[#order][#order[#order]]
    local best, nearest, turned = 1, math.huge, false
    for k, stroke in ipairs(left) do
      local here, there = apart(at, stroke[1]), apart(at, stroke[#stroke])
      if here < nearest then best, nearest, turned = k, here, false end
      if there < nearest then best, nearest, turned = k, there, true end
    end
    local stroke = table.remove(left, best)
    order[#order + 1] = turned and reversed(stroke) or stroke
  end
  for _ = 1, MOST_ROUNDS do
    local better = false
    for i = 2, #order do
      for j = i, #order do
        local before = gap(order, i - 1) + gap(order, j)
        local first, last = order[i], order[j]
        local previous, after = order[i - 1], order[j + 1]
        local now = apart(previous[#previous], last[#last])
                    + (after and apart(first[1], after[1]) or 0)
        if now < before - 1e-9 then
          turn(order, i, j)
          better = true
        end
      end
    end
    if not better then break end
  end
  return order
end

return M
