-- SPDX-License-Identifier: Apache-2.0
-- A film as a trajectory problem: blocks, cost terms, constraints, a first guess, and the task that
-- its plan is judged by (thesis 3.5).
local surroundings = require "mission.film_environment"
local live = require "mission.film_live"
local own = require "mission.own_terms"
local parts = require "mission.film_parts"
local point_mass = require "mission.point_mass"
local subjects = require "mission.subjects"
local tracks = require "mission.tracks"
local ways = require "mission.ways"

local problem = {}

problem.MISS = 0.5              -- m, allowed where `hard` says nothing
problem.LATE = 0.1              -- s, by which a keyframe may be early or late; `hard` allows none
local STEP = 0.1                -- s, unless `step` says otherwise
local MOST_STAGES = 3000
local FEWEST_INTERVALS = 12
local HARD_YAW = math.rad(8)    -- with `hard`: largest miss of yaw; the certificate allows 10 deg

-- `free_yaw`: nothing else says where the vehicle heads.
-- `part`: of a part of the film that is neither its beginning nor its end, that is free; nil: all.
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

-- Keyframes with all times multiplied: places, yaws, task, and a straight guess through them.
local function keyframes_of(request, options)
  local made = { places = {}, yaws = {}, task = {}, times = {}, positions = {}, headings = {} }
  local heading = 0
  for _, k in ipairs(request.keyframes) do heading = k.yaw or heading if k.yaw then break end end
  for i, k in ipairs(request.keyframes) do
    local time = k.time * request.stretch
    heading = k.yaw or heading
    made.places[i] = { time = time, value = k.position }
    if k.yaw then made.yaws[#made.yaws + 1] = { time = time, value = { k.yaw } } end
    made.times[i], made.positions[i], made.headings[i] = time, k.position, heading
    if not k.live then  -- nobody can promise a place beside a live subject
      made.task[#made.task + 1] = { time = time, position = k.position, yaw = k.yaw,
                                    tolerance = options.hard or problem.MISS,
                                    time_tolerance = options.hard and 0 or problem.LATE }
    end
  end
  return made
end

-- A keyframe so deep in an obstacle, or so near to a subject, that it cannot be met.
local function check_keyframes(run, p, request, camera, bystanders)
  local options = run.options
  local reach = options.hard or problem.MISS
  for i, k in ipairs(request.keyframes) do
    if k.live then goto continue end  -- the flight comes as near as it may
    local time = k.time * request.stretch
    local distance, name = p:nearest_obstacle(k.position, time)
    local function check_people(what, people)
      for _, person in ipairs(people) do
        local at = tracks.at(person.track, k.time * request.stretch)
        local away = lapwing.norm(lapwing.vector(k.position) - at)
        if person.distance and away + reach < person.distance then
          run:fail("keyframes[" .. i .. "].position", string.format(
            "%.3g m from %s '%s', and %g m are required", away, what, person.name,
            person.distance))
        end
      end
    end
    check_people("subject", camera and camera.list or {})
    check_people("bystander", bystanders)
    local outside, zone = p:flight_zone_distance(k.position, time)
    if outside + reach < options.margin then
      run:fail("keyframes[" .. i .. "].position", string.format(
        "%s flight zone '%s': %.3g m %s its edge, and %g m are required",
        outside < 0 and "outside" or "too near the edge of", zone, math.abs(outside),
        outside < 0 and "beyond" or "from", options.margin))
    end
    if distance + reach < options.margin then
      run:fail("keyframes[" .. i .. "].position", string.format(
        "%s obstacle '%s': %.3g m from its surface, and %g m are required",
        distance < 0 and "inside" or "too near", name, distance, options.margin))
    end
    ::continue::
  end
end

-- The gimbal's yaw from the course to what is looked at, within half a turn.
local function gimbal_yaws(looks, path)
  local places, list = {}, {}
  for i, time in ipairs(looks.times) do places[i] = tracks.at(path, time) end
  for i, course in ipairs(point_mass.courses(places)) do
    local turn = looks.yaws[i] - course
    list[i] = { turn - 2 * math.pi * math.floor(turn / (2 * math.pi) + 0.5) }
  end
  return list
end

-- The camera's part of thesis 3.5.3: a gimbal, a target that follows what is looked at, and the
-- angle between the two. `environment`: what may hide the target, or false.
local function add_camera(p, weights, camera, path, environment)
  p:add_model { type = "gimbal" }
  p:add_block { name = "target", size = 3, unit = "m" }
  p:add_cost { type = "target_keyframe", weight = weights.target, keyframes = camera.pulls }
  p:add_cost { type = "target_derivative", weight = weights.target_smoothness,
               except = camera.cuts }
  p:add_cost { type = "gimbal_derivative", weight = weights.gimbal, except = camera.cuts }
  local elsewhere = table.move(camera.cuts, 1, #camera.cuts, 1, {})
  for _, span in ipairs(camera.spans) do  -- a place in the image is another than its middle
    if span.subject.place then
      elsewhere[#elsewhere + 1] = { start = span.start, finish = span.finish }
    end
  end
  p:add_cost { type = "camera_angle", weight = weights.camera, except = elsewhere }
  for _, span in ipairs(camera.spans) do
    local subject = span.subject
    local within = { { start = span.start, finish = span.finish } }
    if subject.height > 0 and weights.skewness > 0 then
      p:add_cost { type = "skewness", name = "skewness of " .. subject.name,
                   height = subject.height, weight = weights.skewness, spans = within,
                   except = camera.cuts }
    end
    if subject.place or subject.size then
      p:add_cost { type = "framing", name = "framing of " .. subject.name, subject = subject.name,
                   weight = weights.framing, horizontal = subject.place and subject.place[1],
                   vertical = subject.place and subject.place[2], size = subject.size,
                   spans = within, except = camera.cuts }
    end
  end
  if weights.occlusion > 0 and environment and surroundings.hides(environment) then
    p:add_cost { type = "occlusion", weight = weights.occlusion, except = camera.cuts }
  end
  local values = { gimbal_pitch = {}, target = camera.guess.targets }
  for i, pitch in ipairs(camera.guess.pitches) do values.gimbal_pitch[i] = { pitch } end
  if not p:rests() then values.gimbal_yaw = gimbal_yaws(camera.guess, path) end
  for block, list in pairs(values) do
    p:guess_block { block = block, times = camera.guess.times, values = list }
  end
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
  return { duration = duration, camera = camera, keyframes = keyframes_of(request, o),
           environment = environment, bystanders = bystanders, step = step }
end

local function new_problem(run, request, film, times)
  return run:problem(surroundings.stated(film.environment, {
    vehicle = request.vehicle, begin = times.begin, duration = times.finish - times.begin,
    step = film.step }))
end

-- Costs, constraints and first guess of the part of a film between two times (film_parts.lua).
local function fill(run, request, film, part)
  local o, vehicle, scope, p = run.options, request.vehicle, request.scope, part.problem
  local keyframes, environment = film.keyframes, film.environment
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
  point_mass.add(p, vehicle, motion_of(o, limited and { across = "extent" } or nil))
  if limited then
    surroundings.add(p, environment, camera,
                     film.way.corridor and parts.spans(part, film.way.corridor))
  end
  surroundings.add_cruise(p, request, o.weights.speed, part)
  surroundings.add_speed_limit(p, o, limited)
  if track and scope ~= "flight" then
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
  if o.hard and #places > 0 then
    p:add_constraint { type = "hard_keyframe", tolerance = o.hard, keyframes = places }
    if #yaws > 0 then
      p:add_constraint { type = "hard_keyframe", name = "hard_yaw", block = "yaw",
                         tolerance = HARD_YAW, keyframes = yaws }
    end
  end
  if camera then
    add_camera(p, o.weights, camera, path, request.looks_round and environment)
  end
  if scope == "film" or scope == "unconstrained" then
    own.add(p, o, request.terms, scope == "film")
  end
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
  check_keyframes(run, p, request, film.camera, film.bystanders)
  film.way = live.films(request) and ways.straight(film.keyframes)
    or ways.planned(p, film.keyframes, film.environment, run.options.planner, request.legs,
                    request.corridor)
  fill(run, request, film, whole)
  p:finish()
  return { problem = p, task = task_of(run, film), camera = film.camera or nil,
           legs = film.way.legs, film = film }
end

-- The problem of a part {begin, finish, first, last} of a film that was stated. `before`: {solution,
-- stage, held}, the part of the flight that it continues; nil: none.
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
