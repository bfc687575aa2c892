-- SPDX-License-Identifier: Apache-2.0
-- The places of the images of a first flight: patterns at one height over a region (thesis 4.5.4).
local M = {}

-- From `position` the camera looks at the middle of the box `region`, no higher than `pitch` (rad).
function M.looking_in(position, region, pitch)
  local to = (lapwing.vector(region.lower) + region.upper) / 2 - position
  local across = lapwing.norm { to.x, to.y }
  return { position = position, yaw = math.atan(to.y, to.x),
           pitch = math.min(math.atan(to.z, across), pitch) }
end

-- Round the region, on an ellipse `reach` metres wider than it on every side.
local function ellipse(box, height, views, pitch, reach, round)
  local x, y = (box.lower[1] + box.upper[1]) / 2, (box.lower[2] + box.upper[2]) / 2
  local a = (box.upper[1] - box.lower[1]) / 2 + reach
  local b = (box.upper[2] - box.lower[2]) / 2 + reach
  if round then a, b = math.max(a, b), math.max(a, b) end
  local poses = {}
  for k = 0, views - 1 do
    local angle = 2 * math.pi * k / views
    poses[k + 1] = M.looking_in({ x + a * math.cos(angle), y + b * math.sin(angle), height }, box,
                                pitch)
  end
  return poses
end

