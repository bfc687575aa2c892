-- SPDX-License-Identifier: Apache-2.0
-- A street between two terraces of plain houses: walls without openings under gable roofs. The
-- synthetic "Street" of thesis 4.5.1 has simple geometry; `street` has much more of it.
local colors = require "scene.colors"
local nature = require "scene.nature"
local roofs = require "scene.roofs"

local half_length, half_width = 30, 6      -- of the street, m
local depth, lowest, highest = 12, 13, 17  -- of the houses, m
local rise = 3.5                           -- of a roof, m

-- Houses along +x of the frame, their fronts towards -y.
local function terrace(scene, length)
  local x = 0
  while x < length - 0.1 do
    local width = scene:uniform(9, 14)
    if length - x - width < 8 then width = length - x end
    local height = scene:uniform(lowest, highest)
    scene:push({x, 0, 0})
    colors.use(scene, colors.pick(scene, colors.town))
    scene:box({0, 0, 0}, {width, depth, height})
    roofs.gable(scene, width, depth, height, rise, {verge = 0.02})
    scene:pop()
    x = x + width
  end
end

return function(options)
  local scene = lapwing.scene { name = "terrace", seed = options.seed or 1 }
  colors.use(scene, "earth")
  nature.ground(scene, 240, 12, function() return -0.02 end)
  for _, side in ipairs {0, math.pi} do
    scene:push({0, 0, 0}, side)
    scene:push({-half_length, half_width, 0})
    terrace(scene, 2 * half_length)
    scene:pop()
    scene:pop()
  end
  local x, y = half_length + 1, half_width + depth + 1
  scene:region({-x, -y, -0.5}, {x, y, highest + rise + 0.5})
  return scene
end
