-- SPDX-License-Identifier: Apache-2.0
-- The flight of a course. It is planned in rounds until it is certified. A new round has more
-- stages in legs whose steps are too coarse, and slower forces if the controller deviates too much.
local checks = require "mission.checks"
local paths = require "mission.paths"
local problem = require "mission.race_problem"
local search = require "mission.race_search"

local M = {}

local NEARLY = 1e-4     -- first barrier parameter from there
local SOFTER = 8        -- times the weight of smoothness where the controller cannot follow
local FOLLOWED = 100    -- times that weight where it has to, to begin with
local TRACKING = { closed_loop = true, closed_loop_yaw = true }  -- checks of the controller
local COARSE = 0.7      -- share of the allowed defect beyond which a leg gets twice the stages

function M.solved(solution)
  return solution.status == "optimal" or solution.status == "feasible"
end

-- `o`: the options; absent: those of the run.
function M.plan(run, course, solution, notes, o)
  return run:plan {
    solution = solution, notes = notes, figures = { time = solution.duration },
    players = run.options.players, budget = run.options.time, controller = run.options.controller,
    task = { gates = course.task,
             closed_loop_required = (o or run.options).closed_loop == "required" },
  }
end

-- Legs on which a check fails that more stages would mend: what passes its limit between stages.
local function failing_legs(certificate, legs)
  local found = {}
  for _, check in ipairs(certificate.checks) do
    if check.pass == false and not check.skipped and not TRACKING[check.name] and check.at then
      local clock = 0
      for i, time in ipairs(legs) do
        if check.at >= clock - 1e-6 and check.at <= clock + time + 1e-6 then found[i] = true end
        clock = clock + time
      end
    end
  end
  return found
end

-- Whether the controller cannot follow: forces then change less quickly in the next round.
function M.strays(certificate)
  for _, check in ipairs(certificate.checks) do
    if TRACKING[check.name] and checks.fails(check) then return true end
  end
  return false
end

-- Twice the stages where they are too coarse; false when that is nowhere.
local function refine(made, solution, certificate)
  local finer, failing = false, failing_legs(certificate, solution.legs)
  local defects = solution.defects
  for i, time in ipairs(solution.legs) do
    made.durations[i] = time
    if defects[i] > COARSE or failing[i] then
      made.intervals[i] = 2 * made.intervals[i]
      finer = true
    end
  end
  made.total = solution.duration
  if M.strays(certificate) then made.softer, finer = SOFTER * made.softer, true end
  return finer
end

local function check_battery(run, made, vehicle)
  local length = paths.length(made.points)
  local speed = math.sqrt(vehicle.speed_across ^ 2
                          + math.max(vehicle.climb_speed, vehicle.descent_speed) ^ 2)
  if length / speed > vehicle.flight_time then
    run:fail("vehicle", string.format(
      "a course of %.4g m takes at least %.4g s at %.4g m/s; the battery lasts %.4g s", length,
      length / speed, speed, vehicle.flight_time))
  end
end

-- For a problem that begins from a solution of its own on fewer stages.
local function finishing(solver)
  if not solver.first_barrier then return solver end
  local copy = {}
  for key, value in pairs(solver) do copy[key] = value end
  copy.first_barrier = math.min(copy.first_barrier, NEARLY)
  return copy
end

local function copied(made)
  local copy = {}
  for key, value in pairs(made) do copy[key] = value end
  copy.durations = table.move(made.durations, 1, #made.durations, 1, {})
  copy.intervals = table.move(made.intervals, 1, #made.intervals, 1, {})
  return copy
end

-- A flight of the course with these options, refined until it is certified: {plan =, solution = the
-- last one, certificate = of the plan if there is a solution, softer = factor on the weight of
-- smoothness, made = its legs}. `say(round)` is called before each round. `softest` is the largest
-- factor: a flight that deviates too much with it is returned as it is. `from` is a flight with
-- other options: its legs and solution are the initial guess.
local function rounds(run, course, vehicle, o, say, softest, from)
  local made = from and copied(from.made) or problem.legs(course, vehicle, o)
  check_battery(run, made, vehicle)
  made.softer = from and from.softer or o.closed_loop == "required" and FOLLOWED or 1
  local solution, plan, certificate = from and from.solution, nil, nil
  if o.model == "quadrotor_full" and not from then
    -- A point mass finds the way and the times from straight lines in a few iterations; the whole
    -- quadrotor begins from there.
    local point = run:solve(problem.make(run, course, vehicle, made, o, "quadrotor"), o.solver)
    if M.solved(point) then
      problem.take_times(made, point, o)
      solution = point
    end
  end
  for round = 0, o.refinements do
    say(round)
    local p = problem.make(run, course, vehicle, made, o, o.model, solution)
    local finer = run:solve(p, (plan or from) and finishing(o.solver) or o.solver)
    if plan and not M.solved(finer) then break end  -- the coarser one stands
    solution = finer
    plan = M.plan(run, course, solution, nil, o)
    if not M.solved(solution) then break end
    certificate = run:certify(plan)
    if run:cancelled() or o.timing == "profile" then break end
    if certificate.feasible or made.softer >= softest and M.strays(certificate) then break end
    if not refine(made, solution, certificate) then break end
  end
  return { plan = plan, solution = solution, certificate = certificate, softer = made.softer,
           made = made }
end

-- A flight by other options that begins from the flight `from`.
function M.again(run, course, vehicle, o, from, say)
  return rounds(run, course, vehicle, o, say, math.huge, from)
end

-- The flight of these options, or a faster one with less thrust if the controller can track only
-- slowly changing forces. `say(words)` is called before each round.
function M.flight(run, course, vehicle, o, say)
  local function fly(options, words, softest)
    return rounds(run, course, vehicle, options, function(round)
      say(round == 0 and words or string.format("finer %s %d", words, round))
    end, softest)
  end
  local made = fly(o, "race", math.huge)
  local certified = M.solved(made.solution) and made.certificate.feasible
  if made.softer <= SOFTER * FOLLOWED or not certified or o.time then return made end
  return search.spared(run, vehicle, o, made, function(options, words)
    return fly(options, words, made.softer / SOFTER)
  end)
end

return M
