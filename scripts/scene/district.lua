-- SPDX-License-Identifier: Apache-2.0
-- Parts of a town like `downtown`, each of another kind: alleys or avenues, small blocks or large
-- ones, houses of two storeys or towers. For training, where what differs from world to world is
-- what teaches.
local downtown = require "scene.downtown"

return function(options)
  local seed = options.seed or 1
  local draw = lapwing.scene { name = "draw", seed = seed }
  return downtown {
    name = "district", seed = seed, block = draw:uniform(26, 42), street = draw:uniform(5, 14),
    low = draw:uniform(0.18, 0.8),
  }
end
