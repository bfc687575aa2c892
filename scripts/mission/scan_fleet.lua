-- SPDX-License-Identifier: Apache-2.0
-- Scans with several batteries and several drones: tours that share one score (the team
-- orienteering problem), and the fleet of plans that fly them.
local accuracy = require "mission.scan_accuracy"
local first = require "mission.scan_first"
local memory = require "mission.scan_memory"
local patterns = require "mission.scan_patterns"
local space = require "mission.scan_space"
local tours = require "mission.scan_tours"
local wishes = require "mission.scan_wishes"
local words = require "mission.scan_words"
local zones = require "mission.scan_zones"

local M = {}
local TIGHTER = 4  -- times that tours which fly too long are planned on less

local function number(name, default, unit, summary)
  return { name = name, type = "number", default = default, unit = unit, minimum = 0,
           maximum = 1e6, summary = summary }
end

M.DECLARATIONS = {
  { name = "batteries", type = "integer", default = 1, minimum = 1, maximum = 100,
    summary = "largest number of tours, each with one battery" },
  { name = "drones", type = "integer", default = 1, minimum = 1, maximum = 100,
    summary = "number of drones that share the batteries" },
  { name = "fleet", type = "table", summary = "several batteries or drones", table = {
    { name = "starts", type = "tables", summary = "start and end of the tours of each drone, one "
      .. "per drone; absent: `start` for all", table = {
        { name = "position", type = "numbers", size = 3, unit = "m", required = true,
          summary = "place in the air, world" } } },
    number("separation", 5, "m", "smallest distance of two drones in flight, by their true "
           .. "positions; plans keep it and twice gps_accuracy; 0: any"),
    number("swap", 60, "s",
           "smallest time between two tours of a drone: landing, change of the battery, climb"),
    number("reserve", 60, "s", "flight time that is left of a battery after its tour") } },
}

