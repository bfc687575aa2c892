-- Where solvers begin: straight from keyframe to keyframe, and round what stands between (thesis
-- 2.1: a path planner first, then the trajectory).
local M = {}

local MORE = 0.3  -- m, that a planned way keeps beside the margin

local function distance(a, b)
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
end

-- The places between two keyframes on the planned way, at even speed.
local function between(way, from, to)
  local length = 0
  for i = 2, #way do length = length + distance(way[i - 1], way[i]) end
  local places, passed = {}, 0
  for i = 2, #way - 1 do
    passed = passed + distance(way[i - 1], way[i])
    places[#places + 1] = { time = from + (to - from) * passed / length, position = way[i] }
  end
  return places
end

-- {{time, position}, ...} through keyframes at `times` and `positions`; legs for which no way is
-- found stay straight.
function M.path(p, times, positions, planner, obstructed)
  local path = { { time = times[1], position = positions[1] } }
  for i = 2, #times do
    local way = obstructed and p:plan_way { from = positions[i - 1], to = positions[i],
                                            planner = planner, more = MORE }
    for _, place in ipairs(way and between(way, times[i - 1], times[i]) or {}) do
      path[#path + 1] = place
    end
    path[#path + 1] = { time = times[i], position = positions[i] }
  end
  return path
end

return M
