-- SPDX-License-Identifier: Apache-2.0
-- A course as a trajectory problem: legs from gate to gate, each with a step of its own, limits,
-- gates, and a straight first guess (thesis 3.7.2).
local courses = require "mission.race_course"
local paths = require "mission.paths"
local point_mass = require "mission.point_mass"

local problem = {}

local SAME = 1e-6           -- m, nearer than this two places are one
local HOVER = 1             -- s, of a course that is a single place
local FEWEST = 4            -- intervals of a leg
local FAR = 1e4             -- m
local AROUND = 100          -- m, of floor around the course
local PIECES = 20           -- of a leg, in the first guess of its time
local GUESS = 0.5           -- share of the acceleration that the first guess uses
local PROFILE = 0.8         -- share of speed and acceleration that a timing by profile uses
local IN_TIME = 1e4         -- times the weight of smoothness where the time is given
local MARGIN_SHARE = 0.1    -- of a small opening, where the margin would take more

-- What the vehicle may use, by the model: speeds up, down and across, acceleration.
local function strength(vehicle, o)
  local thrust = o.model == "quadrotor_full" and 4 * vehicle.rotor_thrust_max or vehicle.thrust_max
  local free = math.max(0.2, o.thrust * thrust / vehicle.mass - point_mass.GRAVITY)
  return { across = vehicle.speed_across, up = vehicle.climb_speed, down = vehicle.descent_speed,
           acceleration = math.min(free, vehicle.acceleration_across, vehicle.acceleration_up,
                                   vehicle.acceleration_down) }
end

-- Seconds from rest to rest along a straight line, at a share of speed and acceleration.
local function straight_time(from, to, limits)
  local way = lapwing.vector(to) - from
  local across, up, d = lapwing.norm { way.x, way.y }, way.z, lapwing.norm(way)
  local slowest = math.max(across / limits.across, up > 0 and up / limits.up or -up / limits.down)
  local speed, a = PROFILE * d / slowest, PROFILE * limits.acceleration
  if d <= speed * speed / a then return 2 * math.sqrt(d / a) end
  return d / speed + speed / a
end

