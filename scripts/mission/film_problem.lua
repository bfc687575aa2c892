-- A film as a trajectory problem: blocks, cost terms, constraints, a first guess, and the task that
-- its plan is judged by (thesis 3.5).
local surroundings = require "mission.film_environment"
local own = require "mission.own_terms"
local passages = require "mission.passages"
local subjects = require "mission.subjects"
local tracks = require "mission.tracks"

local problem = {}

problem.MISS = 0.5              -- m, allowed where `hard` says nothing
problem.LATE = 0.1              -- s, by which a keyframe may be early or late; `hard` allows none
local STEP = 0.1                -- s, unless `step` says otherwise
local MOST_STAGES = 3000
local FEWEST_INTERVALS = 12
local HARD_YAW = math.rad(8)    -- with `hard`: largest miss of yaw; the certificate allows 10 deg

local function boundary(options, stretch, yaw)
  local state = { type = "boundary_state", start_yaw = yaw }
  for _, name in ipairs { "start", "finish" } do
    state[name] = options[name]
    local velocity = options[name .. "_velocity"]
    if velocity then
      state[name .. "_velocity"] = {}
      for i = 1, 3 do state[name .. "_velocity"][i] = velocity[i] / stretch end
    end
  end
  return state
end

-- Jerk and snap are derivatives of the force over the mass: the same as of the position, but a
-- fourth difference of positions has rounding errors 1 / step^2 larger.
local function smoothness(options, vehicle)
  local cost = { type = "derivative", name = "smoothness", order = options.order,
                 weight = options.weights.smoothness }
  if options.order > 2 then
    cost.block, cost.order = "force", options.order - 2
    cost.weight = cost.weight / vehicle.mass ^ 2
  end
  return cost
end

