-- SPDX-License-Identifier: Apache-2.0
-- The strategy of timing = "free": times and flight are optimised together. Every leg between two
-- keyframes has its own step. The time of a keyframe is exact, preferred with a weight, within a
-- window, or free. Each second of flight costs `weights.time`. The film is then planned at the
-- times found. If it fails, times are searched again with a larger reserve of thrust. If there are
-- none, the film is planned at times of straight flight (straight_times.lua).
local attempts = require "mission.film_attempt"
local film_keyframes = require "mission.film_keyframes"
local film_problem = require "mission.film_problem"
local film_times = require "mission.film_times"
local point_mass = require "mission.point_mass"
local requests = require "mission.film_request"
local surroundings = require "mission.film_environment"
local straight = require "mission.straight_times"
local times = require "mission.keyframe_times"
local timing = require "mission.timing"
local ways = require "mission.ways"

local M = {}

local FEWEST, MOST = 8, 16             -- intervals of a leg while times are looked for
local STEP = 0.4                       -- s, of the first guess, where that makes neither
local END_STEP = 0.15                  -- s, likewise where the flight begins or ends at rest
local SHARES = { 0.95, 0.85, 0.7, 0.5 }  -- of the thrust, until the film itself holds
local LONGEST = 10                     -- times the first guess, that a leg may take

-- Legs at the vehicle's pace, stretched between the keyframes whose times are `fixed`.
local function paced(own, fixed)
  local list, known = { 0 }, 1
  for i = 2, #own do list[i] = list[i - 1] + own[i] - own[i - 1] end
  for i = 2, #own do
    if fixed[i] then
      local scale = math.max(fixed[i] - list[known], 0.1) / (own[i] - own[known])
      for j = known + 1, i do list[j] = list[known] + scale * (own[j] - own[known]) end
      for j = i + 1, #own do list[j] = list[j - 1] + own[j] - own[j - 1] end
      known = i
    end
  end
  return list
end

-- An initial guess of the times that meets the wishes: times first, then windows.
local function guessed(keyframes, wishes, vehicle)
  local own, fixed = { 0 }, {}
  for i, k in ipairs(keyframes) do
    fixed[i] = wishes[i].time
    if i > 1 then
      own[i] = own[i - 1] + times.of_leg(keyframes[i - 1].position, k.position, vehicle)
    end
  end
  local list = paced(own, fixed)
  for i, wish in ipairs(wishes) do
    local earliest, latest = wish.earliest or 0, wish.latest or math.huge
    if list[i] < earliest or list[i] > latest then
      fixed[i] = math.min(math.max(list[i], earliest), latest)
      list = paced(own, fixed)
    end
  end
  return list
end

