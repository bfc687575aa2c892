-- SPDX-License-Identifier: Apache-2.0
-- Times of keyframes as variables of a problem: legs with a step each, and what keyframes wish of
-- their times (thesis 3.5, 3.7).
local paths = require "mission.paths"
local requests = require "mission.film_request"

local M = {}

local OPEN = 1e5    -- s, later than any film
local EXACT = 1e-4  -- s

-- Adds the cost of a second of flight, and the wishes of keyframes whose times are guessed in
-- `list`, s. Each keyframe is the end of a leg. A wish is a residual (preferred), a bound (exact,
-- window) or nothing.
function M.add(p, weight, wishes, list)
  p:add_cost { type = "flight_time", weight = weight }
  for i = 2, #wishes do  -- the film begins in the first
    local wish, name = wishes[i], "time of keyframe " .. i
    local function held(time, tolerance)
      p:add_constraint { type = "hard_keyframe", name = name, block = "time",
                         tolerance = tolerance,
                         keyframes = { { time = list[i], value = { time } } } }
    end
    if wish.time_weight then
      p:add_cost { type = "keyframe", name = name, block = "time", weight = wish.time_weight,
                   keyframes = { { time = list[i], value = { wish.time } } } }
    elseif wish.time then
      held(wish.time, EXACT)
    elseif wish.earliest or wish.latest then
      local first, last = wish.earliest or 0, wish.latest or OPEN
      held((first + last) / 2, (last - first) / 2)
    end
  end
end

-- Adds the path of a `track` to a problem whose times are variables, guessed in `list`: the flight
-- is drawn to it at any time, and not to the places of the track at theirs.
function M.add_path(p, track, list)
  local weight = track.weight * #track.places / list[#list]
  for i, points in ipairs(track.legs) do
    p:add_cost { type = "path_distance", name = "path of leg " .. i, weight = weight,
                 points = points, spans = { { start = list[i], finish = list[i + 1] } } }
  end
end

-- The times of keyframes in a solution: the ends of its legs, and exact times exactly.
function M.of(solution, wishes)
  local list, clock = { 0 }, 0
  for i = 2, #wishes do
    clock = clock + solution.legs[i - 1]
    list[i] = not wishes[i].time_weight and wishes[i].time or clock
  end
  return list
end

-- What a film at these times pays for them: for the seconds of flight, and for preferred times.
function M.cost(weight, wishes, list)
  local sum = weight * list[#list]
  for i, wish in ipairs(wishes) do
    if wish.time_weight then sum = sum + wish.time_weight * (list[i] - wish.time) ^ 2 end
  end
  return sum
end

-- Places of the flight of a solution with free `legs`, about `apart` s from each other, at their
-- times: {time, value}.
function M.places(solution, legs, apart)
  local found, stage, clock = {}, 1, 0
  local function add(time, number)
    found[#found + 1] = { time = time, value = paths.point(solution.path, number) }
  end
  add(0, 1)
  for i, leg in ipairs(legs) do
    local step = solution.legs[i] / leg.intervals
    local every = math.max(1, math.floor(apart / step + 0.5))
    for k = 1, leg.intervals do
      if k % every == 0 and k + every <= leg.intervals or k == leg.intervals then
        add(clock + k * step, stage + k)
      end
    end
    clock, stage = clock + solution.legs[i], stage + leg.intervals
  end
  found[#found].time = math.min(found[#found].time, clock)
  return found
end

-- Whether any time is more than the script states.
function M.open(wishes)
  for i = 2, #wishes do
    if wishes[i].time_weight or not wishes[i].time then return true end
  end
  return false
end

-- A request with its keyframes at the times of `list`, s, the last one being the end of the film,
-- and `more` fields changed.
function M.set(request, list, more)
  local keyframes = {}
  for i, k in ipairs(request.keyframes) do
    keyframes[i] = { position = k.position, yaw = k.yaw, look_at = k.look_at, subject = k.subject,
                     time = list[i] }
  end
  local fields = { keyframes = keyframes, duration = list[#list] }
  for name, value in pairs(more) do fields[name] = value end
  return requests.with(request, fields)
end

return M
