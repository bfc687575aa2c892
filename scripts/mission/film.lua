-- Films: fly through keyframes with the camera on a subject, smoothly, within what the vehicle can
-- do and clear of obstacles (thesis 3.5, 3.6).
--
--   local film = require "mission.film"
--   return film.shot { subject = { position = {4, 6, 1} },
--                      keyframes = { { position = {0, 0, 2} } , { position = {8, 0, 5} } } }
--
-- Minimised: the miss of keyframes and of what is looked at, the fourth derivative of position
-- (snap), derivatives of yaw, target and gimbal, the angle between camera and target, effort. Held:
-- the limits of vehicle and gimbal, obstacles, how the flight begins and ends, with `hard` the
-- keyframes.
local input = require "mission.film_input"
local problem = require "mission.film_problem"
local shot_file = require "mission.shot_file"
local subjects = require "mission.subjects"
local times = require "mission.keyframe_times"

local film = { shots = require "mission.shot_types" }

local HOVER = 10                -- s, of a single keyframe without a time
local LARGEST_STRETCH = 64
local CAMERA_STRETCH = 1.05     -- steps beyond what the flight alone needs
local STRETCH_ACCURACY = 1.01   -- the smallest certified stretch is found to 1 %

local function weight(name, default, summary)
  return { name = name, type = "number", default = default, minimum = 0, maximum = 1e9,
           summary = summary }
end
local weights = {
  weight("keyframe", 100, "miss of a keyframe, per m^2 and rad^2"),
  weight("smoothness", 1e-3, "derivative of position"),
  weight("yaw", 0.02, "second derivative of yaw"),
  weight("effort", 0.01, "forces beyond hovering"),
  weight("target", 10, "target away from what is looked at, per m^2 s"),
  weight("target_smoothness", 0.01, "third derivative of the target"),
  weight("gimbal", 0.02, "second derivative of the gimbal's angles"),
  weight("camera", 100, "camera away from the target, per rad^2 s"),
  weight("skewness", 0, "seeing a subject from far above or below"),
  weight("framing", 100, "a subject away from its place and size in the image"),
  weight("occlusion", 10, "obstacles between camera and target"),
}
local ends = { "rest", "moving", "free" }
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
  { name = "obstacles", type = "tables", table = input.obstacle, summary = "to keep out of" },
  { name = "margin", type = "number", unit = "m", default = 0.5, minimum = 0, maximum = 1e3,
    summary = "kept from every obstacle, the vehicle's own radius included" },
  { name = "cuts", type = "tables", table = input.cut, summary = "footage that is thrown away" },
  { name = "framing", type = "number", default = 0.95, above = 0, maximum = 1,
    summary = "share of the time that a subject must be in the image" },
  { name = "solver", type = "plugin", kind = "trajectory_solver", default = "iqp",
    summary = "trajectory solver" },
  { name = "planner", type = "plugin", kind = "path_planner", default = "bit_star",
    summary = "finds a way round obstacles to begin with" },
}
local of_shot = {
  { name = "duration", type = "number", unit = "s", above = 0, maximum = 1e5,
    summary = "of the flight; absent: up to the last keyframe" },
  { name = "keyframes", type = "tables", required = true, table = input.keyframe,
    summary = "where to be, and when" },
  { name = "subjects", type = "tables", table = input.subject,
    summary = "what is filmed; one alone may be given as `subject`" },
}
local of_file = { { name = "input", type = "text", summary = "a designer's shot, JSON" } }

-- ---- solving ------------------------------------------------------------------------------------

-- `only`: "unlimited", as if the vehicle could do anything; "flight", without the camera.
local function attempt(run, shot, stretch, only)
  local stated, task, camera = problem.state(run, shot, stretch, only)
  local cuts = camera and camera.cuts or {}
  local result = { stretch = stretch, task = task, camera = camera, cuts = cuts }
  result.solution = run:solve(stated, run.options.solver)
  result.verdict = run:certify(run:plan { solution = result.solution, task = task, cuts = cuts })
  return result
end

-- What more time would not mend: a way that obstacles close, a subject that the gimbal cannot see.
local function blocked(failing)
  return string.find(failing.verdict.failures[1] or "", "^clearance") ~= nil
end
local function out_of_sight(failing)
  return string.find(failing.verdict.failures[1] or "", "^framing") ~= nil
end

-- Which limit a film breaks, where and when: a leg that is too fast for it, or else what the film
-- would ask for if nothing held it.
local function broken_limit(run, shot, failing, leg)
  if leg then return leg end
  if out_of_sight(failing) then
    return subjects.hidden(failing.camera, shot.vehicle) or failing.verdict.failures[1]
  end
  local free = attempt(run, shot, failing.stretch, "unlimited")
  local limit = free.solution.status == "optimal" and free.verdict.failures[1]
  return limit or failing.verdict.failures[1] or failing.solution.message
