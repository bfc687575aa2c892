-- SPDX-License-Identifier: Apache-2.0
-- Legs of a tour by a trajectory solver instead of pure pursuit: from rest to rest, with little
-- jerk, and without stops at the corners of paths around obstacles. Each leg is a separate problem.
local paths = require "mission.paths"
local point_mass = require "mission.point_mass"

local M = {}

local STEP = 0.1           -- s, between stages
local FEWEST = 16          -- intervals
local SPACING = 0.05       -- m, of the way that is timed
local PLACES = 0.2         -- s, between the places that draw the flight to the way
local PULL = 100           -- weight of all those places together, per m^2
local JERK = 1e-3          -- weight of the jerk, per (m/s^3)^2 s
local HARDER, SLOWER = 10, 1.1
local HARDEST, SLOWEST = 1e5, 3

-- Pure pursuit flies a point mass; smooth legs are flown by any model that can rest in a view. True
-- where the model cannot, so that images are taken in passing.
function M.check(run, vehicle)
  local o = run.options
  local p = run:problem { vehicle = vehicle, duration = 1, environment = {} }
  p:add_model(o.model)
  point_mass.check(p, o.model)
  if not p:rests() then return true end
  if o.flight.smooth then return false end
  if o.model.type ~= "quadrotor" then
    run:fail("model", string.format("pure pursuit flies the model 'quadrotor'; '%s' needs "
                                    .. "flight.smooth = true", o.model.type))
  end
  return false
end

-- Places along the way and the times at which they are passed, spread over `duration`.
local function places_of(run, vehicle, leg, duration)
  local flight, count = run.options.flight, #leg.points
  local length = 0
  for i = 4, count do length = length + math.abs(leg.points[i] - leg.points[i - 3]) end
  if length == 0 then
    local there = paths.point(leg.points, 1)
    return { { time = 0, value = there }, { time = duration, value = there } }
  end
  local timed = run:time_path { points = leg.points, spacing = SPACING, rounding = flight.stray,
                                vehicle = vehicle, share = 0.9, speed = flight.speed,
                                acceleration = flight.acceleration }
  local slower = duration / timed.times[#timed.times]
  local places = {}
  for i, t in ipairs(timed.times) do
    local time, last = slower * t, places[#places]
    if not last or time >= last.time + PLACES then
      places[#places + 1] = { time = time, value = paths.point(timed.points, i) }
    end
  end
  return places
end

local function solved(run, vehicle, leg, duration, pull)
  local steps = math.max(FEWEST, math.ceil(duration / STEP))
  local p = run:problem { vehicle = vehicle, duration = duration, step = duration / steps,
                          environment = {} }
  local places = places_of(run, vehicle, leg, duration)
  local first, last = paths.point(leg.points, 1), paths.point(leg.points, #leg.points // 3)
  p:add_cost { type = "keyframe", name = "way", weight = pull / #places, keyframes = places }
  point_mass.add(p, vehicle, { model = run.options.model,
                               smoothness = { name = "jerk", order = 3, weight = JERK },
                               yaw = { weight = 0.02 }, inputs = { across = "extent" } })
  point_mass.must_rest(run, p, "model", "a scan takes its images at rest")
  p:add_constraint { type = "boundary_state", start_position = first, finish_position = last,
                     start_yaw = leg.yaw_from, finish_yaw = leg.yaw_to }
  local times, positions, yaws = {}, {}, {}
  local function guess(time, place)
    times[#times + 1], positions[#positions + 1] = time, place
    yaws[#yaws + 1] = leg.yaw_from + time / duration * (leg.yaw_to - leg.yaw_from)
  end
  for _, place in ipairs(places) do
    if place.time < duration - 1e-3 then guess(place.time, place.value) end
  end
  guess(duration, last)
  p:guess_path { times = times, positions = positions, yaws = yaws }
  p:finish()
  return run:solve(p, run.options.solver)
end

-- A solution for each leg of the tour; nil where the user asked to end. A leg that leaves its way
-- by more than `flight.stray` is drawn to it harder, then flown slower.
function M.legs(run, vehicle, tour)
  local legs, solutions, strayed = tour.legs, {}, 0
  for i, leg in ipairs(legs) do
    run:progress((i - 1) / #legs, "smooth legs")
    local duration, pull, stray, solution = leg.seconds, PULL, nil, nil
    while true do
      if run:cancelled() then return nil end
      solution = solved(run, vehicle, leg, duration, pull)
      local found = solution.status == "optimal" or solution.status == "feasible"
      stray = found and run:path_distance { points = solution.path, path = leg.points }
      if found and stray <= run.options.flight.stray then break end
      if found and pull < HARDEST then pull = pull * HARDER else duration = duration * SLOWER end
      if duration > SLOWEST * leg.seconds then
        run:fail("flight.smooth", string.format(
          "no smooth flight of leg %d of %d (%.3g s): %s", i, #legs, leg.seconds,
          found and string.format("it is %.3g m from its path, and %.3g m are allowed "
                                  .. "(flight.stray)", stray, run.options.flight.stray)
          or solution.solver .. " ended " .. solution.status .. ": " .. solution.message))
      end
    end
    solutions[i], strayed = solution, math.max(strayed, stray)
  end
  return solutions, strayed
end

return M
