-- SPDX-License-Identifier: Apache-2.0
-- From the options of a film to its plan: the first request, the strategy of its timing, and the
-- strategies for a failed film.
local attempts = require "mission.film_attempt"
local environment = require "mission.film_environment"
local failure = require "mission.film_failure"
local live = require "mission.film_live"
local passages = require "mission.passages"
local film_keyframes = require "mission.film_keyframes"
local requests = require "mission.film_request"
local stretching = require "mission.film_stretch"
local one_problem = require "mission.one_problem"
local times = require "mission.keyframe_times"
local timing = require "mission.timing"
local ways = require "mission.ways"
local wished = require "mission.wished_times"

local M = {}

local HOVER = 10                -- s, of a single keyframe without a time
local MUCH_STRETCH = 4          -- at which a film holds that time alone mends

-- The plan of an outcome. `told`, where there is any: {notes, details, figures, certified}:
-- sentences for the user; others on what was tried, where something held; figures of the strategy;
-- the smallest stretch that is certified.
local function finished(run, outcome, told)
  local request = outcome.request
  local figures = { stretch = request.stretch, certified_stretch = told.certified }
  for name, value in pairs(told.figures or {}) do figures[name] = value end
  local cuts = outcome.camera and outcome.camera.cuts or {}
  local notes = table.move(told.notes or {}, 1, #(told.notes or {}), 1, {})
  notes[#notes + 1] = environment.low_pass(run.options, request.keyframes, outcome.solution.path)
  return run:plan { solution = outcome.solution, task = outcome.task, cuts = cuts,
                    notes = notes, details = told.details or {}, figures = figures,
                    geodetic_origin = request.origin, budget = run.options.battery,
                    controller = run.options.controller }
end

-- Sentences on a film that came to nothing, with the script's constraint that is in the way first.
local function with_constraint(run, failing, notes)
  local all = { failure.in_the_way(run, failing) }
  return table.move(notes, 1, #notes, #all + 1, all)
end

-- Subjects and looks ask for a camera that turns by itself.
local function check_gimbal(run, film)
  if film.vehicle.gimbal then return end
  local message = "vehicle '" .. film.vehicle.name .. "' has no gimbal, which subjects need"
  if #film.subjects > 0 then run:fail("subjects[1]", message) end
  for i, k in ipairs(film.keyframes) do
    if k.look_at or k.subject then run:fail("keyframes[" .. i .. "].look_at", message) end
  end
  if #film.cuts > 0 then run:fail("cuts", "a cut needs a subject, and there is none") end
end

-- A plan to begin from has the same keyframes, in place and time wherever they were.
local function check_start(run, film)
  if not run.start or run.start.keyframes == #film.keyframes then return end
  run:fail("keyframes", string.format("%d; the plan to begin from (--from) has %d",
                                      #film.keyframes, run.start.keyframes))
end

-- The film at the times that its keyframes have, and why a leg is too fast for the vehicle at any
-- way (or nil), and the least stretch at which none is.
local function first_request(run, film)
  local o = run.options
  local filled, cruise = times.filled(film.keyframes, film.duration, film.vehicle, o)
  times.check(run, filled, film.duration)
  local keyframes = times.with_yaw(filled)
  local last = keyframes[#keyframes].time
  local duration = film.duration or (last > 0 and last or HOVER)
  local least, why = times.fastest_leg(keyframes, film.vehicle, o.hard or film_keyframes.MISS,
                                       o.hard and 0 or film_keyframes.LATE, o.speed_limit)
  local auto = o.stretch == "auto"
  local stretch = auto and 1 or o.stretch
  times.check_battery(run, film.vehicle, duration * stretch)
  return requests.first {
    vehicle = film.vehicle, subjects = film.subjects, cuts = film.cuts, terms = film.terms,
    origin = film.origin, keyframes = keyframes, duration = duration, cruise = cruise,
    stretch = stretch, scope = auto and why and "flight" or "film" }, why, least
end

-- The plan of a film that time may mend: as it is, or stretched as little as that takes. `again`:
-- its request, with the ways that are known; `why` it fails; `told`: notes on passages.
local function stretched(run, failing, again, why, least, told)
  local o = run.options
  local request, good, last = stretching.first(again, least), nil, nil
  if request and not run:cancelled() then
    last = attempts.pursue(run, request, stretching.next)
    good = last.request.scope == "film" and last.holds and last
  end
  local certified = good and good.request.stretch or nil
  local note = why .. "; " .. (good and string.format("certified from a stretch of %.2f", certified)
                               or stretching.in_vain(again, least, request, last))
  if run:cancelled() then note = why .. "; the search for a stretch was cancelled" end
  if o.stretch == "auto" and good then
    return finished(run, good, { notes = { note }, certified = certified, details = told.notes,
                                 figures = told.figures })
  end
  local notes = table.move(told.notes, 1, #told.notes, 1, {})
  notes[#notes + 1] = note .. failure.tolerance(failing, o.hard)
  return finished(run, failing, { notes = notes, certified = certified, figures = told.figures })
end

-- An outcome, or the film without the cost of being hidden, where that kept the solver from its end
-- (no way near sees the subject) and fewer checks fail without; and what is to be said.
local function seen_or_not(run, outcome)
  if outcome.solution.status ~= "iteration_limit" or outcome.verdict.feasible
     or run.options.weights.occlusion <= 0 or run:cancelled() then return outcome end
  local hidden = false
  for _, check in ipairs(outcome.verdict.checks) do
    hidden = hidden or check.name == "line_of_sight" and check.pass == false
  end
  if not hidden then return outcome end
  local again = attempts.attempt(run, requests.with(outcome.request, { looks_round = false }))
  if #again.verdict.failures >= #outcome.verdict.failures then return outcome end
  return again, { "planned without the cost occlusion, with which the solver did not converge: "
                  .. "obstacles hide the subject" }
end

-- The film at the times that its keyframes have.
local function at_given_times(run, film)
  local o = run.options
  local request, too_fast, least = first_request(run, film)
  local first, told_first = seen_or_not(run, attempts.attempt(run, request))
  local status = first.solution.status
  local broken = not too_fast and (status == "unsupported"
                                   or status == "numerical_error" and not ways.matter(first.legs))
  if first.verdict.feasible or broken or run:cancelled() or live.films(request) then
    return finished(run, first, { certified = first.verdict.feasible and request.stretch or nil,
                                  notes = told_first })
  end
  -- `first` stands for the film that fails; `last` knows the ways that were planned since.
  local last, told = first, { notes = {} }
  local unseen = failure.out_of_sight(first)
  if not too_fast and o.passages > 0 and not unseen
     and (failure.blocked(first) or ways.matter(first.legs)) then
    local tried
    last, tried = attempts.follow(run, first, passages.next)
    told = { notes = tried.notes, figures = { passages = tried.entries } }
    if last.holds then
      return finished(run, last, { certified = last.request.stretch, details = tried.notes,
                                   figures = told.figures })
    end
  end
  if not too_fast and failure.blocked(first) then
    return finished(run, first, { notes = with_constraint(run, first, told.notes),
                                  figures = told.figures })
  end
  local again = requests.with(request, { legs = last.legs })
  local hopeless = not too_fast and unseen
  local constraint = not too_fast and failure.in_the_way(run, first)
  -- More time mends a constraint on speed, and none on places: one try tells.
  if constraint and not hopeless then
    hopeless = not (o.hard or o.stretch == "auto")
      or not attempts.attempt(run, requests.with(
           again, { stretch = request.stretch * MUCH_STRETCH })).holds
  end
  local why = constraint or too_fast or failure.broken_limit(run, first, last.legs)
  if hopeless or not o.hard and o.stretch ~= "auto" then
    local notes = table.move(told.notes, 1, #told.notes, 1, {})
    notes[#notes + 1] = why .. failure.tolerance(first, o.hard)
    return finished(run, first, { notes = notes, figures = told.figures })
  end
  return stretched(run, first, again, why, least, told)
end

-- The fields of the first request, from the script.
local function asked(run, shot, terms)
  return { keyframes = shot.keyframes, duration = shot.duration, subjects = shot.subjects or {},
           origin = shot.origin, terms = terms, cuts = run.options.cuts,
           vehicle = run:vehicle(run.options.vehicle) }
end

-- Two origins of one world cannot both be meant.
local function check_origin(run, shot)
  if shot.origin and run:stated("origin.latitude_deg") then
    run:fail("origin", "the shot file states the origin of its world (refLLH); remove this one")
  end
end

-- The plan of a shot {keyframes, duration, subjects, origin}; `terms` are own_terms.taken of it.
function M.fly(run, shot, terms)
  local way = run.options.timing
  local film = asked(run, shot, terms)
  if #film.keyframes == 0 then run:fail("keyframes", "expected at least one keyframe") end
  run:expect_controller("controller")
  check_origin(run, shot)
  live.check(run, film)
  film.keyframes = live.placed(run, film.keyframes, film.subjects)
  check_start(run, film)
  check_gimbal(run, film)
  timing.check(run, film)
  times.check_speed(run, film)
  if way == "given" or way == "time_first" then return at_given_times(run, film) end
  local strategy = way == "free" and wished or timing
  local outcome, told = attempts.pursue(run, strategy.first(run, film), strategy.next)
  if outcome.holds then outcome, told = one_problem.improved(run, outcome, told) end
  local notes = outcome.holds and told.notes or with_constraint(run, outcome, told.notes)
  return finished(run, outcome, { notes = notes, figures = told.figures,
                                  certified = outcome.holds and 1 or told.certified })
end

return M