-- Legs of free time, and keyframes as a problem wants them, at the times guessed in `list`.
local function legs_and_keyframes(keyframes, list)
  local legs, made = {}, { places = {}, yaws = {}, times = {}, positions = {}, headings = {} }
  local heading = 0
  for i, k in ipairs(keyframes) do
    heading = k.yaw or heading
    local time = list[i]
    made.times[i], made.positions[i] = time, k.position
    made.places[i], made.headings[i] = { time = time, value = k.position }, heading
    if k.yaw then made.yaws[#made.yaws + 1] = { time = time, value = { k.yaw } } end
    if i > 1 then
      local span = time - list[i - 1]
      local intervals = math.min(MOST, math.max(FEWEST, math.ceil(span / STEP)))
      if i == 2 or i == #keyframes then
        intervals = math.max(intervals, math.ceil(span / END_STEP))
      end
      legs[i - 1] = { duration = span, mode = "free", longest = LONGEST * span,
                      intervals = intervals }
    end
  end
  return legs, made
end

-- The flight of a request alone, without the camera, with legs of free time; and its ways.
local function problem_of(run, request, memory)
  local o, vehicle = run.options, request.vehicle
  local legs, keyframes = legs_and_keyframes(request.keyframes, memory.guess)
  local environment = surroundings.state(run, request)
  local p = run:problem(surroundings.stated(environment, { vehicle = vehicle, legs = legs }))
  local way = ways.planned(p, keyframes, environment, o.planner, request.legs, false)
  p:add_cost { type = "keyframe", weight = o.weights.keyframe, keyframes = keyframes.places }
  point_mass.add(p, vehicle,
                 film_problem.parts.motion(o, { across = "extent", share = memory.share }))
  p:add_constraint { type = "hard_keyframe", tolerance = o.hard or film_keyframes.MISS,
                     keyframes = keyframes.places }
  if #keyframes.yaws > 0 then
    p:add_cost { type = "keyframe", name = "keyframe_yaw", block = "yaw",
                 weight = o.weights.keyframe, keyframes = keyframes.yaws }
  end
  point_mass.must_rest(run, p, "timing", "set another timing than free")
  p:add_constraint(film_problem.parts.boundary(run, p, 1, #keyframes.yaws == 0))
  surroundings.add(p, environment, nil, nil)
  surroundings.add_speed_limit(p, o, true)
  film_times.add(p, o.weights.time, request.wishes, memory.guess)
  p:guess_path(film_problem.parts.guess(keyframes, nil, way.path))
  p:finish()
  return p, way.legs
end

-- The film of a request with its keyframes at these times.
local function at_times(run, request, list, legs, memory)
  times.check_battery(run, request.vehicle, list[#list])
  return film_times.set(request, list, { legs = legs, memory = memory })
end

-- A keyframe whose wish straight flight is too slow for, at the speeds of the vehicle, and a
-- sentence on it; else nil. `late`: s, by which keyframes may be early or late.
local function too_early(run, request, late)
  local legs, earliest = {}, 0
  for i = 2, #request.keyframes do
    local ends = { first = i == 2, last = i == #request.keyframes }
    legs[i - 1] = times.least_of_leg(request.keyframes[i - 1], request.keyframes[i],
                                     request.vehicle, run.options, ends, late)
  end
  local chosen, refused = run:keyframe_times { wishes = request.wishes, legs = legs }
  if chosen then return nil end
  for i = 2, refused do
    local wish = request.wishes[i - 1]
    local first = wish.earliest or not wish.time_weight and wish.time or 0
    earliest = math.max(earliest, first) + legs[i - 1]
  end
  return refused, string.format(
    "no times meet every wish: vehicle '%s' takes at least %.4g s from keyframe %d to %d, which it "
    .. "passes at %.4g s at the earliest", request.vehicle.name, legs[refused - 1], refused - 1,
    refused, earliest)
end

-- The film of a request at the times found with the share of the thrust that `memory` names. Where
-- the solver finds none: at times of straight flight; nil where it had found some with more thrust.
local function at_share(run, request, memory)
  local stated, ways_of_legs = problem_of(run, request, memory)
  local solution = run:solve(stated, run.options.solver)
  if solution.status == "unsupported" then run:fail("solver", solution.message) end
  if solution.status ~= "optimal" and solution.status ~= "feasible" then
    if memory.number > 1 then return nil end
    local reason = solution.status
    if solution.message ~= "" then reason = reason .. ": " .. solution.message end
    return straight.first(run, request, memory,
                          "the solver found no times of its own (" .. reason .. ")")
  end
  local list = film_times.of(solution, request.wishes)
  return at_times(run, request, list, ways_of_legs, memory)
end

-- With the share of the thrust of that number.
local function remembered(memory, number)
  return { guess = memory.guess, number = number, share = SHARES[number] }
end

-- The film at the first times found.
function M.first(run, film)
  local wishes = timing.wishes(run, film, "timing = \"free\"")
  local keyframes = times.with_yaw(film.keyframes)
  local request = requests.first {
    vehicle = film.vehicle, subjects = film.subjects, cuts = film.cuts, terms = film.terms,
    origin = film.origin, keyframes = keyframes, wishes = wishes }
  local refused, sentence = too_early(run, request, run.options.hard and 0 or film_keyframes.LATE)
  if refused then run:fail("keyframes[" .. refused .. "]", sentence) end
  local memory = remembered({ guess = guessed(keyframes, wishes, film.vehicle) }, 1)
  -- What only a late flight grants has no solution where times are exact.
  local _, strict = too_early(run, request, 0)
  if strict then return straight.first(run, request, memory, strict) end
  return at_share(run, request, memory)
end

-- The next request after an outcome; told are {notes, figures}.
function M.next(run, outcome)
  local request, memory = outcome.request, outcome.request.memory
  if memory.straight then return straight.next(run, outcome) end
  local figures = { duration = request.duration, share = memory.share }
  if outcome.holds or run:cancelled() then return nil, { notes = {}, figures = figures } end
  local told = { figures = figures, notes = { string.format(
    "at the times found with %.2g of the thrust: %s", memory.share,
    attempts.complaint(outcome)) } }
  local again = requests.with(request, { legs = outcome.legs })
  local with_spare = SHARES[memory.number + 1]
    and at_share(run, again, remembered(memory, memory.number + 1))
  return with_spare or straight.first(run, again, memory, told.notes[1]), told
end

return M
