-- SPDX-License-Identifier: Apache-2.0
-- What markets and their stores are full of: racks, crates, counters, columns, galleries. Metres.
local colors = require "scene.colors"

local market = {}

-- Boards between two cheeks, `deep`, with goods on them.
function market.rack(scene, length, deep, high)
  colors.use(scene, "wood")
  local boards = math.max(2, math.floor(high / 0.5))
  for _, x in ipairs {0, length - 0.04} do scene:box({x, 0, 0}, {x + 0.04, deep, high}) end
  for i = 0, boards do
    colors.use(scene, "wood")
    local z = (high - 0.03) * i / boards
    scene:box({0.04, 0, z}, {length - 0.04, deep, z + 0.03})
    local x = 0.1
    while i < boards and x < length - 0.3 do
      local w = scene:uniform(0.06, 0.25)
      if scene:uniform(0, 1) < 0.7 then
        colors.use(scene, colors.pick(scene, {"red", "paper", "ochre", "blue", "mint", "metal"}))
        scene:box({x, scene:uniform(0.02, 0.2 * deep), z + 0.03},
                  {x + w, deep * scene:uniform(0.6, 0.98), z + scene:uniform(0.15, 0.4)})
      end
      x = x + w + scene:uniform(0.01, 0.1)
    end
  end
end

function market.crates(scene)
  local edge, tall = scene:uniform(0.4, 0.8), scene:integer(1, 3)
  for i = 0, tall - 1 do
    colors.use(scene, colors.pick(scene, {"wood", "ochre", "dark_wood", "paper"}))
    local w = edge * scene:uniform(0.8, 1)
    scene:box({-w / 2, -w / 2, edge * i}, {w / 2, w / 2, edge * (i + 1)})
  end
end

function market.counter(scene)
  local long, high = scene:uniform(1.2, 2.6), scene:uniform(0.8, 1.1)
  colors.use(scene, "dark_wood")
  scene:box({-long / 2, -0.3, 0}, {long / 2, 0.3, high - 0.05})
  colors.use(scene, "stone")
  scene:box({-long / 2 - 0.05, -0.36, high - 0.05}, {long / 2 + 0.05, 0.36, high})
  for _ = 1, scene:integer(2, 6) do
    local x = scene:uniform(-long / 2, long / 2 - 0.3)
    colors.use(scene, colors.pick(scene, {"red", "leaf", "ochre", "white"}))
    scene:box({x, -0.25, high}, {x + 0.28, 0.2, high + scene:uniform(0.08, 0.35)})
  end
end

function market.column(scene, high)
  colors.use(scene, "stone")
  local r = scene:uniform(0.15, 0.4)
  scene:box({-r - 0.1, -r - 0.1, 0}, {r + 0.1, r + 0.1, 0.3})
  scene:tube({0, 0, 0.3}, {0, 0, high - 0.25}, r, r * 0.9, 12)
  scene:box({-r - 0.1, -r - 0.1, high - 0.25}, {r + 0.1, r + 0.1, high})
end

-- A slab along one side of a tall hall with a railing.
function market.gallery(scene, room)
  local front, z = room[4] - 1.6, 2.3
  colors.use(scene, "concrete")
  scene:box({room[1], front, z}, {room[3], room[4], z + 0.2})
  colors.use(scene, "metal")
  scene:box({room[1], front, z + 1.1}, {room[3], front + 0.06, z + 1.18})
  for i = 1, math.floor((room[3] - room[1]) / 0.7) do
    local x = room[1] + 0.7 * i
    scene:box({x - 0.05, front, z + 0.2}, {x, front + 0.05, z + 1.1})
  end
end

return market