-- Seconds for every leg along straight lines: speeding up from rest, slowing down to rest, and in
-- between the speed at which the acceleration turns a leg of mean length into the next one.
local function flowing_times(made, course, limits)
  local a, length, ends = GUESS * limits.acceleration, 0, { 0 }
  for i = 2, #made.points do
    length = length + paths.distance(made.points[i - 1], made.points[i])
    ends[i] = length
  end
  local cruise = math.min(limits.across, limits.up, limits.down,
                          math.sqrt(a * length / (#made.points - 1)))
  local times = {}
  for i = 2, #made.points do
    local step, time = (ends[i] - ends[i - 1]) / PIECES, 0
    for k = 1, PIECES do
      local at = ends[i - 1] + (k - 0.5) * step
      local speed = cruise
      if not course.closed then speed = math.min(speed, math.sqrt(2 * a * at)) end
      if made.rests then speed = math.min(speed, math.sqrt(2 * a * (length - at))) end
      time = time + step / speed
    end
    times[i - 1] = time
  end
  return times
end

-- Places that legs run between, and for every gate the leg that ends in it. {points =, at =}
local function stations(course)
  local made = { points = {}, at = {} }
  local function go(place)
    local last = made.points[#made.points]
    if not last or paths.distance(last, place) > SAME then
      made.points[#made.points + 1] = place
    end
    return #made.points - 1
  end
  local first = course.gates[1]
  if course.start then
    go(course.start)
  elseif not course.closed then
    if first.direction then
      lapwing.fail("a course whose first gate has a direction needs a start, or closed = true")
    end
    go(first.position)
  end
  for i, gate in ipairs(course.gates) do
    if gate.direction and gate.tunnel_length > 0 then
      made.at[i] = go(courses.place(gate, -0.5))
      go(courses.place(gate, 0.5))
    else
      made.at[i] = go(gate.position)
    end
  end
  local last = course.gates[#course.gates]
  made.rests = not course.closed and (course.finish ~= nil or not last.direction)
  if course.finish then go(course.finish) end
  if course.closed then go(made.points[1]) end
  if #made.points == 1 then made.points[2], made.hovers = made.points[1], true end
  return made
end

-- Legs with first guesses of their durations (s) and numbers of intervals.
function problem.legs(course, vehicle, o)
  local made = stations(course)
  local limits = strength(vehicle, o)
  local profile = o.timing == "profile"
  made.durations, made.intervals, made.total = {}, {}, 0
  if not made.hovers and not profile then made.durations = flowing_times(made, course, limits) end
  for i = 2, #made.points do
    local time = made.hovers and HOVER or made.durations[i - 1]
                 or straight_time(made.points[i - 1], made.points[i], limits)
    made.durations[i - 1] = time
    made.total = made.total + time
  end
  local scale = o.time and o.time / made.total or 1
  for i, time in ipairs(made.durations) do
    made.durations[i] = time * scale
    made.intervals[i] = math.max(FEWEST, math.ceil(made.durations[i] / o.step - 1e-9))
  end
  made.total = made.total * scale
  return made
end

-- The durations of a solution, and intervals no longer than the step.
function problem.take_times(made, solution, o)
  for i, time in ipairs(solution.legs) do
    made.durations[i] = time
    made.intervals[i] = math.max(FEWEST, math.ceil(time / o.step - 1e-9))
  end
  made.total = solution.duration
end

local function floor_of(made, floor)
  if not floor then return nil end
  local low, high = { FAR, FAR }, { -FAR, -FAR }
  for _, p in ipairs(made.points) do
    for k = 1, 2 do low[k], high[k] = math.min(low[k], p[k]), math.max(high[k], p[k]) end
  end
  return { { name = "floor", ceiling = floor,
             corners = { low[1] - AROUND, low[2] - AROUND, high[1] + AROUND, low[2] - AROUND,
                         high[1] + AROUND, high[2] + AROUND, low[1] - AROUND, high[2] + AROUND } } }
end

local function add_model(p, vehicle, o, model, softer)
  local smoothness = softer * o.weights.smoothness * (o.time and IN_TIME or 1)
  local lower = o.floor and { -FAR, -FAR, o.floor + o.margin }
  if model == "quadrotor_full" then
    p:add_model { type = "quadrotor_full", thrust_share = o.thrust, rate_share = o.rate_share }
    p:add_cost { type = "derivative", name = "smoothness", block = "rotor_thrusts", order = 1,
                 weight = smoothness }
    p:add_constraint { type = "state_limits", lower = lower }
  else
    point_mass.add(p, vehicle, { force = { order = 1, weight = smoothness },
                                 yaw = { order = 1, weight = 1e-3 }, lower = lower,
                                 inputs = { norm = o.timing ~= "profile", share = o.thrust } })
  end
end

local function add_gates(p, course, made, o)
  local clock, ends = 0, { [0] = 0 }
  for i, time in ipairs(made.durations) do
    clock = clock + time
    ends[i] = clock
  end
  for i, gate in ipairs(course.gates) do
    local size = math.min(gate.width or FAR, gate.height or FAR, gate.radius or FAR,
                          gate.side or FAR)
    local margin = math.min(o.margin, MARGIN_SHARE * size)
    if gate.shape == "ball" and o.timing == "profile" then
      p:add_constraint { type = "hard_keyframe", name = gate.name, tolerance = gate.radius - margin,
                         keyframes = { { time = ends[made.at[i]], value = gate.position } } }
    else
      p:add_constraint { type = "gate", name = gate.name, leg = made.at[i], shape = gate.shape,
                         position = gate.position, direction = gate.direction,
                         width = gate.width, height = gate.height, radius = gate.radius,
                         side = gate.side, tunnel_length = gate.tunnel_length, margin = margin }
    end
  end
end

-- At rest a point mass has no speed; hovering too is asked for where a controller must follow.
local function ends_of(course, made, o, model)
  local state = { type = "boundary_state", start_position = made.points[1],
                  finish_position = course.finish }
  local hovers = o.closed_loop == "required" or model == "quadrotor_full"
  for _, name in ipairs { "start", "finish" } do
    local rests = name == "start" or made.rests
    state[name] = not rests and "free" or hovers and "rest" or "moving"
    if state[name] == "moving" then state[name .. "_velocity"] = { 0, 0, 0 } end
  end
  return state
end

-- The problem of these legs by the options o; `coarse` is the solution to begin from, on fewer
-- stages or of another model.
function problem.make(run, course, vehicle, made, o, model, coarse)
  local legs = {}
  local free = o.timing == "optimal" and not made.hovers
  for i, time in ipairs(made.durations) do
    legs[i] = { duration = time, intervals = made.intervals[i], mode = free and "free" or "fixed" }
  end
  local p = run:problem { vehicle = vehicle, legs = legs, periodic = course.closed,
                          environment = { zones = floor_of(made, o.floor) } }
  add_model(p, vehicle, o, model, made.softer or 1)
  if free then p:add_cost { type = "flight_time", weight = 1 } end
  if free and o.time then
    p:add_constraint { type = "hard_keyframe", name = "time", block = "time",
                       keyframes = { { time = made.total, value = { o.time } } } }
  end
  add_gates(p, course, made, o)
  if not course.closed then
    p:add_constraint(ends_of(course, made, o, model))
  end
  if coarse then
    p:guess_solution(coarse)
  else
    local times, yaws, clock = { 0 }, { 0 }, 0
    for i, time in ipairs(made.durations) do
      clock = clock + time
      times[i + 1], yaws[i + 1] = clock, 0
    end
    p:guess_path { times = times, positions = made.points, yaws = yaws }
  end
  p:finish()
  return p
end

return problem
