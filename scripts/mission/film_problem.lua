-- SPDX-License-Identifier: Apache-2.0
-- A film as a trajectory problem: blocks, cost terms, constraints, a first guess, and the task that
-- its plan is judged by (thesis 3.5).
local cameras = require "mission.film_camera"
local surroundings = require "mission.film_environment"
local film_keyframes = require "mission.film_keyframes"
local live = require "mission.film_live"
local own = require "mission.own_terms"
local parts = require "mission.film_parts"
local film_times = require "mission.film_times"
local point_mass = require "mission.point_mass"
local subjects = require "mission.subjects"
local tracks = require "mission.tracks"
local ways = require "mission.ways"

local problem = {}

local STEP = 0.1                -- s, unless `step` says otherwise
local MOST_STAGES = 3000
local FEWEST_INTERVALS = 12
local HARD_YAW = math.rad(8)    -- with `hard`: largest miss of yaw; the certificate allows 10 deg

-- How the part of a film begins and ends: freely where the film does not. `free_yaw`: nothing else
-- says where the vehicle heads. `part`: nil for the whole film.
local function boundary(run, p, stretch, free_yaw, part)
  local options = run.options
  local state = { type = "boundary_state", start = "free", finish = "free",
                  start_yaw = free_yaw and p:rests() and (not part or part.first) and 0 or nil }
  local ends = {}
  if not part or part.first then ends[1] = "start" end
  if not part or part.last then ends[#ends + 1] = "finish" end
  for _, name in ipairs(ends) do
    state[name] = options[name]
    if options[name] == "rest" then
      point_mass.must_rest(run, p, name, "give free or moving, not rest")
    end
    local velocity = options[name .. "_velocity"]
    if velocity then state[name .. "_velocity"] = lapwing.vector(velocity) / stretch end
  end
  return state
end

-- How the vehicle flies: what its motion costs, and with `inputs` its limits.
local function motion_of(options, inputs)
  local weights = options.weights
  return { model = options.model,
           smoothness = { order = options.order, weight = weights.smoothness },
           yaw = { weight = weights.yaw }, effort = weights.effort, inputs = inputs }
end

-- The way through the keyframes, with the yaw that looks at the target.
local function guess(keyframes, camera, path)
  local times, positions, yaws = {}, {}, {}
  if not camera or #keyframes.yaws > 0 then
    for i, place in ipairs(path) do times[i], positions[i] = place.time, place.position end
    local headings = {}
    for i, time in ipairs(keyframes.times) do
      headings[i] = { time = time, position = { keyframes.headings[i], 0, 0 } }
    end
    for i, time in ipairs(times) do yaws[i] = tracks.at(headings, time)[1] end
    return { times = times, positions = positions, yaws = yaws }
  end
  for i, time in ipairs(camera.guess.times) do positions[i] = tracks.at(path, time) end
  return { times = camera.guess.times, positions = positions, yaws = camera.guess.yaws }
end

-- The heading of a vehicle that cannot stand still is its course.
local function check_yaws(run, p, request)
  for i, k in ipairs(request.keyframes) do
    if k.yaw then
      point_mass.must_rest(run, p, "keyframes[" .. i .. "].yaw_deg",
                           "the heading is that of the flight and cannot be set")
    end
  end
end

-- What all problems of a film have alike: the whole one, and those of its parts. `part`: of a live
-- subject, what is needed for it alone.
local function prepared(run, request, part)
  local o, vehicle, scope = run.options, request.vehicle, request.scope
  local duration = request.duration * request.stretch
  local camera = scope ~= "flight" and vehicle.gimbal
    and subjects.plan(run, request, duration, part)
  local environment, bystanders = surroundings.state(run, request, camera)
  local step = o.step or math.min(math.max(STEP, duration / (MOST_STAGES - 1)),
                                  duration / FEWEST_INTERVALS)
  return { duration = duration, camera = camera, keyframes = film_keyframes.of(request, o),
           environment = environment, bystanders = bystanders, step = step }
end

local function new_problem(run, request, film, times)
  if request.free then
    return run:problem(surroundings.stated(film.environment, {
      vehicle = request.vehicle, legs = request.free.legs }))
  end
  return run:problem(surroundings.stated(film.environment, {
    vehicle = request.vehicle, begin = times.begin, duration = times.finish - times.begin,
    step = film.step }))
end

-- Costs, constraints and first guess of the part of a film between two times (film_parts.lua).
local function fill(run, request, film, part)
  local o, vehicle, scope, p = run.options, request.vehicle, request.scope, part.problem
  local keyframes, environment, free = film.keyframes, film.environment, request.free
  local camera = parts.camera(part, film.camera)
  local limited, path, track = scope ~= "unlimited", film.way.path, request.track
  if track then
    path = {}
    for i, place in ipairs(track.places) do
      path[i] = { time = place.time, position = place.value }
    end
  end
  path = parts.line(part, path)
  local places = parts.entries(part, keyframes.places)
  if #places > 0 then
    p:add_cost { type = "keyframe", weight = o.weights.keyframe, keyframes = places }
  end
  point_mass.add(p, vehicle, motion_of(o, limited and
    { across = "extent", share = free and free.share or nil } or nil))
  if limited then
    surroundings.add(p, environment, camera,
                     film.way.corridor and parts.spans(part, film.way.corridor))
  end
  surroundings.add_cruise(p, request, o.weights.speed, part)
  surroundings.add_speed_limit(p, o, limited)
  if track and free then
    film_times.add_path(p, track, keyframes.times)
  elseif track and scope ~= "flight" then
    p:add_cost { type = "keyframe", name = "path", weight = track.weight,
                 keyframes = parts.entries(part, track.places) }
  end
  local yaws = parts.entries(part, keyframes.yaws)
  p:add_constraint(boundary(run, p, request.stretch, not camera and #keyframes.yaws == 0, part))
  check_yaws(run, p, request)
  if #yaws > 0 then
    p:add_cost { type = "keyframe", name = "keyframe_yaw", block = "yaw",
                 weight = o.weights.keyframe, keyframes = yaws }
  end
  -- A miss that the certificate would not pass is no price for better times.
  local tolerance = o.hard or free and film_keyframes.MISS
  if tolerance and #places > 0 then
    p:add_constraint { type = "hard_keyframe", tolerance = tolerance, keyframes = places }
    if o.hard and #yaws > 0 then
      p:add_constraint { type = "hard_keyframe", name = "hard_yaw", block = "yaw",
                         tolerance = HARD_YAW, keyframes = yaws }
    end
  end
  if camera then
    cameras.add(p, o.weights, camera, path, request.looks_round and environment, free ~= nil)
  end
  if scope == "film" or scope == "unconstrained" then
    own.add(p, o, request.terms, scope == "film")
  end
  if free then film_times.add(p, free.second, request.wishes, keyframes.times) end
  local guessed = guess(keyframes, camera, path)
  if not p:rests() then guessed.yaws = point_mass.courses(guessed.positions) end
  p:guess_path(guessed)
end

-- What the plan of a film is judged by.
local function task_of(run, film)
  local task, camera, o = { keyframes = film.keyframes.task }, film.camera, run.options
  if not camera then return task end
  task.framing = {}
  for i, span in ipairs(camera.spans) do
    task.framing[i] = { subject = span.subject.name, start = span.start, finish = span.finish }
  end
  task.framing_share = #task.framing > 0 and o.framing or nil
  task.line_of_sight_required = o.line_of_sight == "required"
  return task
end

-- What a request asks for, as {problem, task, camera, legs, film}; `legs` as the request's, with
-- the ways that were planned here; `film` is for problem.part.
function problem.state(run, request)
  local film = prepared(run, request)
  local whole = parts.whole(film.duration)
  local p = new_problem(run, request, film, whole)
  whole.problem = p
  film_keyframes.check(run, p, request, film.camera, film.bystanders)
  film.way = live.films(request) and ways.straight(film.keyframes)
    or ways.planned(p, film.keyframes, film.environment, run.options.planner, request.legs,
                    request.corridor)
  fill(run, request, film, whole)
  p:finish()
  return { problem = p, task = task_of(run, film), camera = film.camera or nil,
           legs = film.way.legs, film = film }
end

-- The problem of a part {begin, finish, first, last} of a film that was stated. `before`:
-- {solution, stage, held}, the part of the flight that it continues; nil: none.
-- With a live subject the part is planned at the time `now`.
function problem.part(run, request, film, part, before, now)
  if live.films(request) then
    request = live.seen(request, now)
    film = prepared(run, request, part)
    film.way = ways.straight(film.keyframes)
  end
  part.problem = new_problem(run, request, film, part)
  fill(run, request, film, part)
  if before then
    part.problem:continue_from(before.solution, { stage = before.stage, held = before.held })
  end
  part.problem:finish()
  return part.problem
end

-- For problems that share some of it.
problem.parts = { boundary = boundary, motion = motion_of, guess = guess }

return problem
