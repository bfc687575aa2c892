-- SPDX-License-Identifier: Apache-2.0
-- Walls and columns of churches. Metres.
local colors = require "scene.colors"
local walls = require "scene.walls"

local parts = {}

-- A wall with tall round-headed windows, `bays` of them, their sill and height given; between
-- buttresses where asked. It stands as those of walls.lua do.
function parts.wall(scene, width, height, sill, window_height, bays, buttress)
  local bay = width / bays
  for i = 0, bays - 1 do
    local x0 = i * bay
    local w = math.min(1.8, bay * 0.45)
    local a, b = x0 + (bay - w) / 2, x0 + (bay + w) / 2
    colors.use(scene, "sandstone")
    walls.panel(scene, x0, 0, x0 + bay, sill)
    -- The wall around an arched opening that stands on the sill.
    local outline = walls.arch_outline(a, b, window_height - w / 2)
    local corners = {{x0, 0, sill}}
    for k = #outline, 1, -1 do
      corners[#corners + 1] = {outline[k][1], 0, sill + outline[k][2]}
    end
    for _, p in ipairs {{x0 + bay, 0, sill}, {x0 + bay, 0, height}, {x0, 0, height}} do
      corners[#corners + 1] = p
    end
    scene:face(corners)
    local pane = {}
    for k = 1, #outline do
      local p, q = outline[k], outline[k % #outline + 1]
      colors.use(scene, "stone")
      scene:quad({p[1], 0, sill + p[2]}, {p[1], 0.7, sill + p[2]}, {q[1], 0.7, sill + q[2]},
                 {q[1], 0, sill + q[2]})
      pane[k] = {p[1], 0.6, sill + p[2]}
    end
    colors.use(scene, "glass")
    scene:face(pane)
    colors.use(scene, "dark")
    for k = 1, 2 do
      local x = a + w * k / 3
      scene:box({x - 0.04, 0.5, sill}, {x + 0.04, 0.6, sill + window_height - w / 2})
    end
    for k = 1, 4 do
      local z = sill + (window_height - w / 2) * k / 5
      scene:box({a, 0.5, z - 0.04}, {b, 0.6, z + 0.04})
    end
    if buttress then
      colors.use(scene, "stone")
      scene:box({x0 - 0.45, -1.3, 0}, {x0 + 0.45, 0, height * 0.6})
      scene:box({x0 - 0.4, -0.8, height * 0.6}, {x0 + 0.4, 0, height * 0.9})
    end
  end
  colors.use(scene, "stone")
  scene:box({0, -0.35, height - 0.5}, {width, 0, height})
  scene:box({0, -0.25, 0}, {width, 0, 0.8})
end

function parts.column(scene, x, y, height, radius)
  colors.use(scene, "stone")
  scene:box({x - radius * 1.5, y - radius * 1.5, 0}, {x + radius * 1.5, y + radius * 1.5, 0.3})
  scene:tube({x, y, 0.3}, {x, y, 0.55}, radius * 1.35, radius, 18)
  scene:tube({x, y, 0.55}, {x, y, height - 0.6}, radius, radius * 0.85, 18)
  scene:tube({x, y, height - 0.6}, {x, y, height - 0.3}, radius * 0.85, radius * 1.3, 18)
  scene:box({x - radius * 1.5, y - radius * 1.5, height - 0.3},
            {x + radius * 1.5, y + radius * 1.5, height})
end

return parts