table.move(accuracy.DECLARATIONS, 1, #accuracy.DECLARATIONS, #M.DECLARATIONS + 1, M.DECLARATIONS)

function M.wanted(run)
  return run.options.batteries > 1 or run.options.drones > 1 or accuracy.wanted(run)
end

-- Every solver that is asked for must take teams.
local function check_solvers(run)
  local able = run:team_solvers()
  for option, solver in pairs { ["tour.solver"] = run.options.tour.solver,
                                ["tour.begin"] = tours.beginners(run, true)[1] } do
    local takes = false
    for _, name in ipairs(able) do takes = takes or name == solver end
    if not takes then
      run:fail(option, string.format(
        "%s plans one tour, not several that share one score; expected one of: %s", solver,
        table.concat(able, ", ")))
    end
  end
end

-- What the options say, before anything is flown.
function M.check(run, vehicle, in_passing)
  local o = run.options
  local fleet = o.fleet
  accuracy.check(run)
  local most = accuracy.most(run)
  if o.drones > most then
    run:fail("drones", string.format(
      "%d drones and %d %s: every drone needs a battery, so give at least as many batteries as "
      .. "drones", o.drones, most, most == 1 and "battery" or "batteries"))
  end
  if not M.wanted(run) then
    for _, name in ipairs { "starts", "separation", "swap", "reserve" } do
      if run:stated("fleet." .. name) then
        run:fail("fleet." .. name, "is for several batteries: set batteries")
      end
    end
    return
  end
  if in_passing then
    run:fail(accuracy.wanted(run) and "accuracy" or "batteries",
             "a vehicle that takes its images in passing flies one tour: expected one battery")
  end
  if o.exploration.images > 0 then
    run:fail("exploration", "an exploration and its tour share one battery: expected one battery")
  end
  if o.finish then
    run:fail("finish", "every tour of several batteries ends where it began: leave finish out")
  end
  if #fleet.starts > 0 and o.start then
    run:fail("start", "fleet.starts states the starts of all drones: give one of the two")
  end
  if #fleet.starts > 0 and #fleet.starts ~= o.drones then
    run:fail("fleet.starts", string.format("expected as many starts as drones, %d, got %d",
                                           o.drones, #fleet.starts))
  end
  check_solvers(run)
  local budget = tours.budget(run)
  if budget + fleet.reserve > vehicle.flight_time then
    run:fail("fleet.reserve", string.format(
      "a tour of %.6g s and a reserve of %.6g s are more than the %.6g s that one battery of the "
      .. "vehicle lasts: lower tour.budget or the reserve", budget, fleet.reserve,
      vehicle.flight_time))
  end
end

-- As scan_first.starts; with several starts the first ones are those of the drones, in their order.
function M.starts(run, poses)
  local given = run.options.fleet.starts
  if #given == 0 then return first.starts(run, poses) end
  local starts = {}
  for _, start in ipairs(given) do
    starts[#starts + 1] = patterns.looking_in(start.position, space.region_of(run), 0)
  end
  for _, pose in ipairs(poses) do starts[#starts + 1] = pose end
  return starts, #given
end

-- The tours that are asked for: batteries are dealt to the drones in turn.
local function wanted_tours(run, graph, batteries)
  local o, wanted = run.options, {}
  for battery = 1, batteries do
    local drone = (battery - 1) % o.drones + 1
    wanted[battery] = {
      name = string.format("drone %d, battery %d", drone, (battery - 1) // o.drones + 1),
      home = #o.fleet.starts > 0 and drone or graph.home,
    }
  end
  return wanted
end

-- What the mission was asked for, and what could have been had.
local function refuse(run, graph, team, budget, batteries)
  local found = team.status == "optimal" or team.status == "feasible"
  local why = found and "no further view adds information within that time"
    or team.message ~= "" and team.message or team.status
  run:fail("tour", string.format(
    "no %d tours of %.4g s: %s. From the start (one of %d candidates) %s; %d views lie within the "
    .. "budget", batteries, budget, why, graph.candidates, graph.reach,
    team.reachable))
end

-- Tours within `budget` seconds each, one for each battery, and the evaluations that they took.
local function solved(run, graph, budget, batteries)
  local o = run.options.tour
  local wanted = wanted_tours(run, graph, batteries)
  local function solve(solver, initial)
    return run:solve_team { graph = graph, solver = solver, budget = budget, images = o.images,
                            tours = wanted, guard = o.guard, initial = initial }
  end
  local initial, spent = nil, 0
  for _, beginner in ipairs(tours.beginners(run, true)) do
    local begun = solve(beginner, initial)
    if #begun.tours > 0 then initial = begun end
    spent = spent + begun.evaluations
  end
  local team = solve(tours.solver(run), initial)
  if #team.tours == 0 and initial and run:cancelled() then team = initial end
  if team.images < 2 or #team.tours == 0 then refuse(run, graph, team, budget, batteries) end
  return team, spent + team.evaluations
end

-- Plans of the tours that take images elsewhere than at home, and the drones that fly them. Map and
-- mesh are written once: `shared` is an earlier plan on the same graph, or nil.
local function flown(run, vehicle, team, asked, begin, shared)
  local o = run.options
  local plans, drones, longest = {}, {}, 0
  for k, tour in ipairs(team.tours) do
    if tour.images > 1 then
      local notes = {}
      local legs = tours.legs(run, vehicle, tour, notes, begin)
      begin("flight")
      local plan = run:scan_plan {
        tour = tour, legs = legs, margin = zones.margin(run), budget = asked, notes = notes,
        part_of_fleet = true, shares = plans[1] or shared,
        closed_loop_required = o.closed_loop == "required",
        figures = { score = tour.score, seconds = tour.seconds, images = tour.images },
      }
      plans[#plans + 1] = plan
      drones[#drones + 1] = tostring((k - 1) % o.drones + 1)
      longest = math.max(longest, plan.duration)
    end
  end
  return plans, drones, longest
end

local function notes_of(run, graph, known, explored, plans, batteries)
  local o = run.options
  local notes = words.notes(run, known, explored, string.format(
    "%d candidates, %d motions", graph.candidates, graph.motions))
  local apart = words.cut_off(graph)
  if apart then
    notes[#notes + 1] = apart
    print("warning: " .. apart)
  end
  for drone in ipairs(o.fleet.starts) do
    notes[#notes + 1] = words.cut_off_start(graph, drone)
  end
  zones.add_notes(run, graph, notes)
  if #plans < batteries then
    notes[#notes + 1] = string.format(
      "%d of %d batteries are flown: no view adds information to the tours of the others",
      #plans, batteries)
  end
  return notes
end

-- Between planned positions: each drone may be elsewhere by the accuracy of its position.
local function separation(run)
  local o = run.options
  return o.fleet.separation > 0 and o.fleet.separation + 2 * o.gps_accuracy or 0
end

-- The fleet. `begin(phase)` reports the phase that begins.
function M.plan(run, graph, vehicle, known, explored, begin)
  local o = run.options
  local asked = tours.budget(run)
  -- Smooth legs take what was counted; the rest in the first view comes on top.
  local budget = asked - (o.flight.smooth and o.flight.pause or 0)
  local shared
  local batteries
  for round = 1, TIGHTER do
    begin("tour")
    local team, evaluations, found = accuracy.search(run, function(count)
      return solved(run, graph, budget, count)
    end, batteries)
    batteries = #team.tours
    wishes.require_all(run, team, graph, string.format("of %d of %.4g s", batteries, budget))
    run:estimate { tours = team.tours, changed = memory.changed(run) }
    local plans, drones, longest = flown(run, vehicle, team, asked, begin, shared)
    shared = plans[1]
    -- Corners and rests may take a little more than the legs one by one.
    local over = longest - asked
    if over <= 0 or round == TIGHTER then
      local figures = words.figures(graph, team, asked, evaluations, explored)
      figures.batteries, figures.drones, figures.tours = batteries, o.drones, #plans
      local notes = notes_of(run, graph, known, explored, plans, batteries)
      if found then notes[#notes + 1], figures.accuracy = accuracy.told(run, found) end
      return run:fleet {
        team = team, plans = plans, drones = drones, separation = separation(run),
        swap = o.fleet.swap, reserve = o.fleet.reserve, pixel_error = o.pixel_error,
        notes = notes, figures = figures,
      }
    end
    budget = budget - 1.5 * over
  end
end

return M
