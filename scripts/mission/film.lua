-- SPDX-License-Identifier: Apache-2.0
-- Films: a smooth flight through keyframes with the camera on a subject, within the limits of the
-- vehicle and clear of obstacles (thesis 3.5, 3.6).
--
--   local film = require "mission.film"
--   return film.shot { subject = { position = {4, 6, 1} },
--                      keyframes = { { position = {0, 0, 2} } , { position = {8, 0, 5} } } }
--
-- Minimised: the distance from keyframes and from the subject, the fourth derivative of position
-- (snap), derivatives of yaw, target and gimbal, the angle between camera and target, effort.
-- Constraints: the limits of vehicle and gimbal, obstacles, the state at start and end, and with
-- `hard` the keyframes.
local mission_of = require "mission.mission_of"
local input = require "mission.film_input"
local own = require "mission.own_terms"
local search = require "mission.film_search"
local shot_file = require "mission.shot_file"

local film = { shots = require "mission.shot_types" }

local function weight(name, default, summary)
  return { name = name, type = "number", default = default, minimum = 0, maximum = 1e9,
           summary = summary }
end
local weights = {
  weight("keyframe", 100, "distance from a keyframe, per m^2 and rad^2"),
  weight("smoothness", 1e-3, "squared position derivative of order `order`"),
  weight("yaw", 0.02, "squared second derivative of yaw"),
  weight("effort", 0.01, "force and yaw torque beyond hovering; models with forces only"),
  weight("target", 10, "distance of the target from the subject, per m^2 s"),
  weight("target_smoothness", 0.01, "squared third derivative of the target"),
  weight("gimbal", 0.02, "squared second derivative of the gimbal angles"),
  weight("camera", 100, "angle between camera axis and target, per rad^2 s"),
  weight("skewness", 0, "views of a subject from far above or below"),
  weight("framing", 100, "deviation of a subject from its place and size in the image"),
  weight("occlusion", 10, "obstacles between camera and target"),
  weight("speed", 1, "deviation from the `speed` of a leg, per m^2/s"),
  weight("time", 1, "duration, per s, if timing is free"),
}
local ends = { "rest", "moving", "free" }
local common = {
  { name = "vehicle", type = "vehicle", default = "vehicles/solo", summary = "vehicle" },
  { name = "step", type = "number", unit = "s", above = 0,
    summary = "longest time between stages; absent: 0.1 s, longer beyond 3000 stages" },
  { name = "horizon", type = "number", unit = "s", above = 0,
    summary = "solve the film in parts of this length that overlap; absent: as one problem" },
  { name = "update", type = "number", unit = "s", default = 0.1, above = 0, maximum = 10,
    summary = "time between two plans of a film with a live subject" },
  { name = "order", type = "integer", default = 4, minimum = 1, maximum = 4,
    summary = "order of the penalised position derivative: 3 is jerk, 4 is snap" },
  { name = "weights", type = "table", summary = "weights of the cost terms", table = weights },
  { name = "start", type = "choice", default = "rest", choices = ends,
    summary = "state at the start" },
  { name = "finish", type = "choice", default = "rest", choices = ends,
    summary = "state at the end" },
  { name = "start_velocity", type = "numbers", size = 3, unit = "m/s",
    summary = "velocity at a moving start" },
  { name = "finish_velocity", type = "numbers", size = 3, unit = "m/s",
    summary = "velocity at a moving end" },
  { name = "hard", type = "number", unit = "m", above = 0,
    summary = "keyframes become constraints with this tolerance; absent: keyframes are costs" },
  { name = "stretch", type = "number", default = 1, minimum = 1e-3, maximum = 1e3,
    words = { "auto" }, summary = "factor on all times; auto: the smallest with a certified film" },
  { name = "timing", type = "choice", default = "given",
    summary = "given, time_first: keep times; path_first: keep the path; free: optimise both",
    choices = { "given", "time_first", "path_first", "free" } },
  { name = "path_tolerance", type = "number", unit = "m", default = 0.25, above = 0,
    summary = "largest deviation from the path with timing = path_first" },
  { name = "obstacles", type = "plugins", kind = "shape", table = input.obstacle,
    summary = "shapes that the flight keeps out of, or inside of" },
  { name = "ground", type = "number", unit = "m", minimum = -1e6, maximum = 1e6,
    summary = "height of level ground, an obstacle that hides nothing; absent: there is none" },
  { name = "margin", type = "number", unit = "m", default = 0.5, minimum = 0, maximum = 1e3,
    summary = "distance of the path from every obstacle; includes the radius of the vehicle" },
  { name = "flight_zones", type = "tables", table = input.flight_zone,
    summary = "prisms that the flight stays inside of, the margin away from their faces" },
  { name = "volume", type = "table", table = input.volume,
    summary = "tracking volume: a box that the flight stays inside of" },
  { name = "battery", type = "number", unit = "s", above = 0,
    summary = "longest permitted flight; absent: the flight time of the vehicle" },
  { name = "speed", type = "number", unit = "m/s", above = 0, maximum = 1e3,
    summary = "speed that sets the times of keyframes without a time" },
  { name = "speed_limit", type = "number", unit = "m/s", above = 0, maximum = 1e3,
    summary = "largest norm of the velocity, checked by the certificate" },
  { name = "keep_away", type = "tables", table = input.bystander,
    summary = "bystanders, and the distances that the flight keeps from them" },
  { name = "cuts", type = "tables", table = input.cut, summary = "spans of discarded footage" },
  { name = "framing", type = "number", default = 0.95, above = 0, maximum = 1,
    summary = "fraction of the time in which the subject must be in the image" },
  { name = "line_of_sight", type = "choice", default = "required",
    choices = { "required", "reported" },
    summary = "effect on the certificate if the subject is hidden longer than `framing` permits" },
  { name = "model", type = "plugin", kind = "vehicle_model", default = "quadrotor",
    summary = "vehicle model: how the vehicle moves" },
  { name = "solver", type = "plugin", kind = "trajectory_solver", default = "iqp",
    summary = "trajectory solver" },
  { name = "controller", type = "text",
    summary = "plugin that flies the plan; absent: that of the vehicle, or `thesis`" },
  { name = "planner", type = "plugin", kind = "path_planner", default = "bit_star",
    summary = "planner of a path around obstacles, the first guess" },
  { name = "passages", type = "integer", default = 4, minimum = 0, maximum = 20,
    summary = "number of passages to try if the first flight fails; 0: none" },
  own.declared[1], own.declared[2],
}
local subjects = { name = "subjects", type = "tables", table = input.subject,
                   summary = "filmed subjects; a single one may be given as `subject`; absent, "
                   .. "with a shot file: the points at which the shot looks" }