end

-- Certified, and not only because the least violation hides in the verifier's tolerance.
local function holds(tried)
  return tried.verdict.feasible and tried.solution.status ~= "infeasible"
end

-- The smallest stretch above a failing attempt at which the film is certified, to 1 %; or nil.
-- Below `least` no film is possible. The flight alone is what takes time, so that is looked for
-- first, and stretched further only where the camera needs more.
local function smallest_stretch(run, shot, failing, least)
  local low, good, more = math.max(failing.stretch, least), nil, 0.05
  local most = failing.stretch * LARGEST_STRETCH
  while not good and low * (1 + more) < most and not run:cancelled() do
    local tried = attempt(run, shot, low * (1 + more), "flight")
    if holds(tried) then good = tried else low, more = tried.stretch, 2 * more end
  end
  while good and good.stretch / low > STRETCH_ACCURACY and not run:cancelled() do
    local tried = attempt(run, shot, math.sqrt(low * good.stretch), "flight")
    if holds(tried) then good = tried else low = tried.stretch end
  end
  local stretch = good and good.stretch
  while stretch and stretch < most and not run:cancelled() do
    local tried = attempt(run, shot, stretch)
    if holds(tried) then return tried end
    stretch = stretch * CAMERA_STRETCH
  end
end

local function finished(run, shot, chosen, notes, certified)
  return run:plan { solution = chosen.solution, task = chosen.task, cuts = chosen.cuts,
                    notes = notes, geodetic_origin = shot.origin,
                    figures = { stretch = chosen.stretch, certified_stretch = certified } }
end

-- Subjects and looks ask for a camera that turns by itself.
local function check_gimbal(run, shot)
  if shot.vehicle.gimbal then return end
  local message = "vehicle '" .. shot.vehicle.name .. "' has no gimbal to look at it with"
  if #shot.subjects > 0 then run:fail("subjects[1]", message) end
  for i, k in ipairs(shot.keyframes) do
    if k.look_at or k.subject then run:fail("keyframes[" .. i .. "].look_at", message) end
  end
  if #shot.cuts > 0 then run:fail("cuts", "there is nothing to cut between: no subject") end
end

local function fly(run, shot)
  local o = run.options
  shot.vehicle = run:vehicle(o.vehicle)
  shot.cuts, shot.subjects = o.cuts, shot.subjects or {}
  if #shot.keyframes == 0 then run:fail("keyframes", "expected at least one keyframe") end
  check_gimbal(run, shot)
  times.fill(shot, shot.vehicle)
  times.check(run, shot)
  times.unwrap_yaw(shot.keyframes)
  local last = shot.keyframes[#shot.keyframes].time
  shot.duration = shot.duration or (last > 0 and last or HOVER)
  local least, why = times.fastest_leg(shot.keyframes, shot.vehicle, o.hard or problem.MISS,
                                      o.hard and 0 or problem.LATE)
  local auto = o.stretch == "auto"
  local first = attempt(run, shot, auto and 1 or o.stretch, auto and why and "flight" or nil)
  local status = first.solution.status
  local broken = not why and (status == "numerical_error" or status == "unsupported")
  if first.verdict.feasible or broken or run:cancelled() then
    return finished(run, shot, first, {}, first.verdict.feasible and first.stretch or nil)
  end
  if not why and blocked(first) then return finished(run, shot, first, {}) end
  local hopeless = not why and out_of_sight(first)
  why = broken_limit(run, shot, first, why)
  if hopeless or not o.hard and not auto then return finished(run, shot, first, { why }) end
  local good = smallest_stretch(run, shot, first, least)
  local note = good and string.format("%s; certified from a stretch of %.2f", why, good.stretch)
    or string.format("%s; no stretch up to %g is certified", why, LARGEST_STRETCH)
  if run:cancelled() then note = why .. "; the search for a stretch was cancelled" end
  local chosen = auto and good or first
  return finished(run, shot, chosen, { note }, good and good.stretch or nil)
end

-- ---- what scripts call --------------------------------------------------------------------------

local function mission(what, given, declared, shot_of)
  if type(given) ~= "table" then lapwing.fail(what .. ": expected a table, got " .. type(given)) end
  local options = input.written_out(given)
  local name = options.name or "film"
  options.name = nil
  local all = table.move(common, 1, #common, #declared + 1, { table.unpack(declared) })
  return { kind = "film", name = name, options = lapwing.options(all, options),
           plan = function(run) return fly(run, shot_of(run)) end }
end

-- film.shot { name =, duration =, subject = { position =, height = }, keyframes = { { time =,
--             position =, look_at = }, ... }, obstacles = {...}, cuts = {...}, ... }
function film.shot(given)
  return mission("film.shot", given, of_shot, function(run)
    local o = run.options
    return { keyframes = o.keyframes, duration = o.duration, subjects = o.subjects }
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
