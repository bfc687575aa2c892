-- SPDX-License-Identifier: Apache-2.0
-- The margin that a race leaves to its controller: the largest share of thrust and body rates with
-- which every one of the asked flights, under the asked disturbances and those of the vehicle's
-- file, passes every gate. By bisection; each solve begins from the last one.
local flights = require "mission.race_flight"
local search = require "mission.race_search"

local M = {}

local DOWN = 0.9     -- times the share, until one holds
local CLOSE = 0.01   -- between a share that holds and one that does not
local MOST = 12      -- shares that are tried

local function with(o, share)
  local all = {}
  for key, value in pairs(o) do all[key] = value end
  all.thrust, all.rate_share, all.closed_loop = share * o.thrust, share * o.rate_share, "reported"
  return all
end

-- A flight with this share of what the options allow, begun from `from`; whether it holds, and what
-- its flights came to.
local function try(run, course, vehicle, o, share, from)
  local words = string.format("thrust = %.3g", share * o.thrust)
  local function say() run:phase(words) end
  local options = with(o, share)
  local made = from and flights.again(run, course, vehicle, options, from, say)
               or flights.flight(run, course, vehicle, options, say)
  if not flights.solved(made.solution) or not made.certificate.feasible then return made, false end
  made.plan = flights.plan(run, course, made.solution)
  local asked = o.flown
  local flown = run:fly_runs { plan = made.plan, runs = asked.runs, seed = asked.seed,
                               mass_error = asked.mass_error, wind = asked.wind,
                               gust = asked.gust }
  local holds = flown.through == flown.runs
  if holds then
    made.certificate = run:certify(made.plan)
    holds = made.certificate.feasible
  end
  made.flown, made.share = flown, share
  return made, holds
end

local function note_of(limit, best, o)
  return string.format("planned at the limit %.4g s; with %.3g of the thrust, %.4g s in the plan "
                       .. "and at most %.4g s flown, %d of %d flights pass every gate",
                       limit.solution.duration, best.share * o.thrust, best.solution.duration,
                       best.flown.duration, best.flown.through, best.flown.runs)
end

-- The plan of the course that all flights pass; where none does, the one at the limit, which is not
-- certified and says so.
function M.plan(run, course, vehicle, o)
  local limit, holds = try(run, course, vehicle, o, 1)
  if not flights.solved(limit.solution) then
    return flights.plan(run, course, limit.solution, { string.format(
      "the solver ended %s: %s", limit.solution.status, limit.solution.message) })
  end
  local least = search.least(vehicle, o) / o.thrust
  local best, high, from = holds and limit or nil, 1, limit
  local share = DOWN
  for _ = 1, holds and 0 or MOST do
    if run:cancelled() or share <= least then break end
    local made, good = try(run, course, vehicle, o, share, from)
    if good then
      best, from = made, made
    else
      high = share
      if flights.solved(made.solution) then from = made end
    end
    if best and high - best.share < CLOSE then break end
    share = best and (best.share + high) / 2 or DOWN * share
  end
  if best then
    return flights.plan(run, course, best.solution, { note_of(limit, best, o) })
  end
  return flights.plan(run, course, limit.solution, { string.format(
    "no share of the thrust that was tried, down to %.3g, gives a flight that passes every gate "
    .. "in all of %d flights: give the gates more room (margin), another controller or weaker "
    .. "disturbances (flown)", high * o.thrust, o.flown.runs) })
end

return M
