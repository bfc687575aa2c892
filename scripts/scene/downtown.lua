-- SPDX-License-Identifier: Apache-2.0
-- A city centre: towers up to 110 m around a square, with bridges between them (after thesis 5.4.5:
-- "tall buildings never seen before").
local blocks = require "scene.blocks"
local colors = require "scene.colors"
local nature = require "scene.nature"

local BLOCK, STREET, GROUND = 40, 14, 260  -- m

-- `block` and `street`: their widths, m; `low`: times that buildings are high.
return function(options)
  local scene = lapwing.scene { name = options.name or "downtown", seed = options.seed or 1 }
  local block, street, low = options.block or BLOCK, options.street or STREET, options.low or 1
  colors.use(scene, "asphalt")
  nature.ground(scene, GROUND, 13, function() return 0 end)
  blocks.district(scene, block, street, low)
  local pitch = block + street
  scene:region({-1.5 * pitch, -1.5 * pitch, -0.3}, {1.5 * pitch, 1.5 * pitch, 126 * low})
  return scene
end
