-- Films: fly through keyframes, smoothly, within what the vehicle can do (thesis 3.5.1, 3.5.2).
--
--   local film = require "mission.film"
--   return film.shot { keyframes = { { position = {0, 0, 2} } , { position = {8, 0, 5} } } }
--
-- Minimised: the miss of keyframes, the fourth derivative of position (snap), the second of yaw,
-- effort. Held: the vehicle's limits, how the flight begins and ends, with `hard` the keyframes.
local shot_file = require "mission.shot_file"
local times = require "mission.keyframe_times"

local film = {}

local HOVER = 10                -- s, of a single keyframe without a time
local STEP = 0.1                -- s, unless `step` says otherwise
local MOST_STAGES = 3000
local FEWEST_INTERVALS = 12
local MISS = 0.5                -- m, allowed where `hard` says nothing
local LATE = 0.1                -- s, by which a keyframe may be early or late; `hard` allows none
local HARD_YAW = math.rad(8)    -- with `hard`: largest miss of yaw; the certificate allows 10 deg
local LARGEST_STRETCH = 64
local STRETCH_ACCURACY = 1.01   -- the smallest certified stretch is found to 1 %

local ends = { "rest", "moving", "free" }
local weights = {
  { name = "keyframe", type = "number", default = 100, minimum = 0, maximum = 1e9,
    summary = "miss of a keyframe, per m^2 and rad^2" },
  { name = "smoothness", type = "number", default = 1e-4, minimum = 0, maximum = 1e9,
    summary = "derivative of position" },
  { name = "yaw", type = "number", default = 0.1, minimum = 0, maximum = 1e9,
    summary = "second derivative of yaw" },
  { name = "effort", type = "number", default = 0.01, minimum = 0, maximum = 1e9,
    summary = "forces beyond hovering" },
}
local common = {
  { name = "vehicle", type = "vehicle", default = "vehicles/solo", summary = "file or table" },
  { name = "step", type = "number", unit = "s", above = 0,
    summary = "longest time between stages; absent: 0.1 s, and at most 3000 stages" },
  { name = "order", type = "integer", default = 4, minimum = 1, maximum = 4,
    summary = "derivative of position that is kept small: 3 is jerk, 4 is snap" },
  { name = "weights", type = "table", summary = "of the cost terms", table = weights },
  { name = "start", type = "choice", default = "rest", choices = ends, summary = "first state" },
  { name = "finish", type = "choice", default = "rest", choices = ends, summary = "last state" },
  { name = "start_velocity", type = "numbers", size = 3, unit = "m/s", summary = "if moving" },
  { name = "finish_velocity", type = "numbers", size = 3, unit = "m/s", summary = "if moving" },
  { name = "hard", type = "number", unit = "m", above = 0,
    summary = "keyframes must be met within this; absent: they pull" },
  { name = "stretch", type = "number", default = 1, minimum = 1e-3, maximum = 1e3,
    words = { "auto" }, summary = "factor on all times; auto: the smallest that is certified" },
  { name = "solver", type = "plugin", kind = "trajectory_solver", default = "iqp",
    summary = "trajectory solver" },
}
local keyframe = {
  { name = "time", type = "number", unit = "s", minimum = 0,
    summary = "absent: evenly between the others" },
  { name = "position", type = "numbers", size = 3, unit = "m", required = true,
    minimum = -1e6, maximum = 1e6, summary = "world: east, north, up" },
  { name = "yaw_deg", type = "number", unit = "deg", summary = "0 east, counter-clockwise" },
}
local of_shot = {
  { name = "duration", type = "number", unit = "s", above = 0, maximum = 1e5,
    summary = "of the flight; absent: up to the last keyframe" },
  { name = "keyframes", type = "tables", required = true, table = keyframe,
    summary = "where to be, and when" },
}
local of_file = { { name = "input", type = "text", summary = "a designer's shot, JSON" } }

-- ---- the problem --------------------------------------------------------------------------------

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

