-- SPDX-License-Identifier: Apache-2.0
-- The reason why a film failed, as a sentence: a leg that is too fast, a limit of the vehicle, a
-- subject that the gimbal cannot see, a constraint of the script. If the failed film does not show
-- the reason, the same film is solved with fewer constraints.
local attempts = require "mission.film_attempt"
local checks = require "mission.checks"
local own = require "mission.own_terms"
local film_keyframes = require "mission.film_keyframes"
local requests = require "mission.film_request"
local subjects = require "mission.subjects"

local M = {}

local MISSED = 1e-4  -- by which a constraint is missed that is worth naming, in its own unit

local function first_failed(outcome)
  local _, check = attempts.failed_checks(outcome)
  return check and check.name
end

-- What more time would not mend: a way that obstacles close; a subject that the gimbal cannot see,
-- or that obstacles hide.
function M.blocked(outcome) return first_failed(outcome) == "clearance" end
local function hidden(outcome) return first_failed(outcome) == "line_of_sight" end
function M.out_of_sight(outcome)
  return first_failed(outcome) == "framing" or hidden(outcome)
end
-- Heights and distances that count from home or the ground: no other vehicle would keep them.
local HOME = { height_above_home = true, distance_from_home = true, height_above_ground = true,
               rally_points = true }

-- Which limit a film breaks, where and when: what the gimbal cannot see, or else what the film
-- would ask for if nothing held it. `legs`: the ways to begin with.
function M.broken_limit(run, failing, legs)
  if hidden(failing) or HOME[first_failed(failing)] then return attempts.complaint(failing) end
  if M.out_of_sight(failing) then
    return subjects.hidden(failing.camera, failing.request.vehicle) or attempts.complaint(failing)
  end
  local free = attempts.attempt(run, requests.with(failing.request,
                                                   { scope = "unlimited", legs = legs }))
  local limit = free.solution.status == "optimal" and free.verdict.failures[1]
  if limit then return "in a flight without the limits of the vehicle: " .. limit end
  return attempts.complaint(failing)
end

-- For a film that misses a keyframe: which option says how near is near enough. Else "".
function M.tolerance(outcome, hard)
  if not attempts.failed_checks(outcome).keyframe_miss then return "" end
  return string.format("; keyframes may be missed by %g m: hard = METRES %s",
                       hard or film_keyframes.MISS,
                       hard and "sets that" or "sets another distance")
end

-- The first constraint of the script that an outcome violates, as a sentence; and whether no other
-- check fails.
local function broken_constraint(options, outcome)
  local owned, sentence, alone = own.checks(options), nil, true
  if options.speed_limit then owned[own.check("speed_limit")] = true end
  for _, check in ipairs(outcome.verdict.checks) do
    if checks.fails(check) then
      if not owned[check.name] then alone = false else sentence = sentence or check.line end
    end
  end
  return sentence, alone
end

-- Whether the constraints of the script make a film fail, as a sentence. The same film is solved at
-- the same times without them.
function M.in_the_way(run, failing)
  local constraints = run.options.constraints
  if #constraints == 0 or run:cancelled() then return nil end
  local free = attempts.attempt(run, requests.with(failing.request, {
    scope = "unconstrained", legs = failing.legs }))
  local sentence, alone = broken_constraint(run.options, free)
  if not alone or free.solution.status == "infeasible" then
    local worst = failing.solution.violations[1]
    for _, entry in ipairs(constraints) do
      if worst and worst.amount > MISSED and worst.name == (entry.name or entry.type) then
        return string.format('constraint "%s" is in the way: missed by %.3g at %.4g s', worst.name,
                             worst.amount, worst.time)
      end
    end
    return nil
  end
  if sentence then return "the film is certified without it: " .. sentence end
  local names = {}
  for i, entry in ipairs(constraints) do names[i] = '"' .. (entry.name or entry.type) .. '"' end
  return "certified without the constraints of the script, " .. table.concat(names, ", ")
end

return M
