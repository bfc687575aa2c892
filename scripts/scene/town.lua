-- SPDX-License-Identifier: Apache-2.0
-- A town of many districts like `district`, side by side on one grid of streets, each with
-- buildings of its own height. `districts`: their number along each side; 8 make a square
-- kilometre.
local blocks = require "scene.blocks"
local colors = require "scene.colors"
local nature = require "scene.nature"

local BLOCK, STREET = 32, 10      -- m
local ACROSS = 3                  -- blocks of a district, along each side
local LOW, HIGH = 0.18, 0.45      -- times that buildings are high, as in `downtown`
local MARGIN, CELL = 60, 13       -- m, of the ground beyond the region; of its cells

return function(options)
  local count = options.districts or 2
  local scene = lapwing.scene { name = "town", seed = options.seed or 1 }
  local wide = ACROSS * (BLOCK + STREET)
  local half = count * wide / 2
  colors.use(scene, "asphalt")
  nature.ground(scene, 2 * (half + MARGIN), CELL, function() return 0 end)
  local highest = 0
  for row = 1, count do
    for column = 1, count do
      local low = scene:uniform(LOW, HIGH)
      highest = math.max(highest, low)
      scene:push({(column - 0.5) * wide - half, (row - 0.5) * wide - half, 0})
      blocks.district(scene, BLOCK, STREET, low)
      scene:pop()
    end
  end
  scene:region({-half, -half, -0.3}, {half, half, 126 * highest})
  return scene
end
