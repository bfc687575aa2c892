-- SPDX-License-Identifier: Apache-2.0
-- Races (thesis 3.7.2): a flight through gates, in order and in their direction, in the shortest
-- time, or in a given time and as smooth as possible.
--
--   local race = require "mission.race"
--   return race.course { start = {0, 0, 1}, finish = {12, 0, 1},
--                        gates = { { shape = "ball", position = {6, 3, 2}, radius = 0.3 } } }
--
-- Every leg from gate to gate has its own step, which is a variable. If the steps of a leg are too
-- coarse, their number is doubled, and the problem is solved again.
local mission_of = require "mission.mission_of"
local courses = require "mission.race_course"
local flights = require "mission.race_flight"
local margin = require "mission.race_margin"
local search = require "mission.race_search"

local M = {}

local function number(name, default, unit, summary, more)
  local entry = { name = name, type = "number", default = default, unit = unit, summary = summary }
  for key, value in pairs(more or {}) do entry[key] = value end
  return entry
end

local DECLARATIONS = {
  { name = "gates", type = "tables", table = courses.GATE, summary = "gates in the order of flight",
    replaced_by = "input" },
  { name = "keyframes", type = "tables", replaced_by = "input",
    summary = "course of places to pass: balls with radius `tolerance`",
    table = { { name = "position", type = "numbers", size = 3, unit = "m", required = true,
                summary = "position in the world" } } },
  { name = "input", type = "text", summary = "YAML or JSON file with a course" },
  { name = "free_form", type = "table", summary = "random course from the seed of the run",
    table = { number("length", nil, "m", "length; absent: none", { above = 0, maximum = 1e5 }),
              number("curvature", 0.1, "", "largest curvature, 1/m", { minimum = 0, maximum = 10 }),
              number("spacing", 8, "m", "distance between its keyframes", { above = 0 }),
              number("height", 3, "m",
                     "mean height; heights vary by half of it", { above = 0 }) } },
  { name = "start", type = "numbers", size = 3, unit = "m", replaced_by = "input",
    summary = "start, at rest; absent: the first gate or keyframe" },
  { name = "finish", type = "numbers", size = 3, unit = "m", replaced_by = "input",
    summary = "finish, at rest; absent: the last gate or keyframe" },
  { name = "closed", type = "boolean", default = false,
    summary = "closed course: the end connects to the start" },
  { name = "laps", type = "integer", default = 1, minimum = 1, maximum = 1000,
    summary = "number of laps of a closed course" },
  number("tolerance", 0.3, "m",
         "radius of the balls of `keyframes` and `free_form`", { above = 0, maximum = 100 }),
  number("floor", nil, "m", "smallest height; absent: none", { minimum = -1e4, maximum = 1e4 }),
  number("time", nil, "s",
         "total time, checked as a budget; absent: the shortest", { above = 0, maximum = 1e4 }),
  { name = "timing", type = "choice", default = "optimal", choices = { "optimal", "profile" },
    summary = "profile: the time of a leg is that of straight flight with stops" },
  { name = "model", type = "choice", default = "quadrotor",
    choices = { "quadrotor", "quadrotor_full" },
    refused = "a race uses the thrust of rotors to its limit; films and scans fly other models",
    summary = "vehicle model: a point mass, or a rigid body with rotors" },
  { name = "vehicle", type = "vehicle", default = "vehicles/racer", summary = "vehicle" },
  number("thrust", 0.9, "", "fraction of the thrust that is used", { above = 0, maximum = 1 }),
  number("rate_share", 0.97, "", "fraction of body rates that is used", { above = 0, maximum = 1 }),
  number("margin", 0.02, "m", "distance from rims and floor", { minimum = 0, maximum = 10 }),
  { name = "closed_loop", type = "choice", default = "required",
    choices = { "required", "reported" },
    summary = "whether the certificate requires the simulated flight" },
  { name = "controller", type = "text",
    summary = "plugin that flies the plan; absent: that of the vehicle, or `thesis`" },
  { name = "advise", type = "boolean", default = true,
    summary = "if tracking is required and fails: search for a thrust that can be tracked" },
  { name = "flown", type = "table",
    summary = "simulated flights that must pass every gate; the largest such thrust is used",
    table = {
      { name = "runs", type = "integer", default = 20, minimum = 1, maximum = 10000,
        summary = "number of flights" },
      number("mass_error", 0, "", "largest error of the mass, as a fraction; drawn uniformly",
             { minimum = 0, maximum = 0.9 }),
      number("wind", 0, "m/s", "mean wind, towards the east", { minimum = 0, maximum = 150 }),
      number("gust", 0, "m/s", "standard deviation of gusts", { minimum = 0, maximum = 150 }),
      { name = "seed", type = "integer", default = 1, minimum = 0,
        summary = "seed of the first flight" } } },
  number("step", 0.06, "s", "time between stages of the first guess", { above = 0, maximum = 1 }),
  { name = "refinements", type = "integer", default = 4, minimum = 0, maximum = 10,
    summary = "how often the steps of too coarse legs are halved and solved again" },
  { name = "weights", type = "table",
    summary = "weights of the cost terms, relative to the time in s", table = {
    number("smoothness", 1e-7, "", "squared changes of force or thrust", { minimum = 0 }) } },
  { name = "players", type = "tables", summary = "pilots, by their stick logs",
    table = {
      { name = "log", type = "text", required = true, summary = "CSV file: time,forward,left" },
      { name = "name", type = "text", default = "", summary = "name; absent: that of the log" },
      number("weight", 0.5, "", "weight of the stick against the plan",
             { minimum = 0, maximum = 1 }),
      number("strength", 4, "m/s^2",
             "acceleration of a full deflection", { above = 0, maximum = 100 }),
      number("reach", 3, "m",
             "displacement across the course that full stick causes",
             { above = 0, maximum = 1000 }),
      number("speed", 1, "", "factor on the reference speed", { minimum = 0.1, maximum = 3 }),
      number("handicap", 0, "s", "added to the score", { minimum = -3600, maximum = 3600 }) } },
  { name = "solver", type = "plugin", kind = "trajectory_solver",
    default = "iqp", summary = "trajectory solver; `ipopt` finds the same flight, more slowly" },
}

