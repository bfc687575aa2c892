-- Where a depth camera looks from to see a whole scene.
local M = {}

local PASSES = {  -- height over the region's floor as a share of its size, pitch, headings
  { share = 0.9, pitch = -1.0 },
  { share = 0.55, pitch = -0.6 },
  { share = 0.25, pitch = -0.25 },
}
local HEADINGS = 4
local OUTSIDE = 0.25  -- of the region's size, that a pass flies beyond it

-- `count` poses over the surface's region of interest: level passes at three heights, on a grid, each
-- place looked from in four directions in turn.
function M.over(surface, count)
  local lower, upper = surface.region.lower, surface.region.upper
  local size = { upper[1] - lower[1], upper[2] - lower[2] }
  local reach = math.max(size[1], size[2])
  local poses = {}
  for i = 1, count do
    local pass = PASSES[(i - 1) % #PASSES + 1]
    local k = (i - 1) // #PASSES
    -- The R2 sequence fills the plane evenly, however many there are (Roberts, 2018).
    local u = (0.5 + 0.7548776662466927 * k) % 1
    local v = (0.5 + 0.5698402909980532 * k) % 1
    poses[i] = {
      position = { lower[1] + size[1] * (u * (1 + 2 * OUTSIDE) - OUTSIDE),
                   lower[2] + size[2] * (v * (1 + 2 * OUTSIDE) - OUTSIDE),
                   lower[3] + math.min(pass.share * reach, 30) },
      yaw = (k % HEADINGS) * 2 * math.pi / HEADINGS + 0.3 * u,
      pitch = pass.pitch,
    }
  end
  return poses
end

return M