local subject = { name = "subject", type = "text",
  refused = "a script's `subject` is the first of `subjects`: write subjects[1], as in "
  .. "--set subjects[1].distance=3" }
local of_shot = {
  { name = "duration", type = "number", unit = "s", above = 0, maximum = 1e5,
    summary = "duration of the flight; absent: time of the last keyframe" },
  { name = "keyframes", type = "tables", required = true, table = input.keyframe,
    summary = "places of the camera, with times or without" },
  subjects, subject,
}
local of_file = {
  { name = "input", type = "text", summary = "JSON file of a designed shot" },
  { name = "keyframes", type = "tables", table = input.keyframe,
    summary = "places of the camera in place of those of the file" },
  subjects, subject }

-- ---- what scripts call --------------------------------------------------------------------------

local function mission(what, given, declared, shot_of)
  if type(given) ~= "table" then lapwing.fail(what .. ": expected a table, got " .. type(given)) end
  local options = input.written_out(given)
  local terms = own.taken(options)
  local all = table.move(common, 1, #common, #declared + 1, { table.unpack(declared) })
  local made = mission_of("film", all, options,
                          function(run) return search.fly(run, shot_of(run), terms) end)
  made.takes_start = true
  return made
end

---@class lapwing.film.shot
---@field subject? lapwing.film.shot.subjects one alone, in place of `subjects`
---@class lapwing.film.from_file
---@field file? string in place of `input`

-- film.shot { name =, duration =, subject = { position =, height = }, keyframes = { { time =,
--             position =, look_at = }, ... }, obstacles = {...}, cuts = {...}, ... }
---@param given lapwing.film.shot
---@return lapwing.mission
function film.shot(given)
  return mission("film.shot", given, of_shot, function(run)
    local o = run.options
    return { keyframes = o.keyframes, duration = o.duration, subjects = o.subjects }
  end)
end

-- film.from_file { input = "shot_01.json", hard =, ... }; --set input=PATH replaces the file.
---@param given lapwing.film.from_file
---@return lapwing.mission
function film.from_file(given)
  if type(given) == "table" then
    local options = {}
    for key, value in pairs(given) do options[key == "file" and "input" or key] = value end
    given = options
  end
  return mission("film.from_file", given, of_file, function(run)
    local o, shot = run.options, shot_file.read(run)
    if #o.keyframes > 0 then shot.keyframes = o.keyframes end
    if #o.subjects > 0 then shot.subjects = o.subjects end
    return shot
  end)
end

return film
