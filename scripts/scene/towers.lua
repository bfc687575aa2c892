-- SPDX-License-Identifier: Apache-2.0
-- A city centre like `downtown` with towers twice as high, up to 220 m: far taller than those that
-- the learned utility was trained among (thesis 5.4.5).
local downtown = require "scene.downtown"

return function(options)
  return downtown { name = "towers", seed = options.seed or 1, low = 2 }
end
