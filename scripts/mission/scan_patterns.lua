-- Where a first flight takes its images: patterns at one height over a region (thesis 4.5.4).
local M = {}

local function point(x, y, z, yaw, pitch)
  return { position = { x, y, z }, yaw = yaw, pitch = pitch }
end

-- The camera looks at the region's middle, no higher than `pitch`.
local function looking_in(x, y, z, middle, pitch)
  local dx, dy, dz = middle[1] - x, middle[2] - y, middle[3] - z
  local across = math.sqrt(dx * dx + dy * dy)
  return point(x, y, z, math.atan(dy, dx), math.min(math.atan(dz, across), pitch))
end

-- Round the region, on an ellipse `reach` metres wider than it on every side.
local function ellipse(box, height, views, pitch, reach, round)
  local middle = { (box.lower[1] + box.upper[1]) / 2, (box.lower[2] + box.upper[2]) / 2,
                   (box.lower[3] + box.upper[3]) / 2 }
  local a = (box.upper[1] - box.lower[1]) / 2 + reach
  local b = (box.upper[2] - box.lower[2]) / 2 + reach
  if round then a, b = math.max(a, b), math.max(a, b) end
  local poses = {}
  for k = 0, views - 1 do
    local angle = 2 * math.pi * k / views
    poses[k + 1] = looking_in(middle[1] + a * math.cos(angle), middle[2] + b * math.sin(angle),
                              height, middle, pitch)
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
      poses[#poses + 1] = point(place[1], place[2], height, yaw, pitch)
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
