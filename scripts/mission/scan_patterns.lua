-- Where a first flight takes its images: patterns at one height over a region (thesis 4.5.4).
local M = {}

-- From `position` the camera looks at the middle of the box `region`, no higher than `pitch` (rad).
function M.looking_in(position, region, pitch)
  local to = {}
  for axis = 1, 3 do
    to[axis] = (region.lower[axis] + region.upper[axis]) / 2 - position[axis]
  end
  local across = math.sqrt(to[1] * to[1] + to[2] * to[2])
  return { position = position, yaw = math.atan(to[2], to[1]),
           pitch = math.min(math.atan(to[3], across), pitch) }
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

-- Poses of `pattern` (circle, ellipse, meander) over the box `region` at `height` (m, world), the
-- camera at `pitch` (rad, a circle's and an ellipse's at most), `reach` metres beyond the region.
function M.over(region, pattern, height, views, pitch, reach)
  if pattern == "meander" then return meander(region, height, views, pitch, reach) end
  return ellipse(region, height, views, pitch, reach, pattern == "circle")
end

return M