-- The film with all times multiplied by `stretch`: problem and task. `unlimited`: as if the vehicle
-- could do anything.
local function state_problem(run, shot, stretch, unlimited)
  local o = run.options
  local places, yaws, task = {}, {}, {}
  local guess = { times = {}, positions = {}, yaws = {} }
  local heading = 0
  for _, k in ipairs(shot.keyframes) do heading = k.yaw or heading if k.yaw then break end end
  for i, k in ipairs(shot.keyframes) do
    local time = k.time * stretch
    heading = k.yaw or heading
    places[i] = { time = time, value = k.position }
    if k.yaw then yaws[#yaws + 1] = { time = time, value = { k.yaw } } end
    guess.times[i], guess.positions[i], guess.yaws[i] = time, k.position, heading
    task[i] = { time = time, position = k.position, yaw = k.yaw, tolerance = o.hard or MISS,
                time_tolerance = o.hard and 0 or LATE }
  end
  local duration = shot.duration * stretch
  local step = o.step or math.min(math.max(STEP, duration / (MOST_STAGES - 1)),
                                  duration / FEWEST_INTERVALS)
  local p = run:problem { vehicle = shot.vehicle, duration = duration, step = step }
  p:add_model { type = "quadrotor" }
  p:add_cost { type = "keyframe", weight = o.weights.keyframe, keyframes = places }
  p:add_cost(smoothness(o, shot.vehicle))
  p:add_cost { type = "yaw_derivative", name = "yaw", weight = o.weights.yaw }
  p:add_cost { type = "input_effort", name = "effort", weight = o.weights.effort }
  if not unlimited then
    p:add_constraint { type = "input_limits", across = "extent" }
    p:add_constraint { type = "state_limits" }
  end
  p:add_constraint(boundary(o, stretch, #yaws == 0 and 0 or nil))
  if #yaws > 0 then
    p:add_cost { type = "keyframe", name = "keyframe_yaw", block = "yaw",
                 weight = o.weights.keyframe, keyframes = yaws }
  end
  if o.hard then
    p:add_constraint { type = "hard_keyframe", tolerance = o.hard, keyframes = places }
    if #yaws > 0 then
      p:add_constraint { type = "hard_keyframe", name = "hard_yaw", block = "yaw",
                         tolerance = HARD_YAW, keyframes = yaws }
    end
  end
  p:guess_path(guess)
  p:finish()
  return p, { keyframes = task }
end

-- ---- solving ------------------------------------------------------------------------------------

local function attempt(run, shot, stretch, unlimited)
  local problem, task = state_problem(run, shot, stretch, unlimited)
  local result = { stretch = stretch, problem = problem, task = task }
  result.solution = run:solve(problem, run.options.solver)
  result.verdict = run:certify(run:plan { solution = result.solution, task = task })
  return result
end

-- Which limit a film breaks, where and when: a leg that is too fast for it, or else what the film
-- would ask for if nothing held it.
local function broken_limit(run, shot, failing, leg)
  if leg then return leg end
  local free = attempt(run, shot, failing.stretch, true)
  local limit = free.solution.status == "optimal" and free.verdict.failures[1]
  return limit or failing.verdict.failures[1] or failing.solution.message
end

-- Certified, and not only because the least violation hides in the verifier's tolerance.
local function holds(tried)
  return tried.verdict.feasible and tried.solution.status ~= "infeasible"
end

-- The smallest stretch above a failing attempt at which the film is certified, to 1 %; or nil.
-- Below `least` no film is possible.
local function smallest_stretch(run, shot, failing, least)
  local low, good, more = math.max(failing.stretch, least), nil, 0.05
  while not good and low * (1 + more) < failing.stretch * LARGEST_STRETCH and not run:cancelled() do
    local tried = attempt(run, shot, low * (1 + more))
    if holds(tried) then good = tried else low, more = tried.stretch, 2 * more end
  end
  while good and good.stretch / low > STRETCH_ACCURACY and not run:cancelled() do
    local tried = attempt(run, shot, math.sqrt(low * good.stretch))
    if holds(tried) then good = tried else low = tried.stretch end
  end
  return good
end

local function finished(run, shot, chosen, notes, certified)
  return run:plan { solution = chosen.solution, task = chosen.task, notes = notes,
                    geodetic_origin = shot.origin,
                    figures = { stretch = chosen.stretch, certified_stretch = certified } }
end

local function fly(run, shot)
  local o = run.options
  shot.vehicle = run:vehicle(o.vehicle)
  if #shot.keyframes == 0 then run:fail("keyframes", "expected at least one keyframe") end
  times.fill(shot, shot.vehicle)
  times.check(run, shot)
  times.unwrap_yaw(shot.keyframes)
  local last = shot.keyframes[#shot.keyframes].time
  shot.duration = shot.duration or (last > 0 and last or HOVER)
  local first = attempt(run, shot, o.stretch == "auto" and 1 or o.stretch)
  local least, why = times.fastest_leg(shot.keyframes, shot.vehicle, o.hard or MISS,
                                      o.hard and 0 or LATE)
  local status = first.solution.status
  local broken = not why and (status == "numerical_error" or status == "unsupported")
  if first.verdict.feasible or broken or run:cancelled() then
    return finished(run, shot, first, {}, first.verdict.feasible and first.stretch or nil)
  end
  why = broken_limit(run, shot, first, why)
  if not o.hard and o.stretch ~= "auto" then return finished(run, shot, first, { why }) end
  local good = smallest_stretch(run, shot, first, least)
  local note = good and string.format("%s; certified from a stretch of %.2f", why, good.stretch)
    or string.format("%s; no stretch up to %g is certified", why, LARGEST_STRETCH)
  if run:cancelled() then note = why .. "; the search for a stretch was cancelled" end
  local chosen = o.stretch == "auto" and good or first
  return finished(run, shot, chosen, { note }, good and good.stretch or nil)
end

-- ---- what scripts call --------------------------------------------------------------------------

local function mission(what, given, declared, shot_of)
  if type(given) ~= "table" then lapwing.fail(what .. ": expected a table, got " .. type(given)) end
  local options = {}
  for key, value in pairs(given) do options[key] = value end
  for _, key in ipairs { "subject", "look_at", "look-at", "obstacles" } do
    if options[key] ~= nil then
      lapwing.fail(key .. ": not supported by this version, which films keyframes alone")
    end
  end
  local name = options.name or "film"
  options.name = nil
  local all = table.move(common, 1, #common, #declared + 1, { table.unpack(declared) })
  return { kind = "film", name = name, options = lapwing.options(all, options),
           plan = function(run) return fly(run, shot_of(run)) end }
end

-- film.shot { name =, duration =, keyframes = { { time =, position =, yaw_deg = }, ... }, ... }
function film.shot(given)
  return mission("film.shot", given, of_shot, function(run)
    return { keyframes = run.options.keyframes, duration = run.options.duration }
  end)
end

-- film.from_file { file = "shot_01.json", hard =, ... }; --set input=PATH replaces the file.
function film.from_file(given)
  if type(given) == "table" then
    local options = {}
    for key, value in pairs(given) do options[key == "file" and "input" or key] = value end
    given = options
  end
  return mission("film.from_file", given, of_file, shot_file.read)
end

return film
