-- SPDX-License-Identifier: Apache-2.0
-- Trees, hedges and ground. Metres.
local colors = require "scene.colors"

local nature = {}

-- A broad-leaved tree of `height` at {x, y, z}: a trunk, boughs, and a crown of rough balls with
-- air between them.
function nature.tree(scene, at, height)
  local x, y, z = at[1], at[2], at[3] or 0
  local thick = height * 0.028
  local fork = height * 0.38
  colors.use(scene, "bark")
  scene:tube({x, y, z - 0.2}, {x, y, z + fork}, thick, thick * 0.75, 8)
  local boughs = scene:integer(5, 7)
  local turn = scene:uniform(0, math.pi)
  local ends = {{x, y, z + height * 0.78}}
  for i = 1, boughs do
    local angle = turn + 2 * math.pi * i / boughs
    local reach = height * scene:uniform(0.17, 0.26)
    ends[#ends + 1] = {x + reach * math.cos(angle), y + reach * math.sin(angle),
                       z + height * scene:uniform(0.5, 0.74)}
  end
  for _, tip in ipairs(ends) do
    colors.use(scene, "bark")
    scene:tube({x, y, z + fork * 0.92}, tip, thick * 0.55, thick * 0.2, 6)
    colors.use(scene, scene:uniform(0, 1) < 0.6 and "leaf" or "dark_leaf")
    local r = height * scene:uniform(0.13, 0.19)
    scene:ball(tip, {r, r * scene:uniform(0.9, 1.1), r * scene:uniform(0.7, 0.9)}, 2, 0.22)
  end
end

-- A conifer: a trunk and skirts of needles.
function nature.fir(scene, at, height)
  local x, y, z = at[1], at[2], at[3] or 0
  colors.use(scene, "bark")
  scene:tube({x, y, z - 0.2}, {x, y, z + height * 0.9}, height * 0.02, height * 0.006, 6)
  colors.use(scene, "dark_leaf")
  local skirts = math.max(4, math.floor(height / 1.3))
  for i = 0, skirts - 1 do
    local share = i / skirts
    local foot = z + height * (0.12 + 0.8 * share)
    local radius = height * 0.2 * (1 - share) + 0.15
    local lean = 0.06 * radius
    scene:tube({x + scene:uniform(-lean, lean), y + scene:uniform(-lean, lean), foot},
               {x, y, foot + height * 0.2}, radius, 0, 11)
  end
end

function nature.bush(scene, at, size)
  colors.use(scene, scene:uniform(0, 1) < 0.5 and "hedge" or "leaf")
  scene:ball({at[1], at[2], (at[3] or 0) + size * 0.35}, {size, size, size * 0.75}, 2, 0.25)
end

-- A clipped hedge along a straight line, of slightly uneven blocks.
function nature.hedge(scene, from, to, height)
  local dx, dy = to[1] - from[1], to[2] - from[2]
  local length = math.sqrt(dx * dx + dy * dy)
  local pieces = math.max(1, math.floor(length / 1.2))
  colors.use(scene, "hedge")
  scene:push({from[1], from[2], from[3] or 0}, math.atan(dy, dx))
  for i = 0, pieces - 1 do
    local w, h = scene:uniform(0.36, 0.46), height * scene:uniform(0.93, 1.05)
    scene:box({length * i / pieces, -w, 0}, {length * (i + 1) / pieces, w, h})
  end
  scene:pop()
end

-- Ground over a square of `size` metres about the origin, every `step` metres, whose height is
-- `height(x, y)`.
function nature.ground(scene, size, step, height)
  local columns = math.floor(size / step + 0.5) + 1
  local heights, low = {}, -size / 2
  for row = 0, columns - 1 do
    for column = 0, columns - 1 do
      heights[#heights + 1] = height(low + column * step, low + row * step)
    end
  end
  scene:terrain({low, low}, step, columns, heights)
end

-- Gentle hills: a few waves whose lengths do not divide each other.
function nature.hills(scene, amplitude)
  local a, b, c = scene:uniform(0, 6), scene:uniform(0, 6), scene:uniform(0, 6)
  return function(x, y)
    return amplitude * (0.5 * math.sin(x / 31 + a) * math.cos(y / 37 + b)
                        + 0.3 * math.sin((x + y) / 17 + c))
  end
end

return nature
