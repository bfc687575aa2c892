-- SPDX-License-Identifier: Apache-2.0
-- Advice if the controller cannot track the fastest flight: the largest share of the thrust with
-- which the simulated quadrotor stays on the course. It is found by tries. Each try is the flight
-- of a run with the printed settings.
local point_mass = require "mission.point_mass"

local M = {}

local ABOVE = 1.15       -- times the share that carries the vehicle: the least one that is tried
local STEP = 0.01        -- between shares
local CLOSE = 0.03       -- no nearer to a share that fails
local MOST_TRIES = 5
local SPARED = { 0.95, 0.9, 0.8 }  -- shares of the thrust asked for that are tried
local SLOW_TURNS = 0.3   -- share of the body rates, where no share of the thrust is enough

-- The share of the thrust that carries the vehicle.
function M.least(vehicle, o)
  local most = o.model == "quadrotor_full" and 4 * vehicle.rotor_thrust_max or vehicle.thrust_max
  return point_mass.hovering_share(vehicle, most)
end

local function with(options, more)
  local all = {}
  for key, value in pairs(options) do all[key] = value end
  for key, value in pairs(more) do all[key] = value end
  return all
end

-- The largest share that is followed: halving towards the least until one is, then between that one
-- and the smallest that is not. nil where none of the tries is followed.
local function largest(run, follows, low, high)
  local good, time
  for try = 1, MOST_TRIES do
    if run:cancelled() or high - (good or low) < (good and CLOSE or STEP) then break end
    local share = STEP * math.floor(((good or low) + high) / 2 / STEP + 0.5)
    if try == MOST_TRIES and not good then share = STEP * math.ceil(low / STEP) end
    local followed, seconds = follows(share, try)
    if followed then good, time = share, seconds else high = share end
  end
  return good, time
end

-- Where nothing of the thrust is left for the controller, it follows only a flight whose forces
-- change slowly, and that can take much longer than one with a little less thrust: the faster of
-- `softened`, which is such a flight, and the first that is followed with thrust to spare.
-- `fly(options, words)`: the flight by these options, its forces free to change more quickly.
function M.spared(run, vehicle, o, softened, fly)
  local before = softened.solution.duration
  for _, part in ipairs(SPARED) do
    local share = part * o.thrust
    if run:cancelled() or share <= ABOVE * M.least(vehicle, o) then break end
    local words = string.format("race at thrust = %.3g", share)
    local made = fly(with(o, { thrust = share }), words)
    if made.certificate and made.certificate.feasible then
      if made.solution.duration >= before then break end
      made.note = string.format("the plan uses %.3g of the thrust and leaves the rest to the "
        .. "controller: with %.3g the fastest tracked flight takes %.3g s", share, o.thrust, before)
      return made
    end
  end
  return softened
end

local function seconds_text(o, time, before)
  if o.time then return "" end
  return string.format(" (%.3g s instead of %.3g s)", time, before)
end

-- Sentences. `follows(options)`: whether the flight by these options is certified, and its
-- duration; `before`: that of the flight that cannot be followed.
function M.advice(run, vehicle, before, follows)
  local o = run.options
  local low = ABOVE * M.least(vehicle, o)
  local notes = {}
  local function try(more, words)
    run:phase("closed loop: trying " .. words)
    return follows(with(o, more))
  end
  local function shares(more)
    return largest(run, function(share, k)
      local words = string.format("thrust = %.2f, try %d of at most %d", share, k, MOST_TRIES)
      return try(with(more, { thrust = share }), words)
    end, low, o.thrust)
  end
  local share, time = shares {}
  local turns = ""
  if not share and o.model == "quadrotor_full" and o.rate_share > SLOW_TURNS then
    share, time = shares { rate_share = SLOW_TURNS }
    turns = string.format(" --set rate_share=%g", SLOW_TURNS)
  end
  if share then
    notes[1] = string.format("the closed loop tracks this course at thrust = %.2f%s: "
                             .. "--set thrust=%.2f%s", share, seconds_text(o, time, before), share,
                             turns)
  end
  if o.model == "quadrotor_full" and not run:cancelled() then
    local followed, seconds = try({ model = "quadrotor" }, "model = quadrotor")
    if followed then
      notes[#notes + 1] = string.format("the closed loop tracks the course with the point mass%s: "
        .. "--set model=quadrotor", seconds_text(o, seconds, before))
    end
  end
  if run:cancelled() and #notes == 0 then
    notes[1] = "interrupted before a thrust was found at which the closed loop tracks this course"
  elseif #notes == 0 then
    notes[1] = string.format(
      "no tried thrust from %.2f to %.2f gives a flight that the closed loop tracks: gates need "
      .. "turns that vehicle '%s' cannot fly; use wider gates (tolerance of keyframes), "
      .. "more time (time) or weights.smoothness, or set closed_loop=reported", low, o.thrust,
      vehicle.name)
  end
  return notes
end

return M