-- Gates as the certificate asks for them: on a closed course the first one ends the lap.
local function task_of(course)
  local list = {}
  for i, gate in ipairs(course.gates) do list[i] = gate end
  if course.closed then
    local first = table.remove(list, 1)
    list[#list + 1] = first
  end
  return list
end

local function check_options(run, vehicle)
  local o = run.options
  if o.timing == "profile" and o.model == "quadrotor_full" then
    run:fail("timing", "'profile' is for the model 'quadrotor'; 'quadrotor_full' needs 'optimal'")
  end
  local least = search.least(vehicle, o)
  if o.thrust <= least then
    run:fail("thrust", string.format("%.3g of the thrust is not more than the weight of vehicle "
                                     .. "'%s', which needs %.3g to hover: give more than that",
                                     o.thrust, vehicle.name, math.ceil(1000 * least) / 1000))
  end
  run:expect_controller("controller")
  run:expect_players("players")  -- before anything is computed
end

local function flown(run)
  local o = run.options
  local vehicle = run:vehicle(o.vehicle)
  check_options(run, vehicle)
  local course = courses.read(run)
  course.task = task_of(course)
  if run:stated("flown") then return margin.plan(run, course, vehicle, o) end
  local made = flights.flight(run, course, vehicle, o, function(words) run:phase(words) end)
  local solution = made.solution
  local notes = { made.note }
  if not flights.solved(solution) then
    notes[1] = string.format("the solver ended %s: %s", solution.status, solution.message)
  elseif flights.strays(made.certificate) and o.advise and not run:cancelled() then
    notes = search.advice(run, vehicle, solution.duration, function(tried)
      local found = flights.flight(run, course, vehicle, tried, function() end)
      return flights.solved(found.solution) and found.certificate.feasible, found.solution.duration
    end)
  end
  return #notes > 0 and flights.plan(run, course, solution, notes) or made.plan
end

---@param given lapwing.race.course
---@return lapwing.mission
function M.course(given)
  return mission_of("race", DECLARATIONS, given, flown)
end

return M
