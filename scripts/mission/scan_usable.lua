-- SPDX-License-Identifier: Apache-2.0
-- The limits within which an image is of use to the model.
local M = {}

local RANGE, FOCAL = 30, 345  -- m, at a focal length in pixels (reading 4.11)

-- m: as given, else the distance at which a pixel shows as much as one of the thesis's camera shows
-- at 30 m.
function M.range(run)
  return run.options.usable.range or RANGE * run.options.camera.focal / FOCAL
end

return M
