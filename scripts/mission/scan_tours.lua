-- SPDX-License-Identifier: Apache-2.0
-- What every tour of a scan needs: its budget, its solver, and its legs.
local smooth = require "mission.scan_smooth"

local M = {}
local OWN_OF_TOUR = { solver = true, budget = true, budget_metres = true, images = true,
                      begin = true, guard = true }
local BUDGET = 300         -- s, where none is given
local METRES_A_SECOND = 3  -- of a budget in metres (reading 4.6)
-- Each begins with the tour of the one before, and the better one is kept. Which it is depends on
-- region and budget. Recursive greedy plans one tour, so that fleets begin with cost_benefit alone.
local BEGIN = { "cost_benefit", "recursive_greedy" }
local BEGIN_OF_FLEET = { "cost_benefit" }

-- The solver with its own parameters.
function M.solver(run)
  local tour = run.options.tour
  local chosen = { type = tour.solver }
  for key, value in pairs(tour) do
    if not OWN_OF_TOUR[key] then chosen[key] = value end
  end
  return chosen
end

-- s of one tour.
function M.budget(run)
  local tour = run.options.tour
  return tour.budget_metres and tour.budget_metres / METRES_A_SECOND or tour.budget or BUDGET
end

-- The solvers whose tours the solver begins with, one after the other; `fleet`: of several tours.
function M.beginners(run, fleet)
  local tour = run.options.tour
  if tour.begin == "none" or tour.solver ~= "local_search" then return {} end
  if tour.begin then return { tour.begin } end
  return fleet and BEGIN_OF_FLEET or BEGIN
end

-- What the options of the tour say together.
function M.check(run)
  local tour = run.options.tour
  if tour.budget and tour.budget_metres then
    run:fail("tour.budget_metres", string.format(
      "budget is %.6g s and budget_metres %.6g m, which is %.6g s: give one of them",
      tour.budget, tour.budget_metres, tour.budget_metres / METRES_A_SECOND))
  end
  if tour.images == 1 then
    run:fail("tour.images", "a tour has at least two images; 0: any number")
  end
  if tour.begin ~= "none" then run:expect_plugin("tour.begin", "tour_solver") end
  if tour.begin and tour.begin ~= "none" and tour.solver ~= "local_search" then
    run:fail("tour.begin", string.format("'%s' cannot begin with the tour of another solver, only "
                                         .. "local_search can", tour.solver))
  end
end

-- Solutions of the legs with `flight.smooth`, else nil for pure pursuit. Adds a note.
-- `begin(phase)` reports the phase that begins.
function M.legs(run, vehicle, tour, notes, begin)
  if not run.options.flight.smooth then return nil end
  begin("smooth legs")
  local legs, stray = smooth.legs(run, vehicle, tour)
  notes[#notes + 1] = legs
    and string.format("smooth legs by %s, at most %.2g m from their paths", legs[1].solver, stray)
    or "cancelled before all legs were smooth: flown by pure pursuit"
  return legs
end

return M
