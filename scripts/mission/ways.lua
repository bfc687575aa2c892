-- SPDX-License-Identifier: Apache-2.0
-- Global before local planning (thesis 2.1, 6.1): paths between keyframes, straight or around
-- obstacles, as the initial guess of solvers; and corridors of free boxes around them.
--
-- legs[i] leads from keyframe i to i + 1:
--   way       path: places {x, y, z} from end to end, or nil
--   why       message of the planner if there is no path
--   failed    paths through failed passages, which this path avoids
--   corridor  boxes around the path, if a corridor was requested
local paths = require "mission.paths"

local M = {}

-- m, that a planned way keeps beside the margin; less where an end leaves no more room.
local MORE = { 0.3, 0.1, 0 }
local TRIES = 20   -- of the planner, to find another passage

-- The places between two keyframes on the planned way, at even speed.
local function between(way, from, to)
  local length, places, passed = paths.length(way), {}, 0
  for i = 2, #way - 1 do
    passed = passed + paths.distance(way[i - 1], way[i])
    places[#places + 1] = { time = from + (to - from) * passed / length, position = way[i] }
  end
  return places
end

local function obstructed(environment)
  local count = #environment.obstacles
  for _, subject in ipairs(environment.subjects or {}) do  -- bystanders that stand still
    if subject.filmed == false and #subject.track == 1 then count = count + 1 end
  end
  return count > 0
end

-- The leg with its path, or with the reason why there is none.
local function planned_leg(p, leg, from, to, planner)
  local way, why, status
  for _, more in ipairs(MORE) do
    way, why, status = p:plan_way { from = from, to = to, more = more, planner = planner,
                                    excluded = leg.failed, tries = TRIES }
    if status ~= "start_blocked" and status ~= "goal_blocked" then break end
  end
  return { failed = leg.failed, way = way, why = why }
end

-- The regions of all legs, or nil where one has none; the legs with their corridors.
local function corridor_of(p, legs, times)
  local regions, grown = {}, table.move(legs, 1, #legs, 1, {})
  for i, leg in ipairs(legs) do
    if not leg.way then return nil, grown end
    local corridor = leg.corridor or p:grow_corridor { way = leg.way }
    grown[i] = { failed = leg.failed, way = leg.way, corridor = corridor }
    if #corridor == 0 then return nil, grown end
    local from, span = times[i], times[i + 1] - times[i]
    for _, box in ipairs(corridor) do
      regions[#regions + 1] = { start = from + span * box.from, finish = from + span * box.to,
                                lower = box.lower, size = box.size }
    end
  end
  return regions, grown
end

-- The way through keyframes {times, positions}, for a problem that knows what surrounds it. `known`
-- are legs that were planned before. Gives
--   {path = {{time, position}, ...}, legs, corridor}
-- where legs for which no way is found are straight, and the corridor is there where it is asked
-- for, something stands in the way, and every leg has one.
function M.planned(p, keyframes, environment, planner, known, in_corridor)
  local times, positions = keyframes.times, keyframes.positions
  local blocked = obstructed(environment)
  local path, legs = { { time = times[1], position = positions[1] } }, {}
  for i = 1, #times - 1 do
    local leg = known[i] or { failed = {} }
    if blocked and not leg.way and not leg.why then
      leg = planned_leg(p, leg, positions[i], positions[i + 1], planner)
    end
    legs[i] = leg
    for _, place in ipairs(leg.way and between(leg.way, times[i], times[i + 1]) or {}) do
      path[#path + 1] = place
    end
    path[#path + 1] = { time = times[i + 1], position = positions[i + 1] }
  end
  local corridor
  if in_corridor and blocked then corridor, legs = corridor_of(p, legs, times) end
  return { path = path, legs = legs, corridor = corridor }
end

-- The straight way through keyframes, as M.planned gives it.
function M.straight(keyframes)
  local path = {}
  for i, time in ipairs(keyframes.times) do
    path[i] = { time = time, position = keyframes.positions[i] }
  end
  return { path = path, legs = {} }
end

-- Whether any leg goes round something.
function M.matter(legs)
  for _, leg in ipairs(legs) do
    if leg.why or leg.way and #leg.way > 2 then return true end
  end
  return false
end

-- The legs with the way of one of them given up: another passage is planned for it.
function M.without_way(legs, number)
  local others = table.move(legs, 1, #legs, 1, {})
  local failed = table.move(legs[number].failed, 1, #legs[number].failed, 1, {})
  failed[#failed + 1] = legs[number].way
  others[number] = { failed = failed }
  return others
end

return M