-- To and fro along the region's longer side, views evenly spaced, in as many rows as make spacing
-- along and across them alike. Every second view looks back, so that both sides of what stands up
-- are seen.
local function meander(box, height, views, pitch, reach)
  local long, short = 1, 2
  if box.upper[2] - box.lower[2] > box.upper[1] - box.lower[1] then long, short = 2, 1 end
  local length = box.upper[long] - box.lower[long] + 2 * reach
  local width = box.upper[short] - box.lower[short] + 2 * reach
  local rows = math.max(1, math.min(views, math.floor(math.sqrt(views * width / length) + 0.5)))
  local poses, made = {}, 0
  for row = 0, rows - 1 do
    local count = math.floor(views * (row + 1) / rows) - made
    made = made + count
    for k = 0, count - 1 do
      local along = count > 1 and k / (count - 1) or 0.5
      if row % 2 == 1 then along = 1 - along end
      local place = {}
      place[long] = box.lower[long] - reach + length * along
      place[short] = box.lower[short] - reach + width * (rows > 1 and row / (rows - 1) or 0.5)
      local yaw = (#poses % 4) * math.pi / 2 + (long == 2 and math.pi / 2 or 0)
      place[3] = height
      poses[#poses + 1] = { position = place, yaw = yaw, pitch = pitch }
    end
  end
  return poses
end

local SIDE, UP = math.rad(35), math.rad(30)  -- what an image surely holds round its middle

-- Whether the middle of the image meets the box's floor or its top.
local function aims_at(pose, box)
  if pose.pitch >= 0 then return false end
  for _, z in ipairs { box.lower[3], box.upper[3] } do
    local far = (z - pose.position[3]) / math.tan(pose.pitch)
    local x = pose.position[1] + far * math.cos(pose.yaw)
    local y = pose.position[2] + far * math.sin(pose.yaw)
    if far > 0 and x >= box.lower[1] and x <= box.upper[1] and y >= box.lower[2]
       and y <= box.upper[2] then
      return true
    end
  end
  return false
end

-- Whether the image of a pose holds a place of the box: of nine by nine on its floor and its top.
local function sees(pose, box)
  if aims_at(pose, box) then return true end
  for i = 0, 8 do
    for j = 0, 8 do
      local x = box.lower[1] + i / 8 * (box.upper[1] - box.lower[1]) - pose.position[1]
      local y = box.lower[2] + j / 8 * (box.upper[2] - box.lower[2]) - pose.position[2]
      local aside = math.abs(math.atan(y, x) - pose.yaw)
      for _, z in ipairs { box.lower[3], box.upper[3] } do
        local up = math.atan(z - pose.position[3], math.sqrt(x * x + y * y)) - pose.pitch
        if math.min(aside, 2 * math.pi - aside) <= SIDE and math.abs(up) <= UP then return true end
      end
    end
  end
  return false
end

-- How many stops less one lie along each axis, and how long the grid is, with `spacing` metres
-- between stops at most.
local function grid_of(box, spacing, reach)
  local counts, lengths = {}, {}
  for axis = 1, 2 do
    lengths[axis] = box.upper[axis] - box.lower[axis] + 2 * reach
    counts[axis] = math.max(1, math.ceil(lengths[axis] / spacing))
  end
  return counts, lengths
end

-- Stops on a grid over the box, rows along one axis, `spacing` metres apart at most. At each the
-- camera looks forth and back along the rows, first the way that is flown; never past the box.
local function oblique_grid(box, along, height, spacing, pitch, reach, poses)
  local across = 3 - along
  local counts, lengths = grid_of(box, spacing, reach)
  for row = 0, counts[across] do
    for k = 0, counts[along] do
      local forth = row % 2 == 0
      local share = (forth and k or counts[along] - k) / counts[along]
      local place = { [3] = height }
      place[along] = box.lower[along] - reach + lengths[along] * share
      place[across] = box.lower[across] - reach + lengths[across] * row / counts[across]
      local ahead = (along == 2 and math.pi / 2 or 0) + (forth and 0 or math.pi)
      for _, yaw in ipairs { ahead, ahead + math.pi } do
        local pose = { position = { place[1], place[2], place[3] },
                       yaw = math.atan(math.sin(yaw), math.cos(yaw)), pitch = pitch }
        if sees(pose, box) then poses[#poses + 1] = pose end
      end
    end
  end
end

local OVERLAP = 0.75  -- heights over the region's floor, between stops of a crosshatch
local WIDER = 1.05    -- factor on the spacing while there are too many
local NEAR = 4        -- largest number of tried poses, as a factor on the requested views

-- The first spacing to be tried out: as overlap wants, or as wide as a number of poses that can be
-- held asks for, however large the box is.
local function first_spacing(box, height, views, reach)
  local spacing = OVERLAP * (height - box.lower[3])
  while true do
    local counts = grid_of(box, spacing, reach)
    if 4 * (counts[1] + 1) * (counts[2] + 1) <= math.max(NEAR * views, 16) then return spacing end
    spacing = WIDER * spacing
  end
end

-- Two oblique grids in crossing directions, as surveyors fly where walls count: every place is seen
-- from four sides. Stops are `OVERLAP` times the height over the region's floor apart, or as much
-- farther as `views` at most asks for. With the poses, how many times farther.
local function crosshatch(box, height, views, pitch, reach)
  local spacing, poses = first_spacing(box, height, views, reach), nil
  for _ = 1, 100 do
    poses = {}
    for along = 1, 2 do oblique_grid(box, along, height, spacing, pitch, reach, poses) end
    if #poses <= views then break end
    spacing = spacing * math.max(WIDER, 0.95 * math.sqrt(#poses / views))
  end
  return poses, spacing / (OVERLAP * (height - box.lower[3]))
end

-- Poses of `pattern` (circle, crosshatch, ellipse, meander) over the box `region` at `height` (m,
-- world), the camera at `pitch` (rad, a circle's and an ellipse's at most), `reach` metres beyond
-- the region. A crosshatch has at most `views` poses. The second result is the ratio of their
-- spacing and the spacing that overlap needs.
function M.over(region, pattern, height, views, pitch, reach)
  if pattern == "crosshatch" then return crosshatch(region, height, views, pitch, reach) end
  if pattern == "meander" then return meander(region, height, views, pitch, reach), 1 end
  return ellipse(region, height, views, pitch, reach, pattern == "circle"), 1
end

return M
