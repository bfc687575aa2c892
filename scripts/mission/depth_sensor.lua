-- SPDX-License-Identifier: Apache-2.0
-- What the options of a simulated depth camera have in common, wherever they are declared.
local M = {}

-- Width, height and angle of its image; `most` pixels across or down.
function M.image(most)
  return { name = "width", type = "integer", default = 160, minimum = 1, maximum = most,
           summary = "width of the image in pixels" },
         { name = "height", type = "integer", default = 120, minimum = 1, maximum = most,
           summary = "height of the image in pixels" },
         { name = "view_deg", type = "number", unit = "deg", default = 90, minimum = 1,
           maximum = 170, summary = "horizontal angle of view" }
end

-- Range, `least` m at the least, share of lost pixels, and noise.
function M.depth(least)
  return { name = "range", type = "number", unit = "m", default = 20, minimum = least,
           maximum = 1000, summary = "largest depth" },
         { name = "dropped", type = "number", default = 0, minimum = 0, maximum = 1,
           summary = "fraction of pixels without a measurement" },
         { name = "sigma", type = "number", unit = "m", default = 0, minimum = 0, maximum = 100,
           summary = "standard deviation of the depth" }
end

return M