-- Keyframes with all times multiplied: places, yaws, task, and a straight guess through them.
local function keyframes_of(shot, stretch, options)
  local made = { places = {}, yaws = {}, task = {}, times = {}, positions = {}, headings = {} }
  local heading = 0
  for _, k in ipairs(shot.keyframes) do heading = k.yaw or heading if k.yaw then break end end
  for i, k in ipairs(shot.keyframes) do
    local time = k.time * stretch
    heading = k.yaw or heading
    made.places[i] = { time = time, value = k.position }
    if k.yaw then made.yaws[#made.yaws + 1] = { time = time, value = { k.yaw } } end
    made.times[i], made.positions[i], made.headings[i] = time, k.position, heading
    made.task[i] = { time = time, position = k.position, yaw = k.yaw,
                     tolerance = options.hard or problem.MISS,
                     time_tolerance = options.hard and 0 or problem.LATE }
  end
  return made
end

-- A keyframe so deep in an obstacle, or so near to a subject, that it cannot be met.
local function check_keyframes(run, p, shot, options, stretch, camera)
  local reach = options.hard or problem.MISS
  local people = table.move(camera and camera.list or {}, 1, camera and #camera.list or 0, 1, {})
  table.move(shot.bystanders, 1, #shot.bystanders, #people + 1, people)
  for i, k in ipairs(shot.keyframes) do
    local distance, name = p:nearest_obstacle(k.position)
    for _, subject in ipairs(people) do
      local at, squares = tracks.at(subject.track, k.time * stretch), 0
      for c = 1, 3 do squares = squares + (k.position[c] - at[c]) ^ 2 end
      if subject.distance and math.sqrt(squares) + reach < subject.distance then
        run:fail("keyframes[" .. i .. "].position", string.format(
          "%.3g m from %s '%s', and %g m are to be kept", math.sqrt(squares),
          subject.bystander and "bystander" or "subject", subject.name, subject.distance))
      end
    end
    local outside, zone = p:flight_zone_distance(k.position)
    if outside + reach < options.margin then
      run:fail("keyframes[" .. i .. "].position", string.format(
        "%s flight zone '%s': %.3g m %s its edge, and %g m are to be kept",
        outside < 0 and "outside" or "too near the edge of", zone, math.abs(outside),
        outside < 0 and "beyond" or "from", options.margin))
    end
    if distance + reach < options.margin then
      run:fail("keyframes[" .. i .. "].position", string.format(
        "%s obstacle '%s': %.3g m from its surface, and %g m are to be kept",
        distance < 0 and "inside" or "too near", name, distance, options.margin))
    end
  end
end

-- The camera's part of thesis 3.5.3: a gimbal, a target that follows what is looked at, and the
-- angle between the two.
local function add_camera(p, weights, camera, environment)
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
  if weights.occlusion > 0 and #environment.spheres + #environment.boxes > 0 then
    p:add_cost { type = "occlusion", weight = weights.occlusion, except = camera.cuts }
  end
  local values = { gimbal_pitch = {}, target = camera.guess.targets }
  for i, pitch in ipairs(camera.guess.pitches) do values.gimbal_pitch[i] = { pitch } end
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

-- Problem, task and camera of a film with all times multiplied by `stretch`. `only`: "unlimited",
-- as if the vehicle could do anything; "flight", without the camera; "unconstrained", with the
-- script's own constraints judged and not held.
function problem.state(run, shot, stretch, only)
  local o = run.options
  local duration = shot.duration * stretch
  local camera = only ~= "flight" and shot.vehicle.gimbal
    and subjects.plan(run, shot, stretch, duration, shot.vehicle)
  local keyframes = keyframes_of(shot, stretch, o)
  local environment = surroundings.state(run, shot, o, camera, stretch)
  local step = o.step or math.min(math.max(STEP, duration / (MOST_STAGES - 1)),
                                  duration / FEWEST_INTERVALS)
  local p = run:problem { vehicle = shot.vehicle, duration = duration, step = step,
                          environment = environment }
  check_keyframes(run, p, shot, o, stretch, camera)
  local path, corridor = passages.path(p, shot, keyframes, environment, o.planner)
  if shot.track then
    path = {}
    for i, place in ipairs(shot.track) do
      path[i] = { time = place.time, position = place.value }
    end
  end
  p:add_model { type = "quadrotor" }
  p:add_cost { type = "keyframe", weight = o.weights.keyframe, keyframes = keyframes.places }
  p:add_cost(smoothness(o, shot.vehicle))
  p:add_cost { type = "yaw_derivative", name = "yaw", weight = o.weights.yaw }
  p:add_cost { type = "input_effort", name = "effort", weight = o.weights.effort }
  if only ~= "unlimited" then
    p:add_constraint { type = "input_limits", across = "extent" }
    p:add_constraint { type = "state_limits" }
    surroundings.add(p, environment, camera, corridor)
  end
  surroundings.add_cruise(p, shot, o.weights.speed, stretch)
  surroundings.add_speed_limit(p, o, only ~= "unlimited")
  if shot.track and only ~= "flight" then  -- of timing.lua
    p:add_cost { type = "keyframe", name = "path", weight = shot.track_weight,
                 keyframes = shot.track }
  end
  local yaws = keyframes.yaws
  p:add_constraint(boundary(o, stretch, not camera and #yaws == 0 and 0 or nil))
  if #yaws > 0 then
    p:add_cost { type = "keyframe", name = "keyframe_yaw", block = "yaw",
                 weight = o.weights.keyframe, keyframes = yaws }
  end
  if o.hard then
    p:add_constraint { type = "hard_keyframe", tolerance = o.hard, keyframes = keyframes.places }
    if #yaws > 0 then
      p:add_constraint { type = "hard_keyframe", name = "hard_yaw", block = "yaw",
                         tolerance = HARD_YAW, keyframes = yaws }
    end
  end
  local task = { keyframes = keyframes.task }
  if camera then
    add_camera(p, o.weights, camera, environment)
    task.framing = {}
    for i, span in ipairs(camera.spans) do
      task.framing[i] = { subject = span.subject.name, start = span.start, finish = span.finish }
    end
    task.framing_share = #task.framing > 0 and o.framing or nil
  end
  if not only or only == "unconstrained" then own.add(p, o, shot.terms, not only) end
  p:guess_path(guess(keyframes, camera, path))
  p:finish()
  return p, task, camera
end

-- For problems that share some of it.
problem.parts = { boundary = boundary, smoothness = smoothness, guess = guess }

return problem
