-- SPDX-License-Identifier: Apache-2.0
-- One attempt at a film: request in, outcome out; nothing else is read or changed.
local checks = require "mission.checks"
local horizons = require "mission.film_horizon"
local problem = require "mission.film_problem"
local requests = require "mission.film_request"

local M = {}

local function tried(run, request)
  local stated = problem.state(run, request)
  local camera = stated.camera
  local begin = request.scope ~= "flight" and { start = run.start } or nil
  local solution = horizons.wanted(run, request) and horizons.solve(run, request, stated)
    or run:solve(stated.problem, run.options.solver, begin)
  local verdict = run:certify(run:plan { solution = solution, task = stated.task,
                                         controller = run.options.controller,
                                         cuts = camera and camera.cuts or {} })
  return requests.outcome {
    request = request, solution = solution, verdict = verdict, task = stated.task, camera = camera,
    legs = stated.legs, holds = verdict.feasible and solution.status ~= "infeasible" }
end

-- The outcome of a request.
function M.attempt(run, request)
  local stretch = request.stretch
  run:phase(stretch == 1 and "film" or string.format("film %.4g times as long", stretch))
  if not (request.corridor or request.may_fail) then return tried(run, request) end
  -- A corridor may leave no room for what the film asks for, nor may times that were found.
  local fine, result = pcall(tried, run, request)
  if fine then return result end
  return requests.outcome { request = request, legs = request.legs, holds = false,
                            fault = tostring(result) }
end

-- Runs attempts until `strategy` gives no further request, or the user cancels. A strategy takes an
-- outcome and returns the next request, or nil, and notes in case the search ends here. Returns the
-- last outcome and its notes.
function M.follow(run, outcome, strategy)
  local request, told = strategy(run, outcome)
  while request and not run:cancelled() do
    outcome = M.attempt(run, request)
    request, told = strategy(run, outcome)
  end
  return outcome, told
end

-- The same from the attempt at a request.
function M.pursue(run, request, strategy)
  return M.follow(run, M.attempt(run, request), strategy)
end

-- The checks that an outcome fails, by name; and the first of them.
function M.failed_checks(outcome)
  local failed, first = {}, nil
  for _, check in ipairs(outcome.verdict.checks) do
    if checks.fails(check) then
      failed[check.name] = check
      first = first or check
    end
  end
  return failed, first
end

-- The sentence on the first check that an outcome fails, or else what the solver says.
function M.complaint(outcome)
  return outcome.verdict.failures[1] or outcome.solution.message
end

return M
