-- SPDX-License-Identifier: Apache-2.0
-- Film and times in one problem (thesis 3.5 to 3.7, 6.1): flight, camera, terms of the script and
-- the times of keyframes are optimised together. It begins at a film whose times were found without
-- the camera. The film is solved once more at the times that it finds, on stages of its own: both
-- films are then compared by the same cost. The cheaper one is kept, if it is certified.
local attempts = require "mission.film_attempt"
local film_problem = require "mission.film_problem"
local film_times = require "mission.film_times"
local horizons = require "mission.film_horizon"
local keyframe_times = require "mission.keyframe_times"
local requests = require "mission.film_request"
local surroundings = require "mission.film_environment"
local timing = require "mission.timing"

local M = {}

-- s, between stages. Where flights keep distances, they keep them between stages too, and longer
-- steps need more room.
local STEP, STEP_NEAR_THINGS = 0.2, 0.1
local MOST_STAGES = 3000
local FEWEST = 4         -- intervals of a leg
local LONGEST = 4        -- times its duration so far, that a leg may take
local NEARLY = 1e-3      -- first barrier parameter: the start is nearly optimal
local NOTICED = 1e-6     -- relative, of a cost: less is no change

-- Legs of free durations that begin at the times of keyframes, s.
local function legs_of(run, outcome, list)
  local step = run.options.step or STEP
  if surroundings.near_things(run.options, outcome.request.subjects) then
    step = math.min(step, STEP_NEAR_THINGS)
  end
  step = math.max(step, list[#list] / (MOST_STAGES - 1))
  local legs = {}
  for i = 2, #list do
    local span = list[i] - list[i - 1]
    legs[i - 1] = { duration = span, mode = "free", longest = LONGEST * span,
                    intervals = math.max(FEWEST, math.ceil(span / step - 1e-9)) }
  end
  return legs
end

local function times_of(request)
  local list = {}
  for i, k in ipairs(request.keyframes) do list[i] = k.time end
  return list
end

-- The solver for a problem that begins near its solution.
local function finishing(solver)
  if not solver.first_barrier then return solver end
  local copy = {}
  for name, value in pairs(solver) do copy[name] = value end
  copy.first_barrier = math.min(copy.first_barrier, NEARLY)
  -- The adaptive strategy of ipopt chooses its first barrier itself, and leaves a good start.
  copy.mu_strategy = copy.mu_strategy and "monotone"
  return copy
end

-- What a second of flight costs: more in a film along a fixed path, which is flown as fast as the
-- vehicle allows.
local function second_of(run, request)
  return run.options.weights.time * (request.track and timing.SECOND or 1)
end

-- The solution of the problem of a film and its times, from an outcome; and its legs.
local function together(run, outcome)
  local request = outcome.request
  local legs = legs_of(run, outcome, times_of(request))
  local free = { legs = legs, second = second_of(run, request) }
  if not request.track then free.share = request.memory.share end
  local asked = requests.with(request, { legs = outcome.legs, free = free })
  local stated = film_problem.state(run, asked)
  local begin = run:plan { solution = outcome.solution, task = outcome.task,
                           controller = run.options.controller,
                           cuts = outcome.camera and outcome.camera.cuts or {} }
  return run:solve(stated.problem, finishing(run.options.solver), { start = begin }), legs
end

-- What an outcome costs, its times included.
local function cost_of(run, outcome)
  local request = outcome.request
  return outcome.solution.cost + film_times.cost(second_of(run, request), request.wishes,
                                                 times_of(request))
end

-- Whether the film asks for more than the flight, or its times are a makeshift, and not all given.
function M.matters(run, outcome)
  local o = run.options
  local memory = outcome.request.memory
  return (outcome.camera or #o.costs > 0 or #o.constraints > 0 or memory.straight)
    and film_times.open(outcome.request.wishes)
end

-- The film at the times of a solution with free `legs`: an outcome; or nil, and why there is none
-- that holds. What is measured of it goes to `figures`.
local function film_at(run, outcome, solution, legs, figures)
  local request = outcome.request
  local list = film_times.of(solution, request.wishes)
  keyframe_times.check_battery(run, request.vehicle, list[#list])
  local more = { legs = outcome.legs, may_fail = true }
  if request.track then more.track = timing.retimed(request, solution, legs) end
  local film = attempts.attempt(run, film_times.set(request, list, more))
  if not film.holds then return nil, film.fault or attempts.complaint(film) end
  if request.track and not timing.keeps_path(run, film, figures) then
    return nil, string.format("the flight strays %.3g m from the path", figures.path_error)
  end
  return film
end

-- The better of a certified film and the one at times found together with its camera, and what is
-- told of it: {notes, figures}.
function M.improved(run, outcome, told)
  if not M.matters(run, outcome) or run:cancelled() then return outcome, told end
  local notes = table.move(told.notes, 1, #told.notes, 1, {})
  local function with_figures(more)
    local figures = {}
    for _, list in ipairs { told.figures or {}, more or {} } do
      for name, value in pairs(list) do figures[name] = value end
    end
    return { notes = notes, figures = figures }
  end
  local function kept(why, more)
    notes[#notes + 1] = (told.notes_if_better and "no better times were found from there: "
                         or "the times are those found without the camera: ") .. why
    return outcome, with_figures(more)
  end
  if horizons.wanted(run, outcome.request) then return kept("the film is solved in parts") end
  run:phase("film and times together")
  local fine, solution, legs = pcall(together, run, outcome)
  if not fine then return kept("one problem of both cannot be stated: " .. tostring(solution)) end
  local status = solution.status
  if status ~= "optimal" and status ~= "feasible" then
    local message = solution.message ~= "" and ": " .. solution.message or ""
    return kept("the solver of both together ended with " .. status .. message)
  end
  local figures = {}
  local fits, film, why = pcall(film_at, run, outcome, solution, legs, figures)
  if not fits then film, why = nil, tostring(film) end
  if not film then return kept("at those found with it, " .. why) end
  local costs = { cost_apart = cost_of(run, outcome), cost_together = cost_of(run, film) }
  if costs.cost_together > costs.cost_apart * (1 + NOTICED) then
    return kept(string.format("with those found with it, the film costs %.6g, not %.6g",
                              costs.cost_together, costs.cost_apart), costs)
  end
  costs.duration, costs.path_error = film.request.duration, figures.path_error
  if told.notes_if_better then notes = told.notes_if_better end
  return film, with_figures(costs)
end

return M
