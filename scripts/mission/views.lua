-- SPDX-License-Identifier: Apache-2.0
-- Poses from which a depth camera sees a whole scene.
local M = {}

local PASSES = {  -- m over the region's floor, rad
  { height = 3, pitch = 0 },
  { height = 9, pitch = -0.35 },
  { height = 20, pitch = -0.9 },
}
local HEADINGS = 4
local CLEARANCE, CLEARANCE_INDOORS = 1.5, 0.4  -- m, kept from every triangle
local TRIES = 40       -- places drawn for each one that is found free

-- `count` poses over the surface's region of interest: passes at three heights, at places that fill
-- the region evenly, each looked from in four directions in turn. Places too near to something are
-- left out, and those with something above them where the region has a sky at all.
function M.over(surface, count)
  local lower, upper = surface.region.lower, surface.region.upper
  local top = surface.upper[3]
  local middle = { (lower[1] + upper[1]) / 2, (lower[2] + upper[2]) / 2, lower[3] + 2 }
  local indoors = surface:covered(middle)
  local clearance = indoors and CLEARANCE_INDOORS or CLEARANCE
  local poses, k = {}, 0
  while #poses < count and k < TRIES * count do
    local pass = PASSES[k % #PASSES + 1]
    k = k + 1
    -- The R2 sequence fills the plane evenly, however many there are (Roberts, 2018).
    local u, v = (0.5 + 0.7548776662466927 * k) % 1, (0.5 + 0.5698402909980532 * k) % 1
    local p = { lower[1] + (upper[1] - lower[1]) * u, lower[2] + (upper[2] - lower[2]) * v,
                lower[3] + pass.height }
    if indoors then p[3] = lower[3] + (upper[3] - lower[3]) * (0.3 + 0.4 * (k % 3) / 2) end
    local high = p[3] > top + CLEARANCE and p[3] > lower[3] + PASSES[1].height
    if not high and surface:clearance(p) >= clearance and (indoors or not surface:covered(p)) then
      poses[#poses + 1] = { position = p, pitch = indoors and 0 or pass.pitch,
                            yaw = (#poses % HEADINGS) * 2 * math.pi / HEADINGS + 0.3 * u }
    end
  end
  if #poses < count then
    error(string.format("only %d of %d places in the region are free", #poses, count))
  end
  return poses
end

return M
