-- SPDX-License-Identifier: Apache-2.0
-- Scans (thesis chapter 4): selection of images of a region and of their order, so that one battery
-- gives the best model.
--
--   local scan = require "mission.scan"
--   return scan.of_scene { name = "church", scene = "church", tour = { budget = 300 } }
--
-- A first flight gives depth images, and these give a map and a mesh, which are all that is known
-- (reading 4.9). Candidate views are evaluated in the map. Paths are planned between views whose
-- images match. A tour solver selects a tour within the budget, flown from view to view.
local mission_of = require "mission.mission_of"
local exploration = require "mission.scan_exploration"
local few = require "mission.scan_few"
local first = require "mission.scan_first"
local fleet = require "mission.scan_fleet"
local images = require "mission.scan_images"
local memory = require "mission.scan_memory"
local meshing = require "mission.scan_meshing"
local passing = require "mission.scan_passing"
local phases = require "mission.scan_phases"
local polygons = require "mission.scan_polygons"
local site = require "mission.scan_site"
local smooth = require "mission.scan_smooth"
local space = require "mission.scan_space"
local tiles = require "mission.scan_tiles"
local tours = require "mission.scan_tours"
local usable = require "mission.scan_usable"
local views = require "mission.scan_views"
local wishes = require "mission.scan_wishes"
local words = require "mission.scan_words"
local zones = require "mission.scan_zones"
local DECLARATIONS = require "mission.scan_options"

local M = {}
local TIGHTER = 4          -- times that a tour which flies too long is planned on less

local function check(run)
  local o = run.options
  tours.check(run)
  if o.rounds > 1 and not (o.scene or o.input) then
    run:fail("rounds", "rounds after the first need a simulation: name a scene or an input, or "
                       .. "plan each round from the files of the round before")
  end
  for axis = 1, 3 do
    if not (o.body[axis] > 0) then run:fail("body", "half edges must be above 0 m") end
  end
  first.check(run)
end

-- `like`: of a plan near it, for an estimate.
local function graph_of(run, known, vehicle, starts, finish, like)
  local o = run.options
  local gimbal = vehicle.gimbal
  local c = o.candidates
  local graph = {
    prior = known, vehicle = vehicle, region = space.region_of(run), rules = zones.rules(run),
    allowed = space.room(run, starts),
    body = zones.body(run),
    mesh_room = o.mesh_room,
    candidates = {
      most = c.most, least = c.least, directions = c.directions, step = c.step,
      step_growth = c.step_growth,
      distance_apart = c.distance_apart, angle_apart_deg = c.angle_apart_deg,
      pitch_min_deg = gimbal and math.max(-90, math.deg(gimbal.pitch_min)) or -90,
      pitch_max_deg = gimbal and math.min(0, math.deg(gimbal.pitch_max)) or 0 },
    motions = o.motions, camera = o.camera, across = o.effort.pixels, range = space.range(run),
    usable_range = usable.range(run), usable_incidence_deg = o.usable.incidence_deg,
    flight = o.flight,
    information = o.information, planner = o.planner,
  }
  wishes.settle(run, graph)
  graph.like = like
  if tiles.wanted(run) then
    known:simplify()
    starts = tiles.starts(run, graph, starts, finish)
    graph.candidates.most, graph.candidates.least = #starts, 0
  elseif not views.wanted(run) then
    starts = few(starts, finish, c.most)
  end
  graph.starts, graph.loops = starts, fleet.wanted(run)
  graph.needed = (o.start or o.finish or #o.fleet.starts > 0 or o.exploration.images > 0) and finish
    or 0
  graph.fixed = o.start ~= nil or #o.fleet.starts > 0 or o.exploration.images > 0
  return run:scan_graph(views.settle(run, graph))
end

-- What the mission was asked for, and what could have been had.
local function refuse(run, graph, tour, budget)
  local found = tour.status == "optimal" or tour.status == "feasible"
  local why = found and "no further view adds information within that time"
    or tour.message ~= "" and tour.message or tour.status
  run:fail("tour", string.format(
    "no tour of %.4g s: %s. From the start (one of %d candidates) %s; %d views lie within "
    .. "the budget", budget, why, graph.candidates, graph.reach, tour.reachable))
end

-- A tour within `budget` seconds by the solver that is asked for, begun with those of others, and
-- the evaluations of all.
local function solved(run, graph, finish, budget)
  local o = run.options.tour
  local initial, spent = nil, 0
  for _, beginner in ipairs(tours.beginners(run)) do
    local begun = run:solve_tour { graph = graph, solver = beginner, budget = budget,
                                   finish = finish, images = o.images, guard = o.guard,
                                   initial = initial }
    if begun.images > 1 then initial = begun end
    spent = spent + begun.evaluations
  end
  local tour = run:solve_tour { graph = graph, solver = tours.solver(run), budget = budget,
                                finish = finish, images = o.images, guard = o.guard,
                                initial = initial }
  if tour.images < 2 then
    if run:cancelled() and initial then return initial, spent end
    refuse(run, graph, tour, budget)
  end
  wishes.require_all(run, tour, graph, string.format("of %.4g s", budget))
  return tour, spent + tour.evaluations
end

-- `begin(phase)` reports the phase that begins.
local function plan_of(run, graph, vehicle, finish, known, explored, begin)
  local o = run.options
  local asked = tours.budget(run)
  -- Smooth legs take what was counted; the rest in the first view comes on top.
  local budget = asked - (o.flight.smooth and o.flight.pause or 0)
  for round = 1, TIGHTER do
    begin("tour")
    local tour, evaluations = solved(run, graph, finish, budget)
    run:estimate { tours = { tour }, changed = memory.changed(run) }
    local notes = words.notes(run, known, explored, string.format(
      "%d candidates, %d motions", graph.candidates, graph.motions))
    local little = words.little_used(run, tour, budget)
    notes[#notes + 1] = little
    local apart = words.cut_off(graph)
    notes[#notes + 1] = apart
    zones.add_notes(run, graph, notes)
    local legs = tours.legs(run, vehicle, tour, notes, begin)
    begin("flight")
    local plan = run:scan_plan {
      tour = tour, legs = legs, margin = zones.margin(run), budget = asked,
      closed_loop_required = o.closed_loop == "required",
      notes = notes, explored = explored, pixel_error = o.pixel_error,
      figures = words.figures(graph, tour, asked, evaluations, explored),
    }
    -- Corners and rests may take a little more than the legs one by one.
    local over = plan.duration - asked
    if over <= 0 or round == TIGHTER then
      if little then print("warning: " .. little) end
      if apart then print("warning: " .. apart) end
      return plan, tour
    end
    budget = budget - 1.5 * over
  end
end

local function planned(run)
  local o = run.options
  check(run)
  local vehicle = run:vehicle(o.vehicle)
  local in_passing = smooth.check(run, vehicle)
  passing.check(run, vehicle, in_passing)
  views.check(run, in_passing)
  wishes.check(run, in_passing)
  exploration.check(run)
  fleet.check(run, vehicle, in_passing)
  tiles.check(run, in_passing)
  local seconds = exploration.seconds(run, vehicle, tours.budget(run))
  phases.expect(run, tours.budget(run) * math.max(o.batteries, o.drones), in_passing)
  local kept, known, same = memory.recall(run, in_passing)
  local poses, surface, explored, starts, finish
  if kept and same then
    first.remind(run)
    finish = o.finish and 2 or 1
  else
    known, poses, surface, explored =
      first.knowledge(run, seconds, vehicle, in_passing and passing.air(run, vehicle), known)
    poses = views.poses(run, known, poses)
    if not in_passing then starts, finish = fleet.starts(run, kept and {} or poses) end
  end
  local plan
  for round = 1, o.rounds do
    local function begin(phase) run:phase(phases.named(run, phase, round)) end
    if in_passing then
      plan = passing.plan(run, vehicle, known, tours.budget(run), begin)
    else
      begin("views")
      local graph = same and kept or graph_of(run, known, vehicle, starts, finish, kept)
      if not same then memory.keep(run, in_passing, graph) end
      local last = o.finish and finish or graph.home  -- a loop, unless said otherwise
      if fleet.wanted(run) then
        plan = fleet.plan(run, graph, vehicle, known, explored, begin)
      else
        plan = plan_of(run, graph, vehicle, last, known, explored, begin)
      end
    end
    if round < o.rounds and not run:cancelled() then
      -- The tour is flown, and what it sees is known from then on; candidates grow from where it
      -- was as well (thesis 4.4.4).
      begin("look")
      first.look(run, known, surface, plan.views)
      for _, view in ipairs(starts and plan.views or {}) do starts[#starts + 1] = view end
      begin("mesh")
      known:reconstruct(meshing(run))
    end
  end
  return plan
end

-- A function that makes scans. `source(run)` states first what replaces a simulated first flight.
local function made(source, declarations)
  return function(given)
    given = polygons.written_out(given)
    return mission_of("scan", declarations or DECLARATIONS, given, function(run)
      if source then source(run) end
      return planned(run)
    end)
  end
end
local mission = made()
local function surveyed(kind) return made(function(run) site.expect(run, kind) end) end
-- Images of a real first flight, which `reader(run)` reads; `own`: the option of their kind.
local function photographed(own, reader)
  return made(function(run) images.expect(run, reader) end, images.declarations(DECLARATIONS, own))
end

-- A scene of scripts/scene, a mesh file of the user (`--set input=PATH`), or files of a real flight
-- (`prior`).
---@type fun(given: lapwing.scan.of_scene): lapwing.mission
M.of_scene = mission
---@type fun(given: lapwing.scan.of_mesh): lapwing.mission
M.of_mesh = mission
---@type fun(given: lapwing.scan.of_prior): lapwing.mission
M.of_prior = mission
-- A point cloud (`--set input=PATH`).
---@type fun(given: lapwing.scan.of_cloud): lapwing.mission
M.of_cloud = surveyed("cloud")
-- A raster of heights (`--set input=PATH`).
---@type fun(given: lapwing.scan.of_terrain): lapwing.mission
M.of_terrain = surveyed("terrain")
-- Depth images with poses (`--set folder=PATH`).
---@type fun(given: lapwing.scan.of_images): lapwing.mission
M.of_images = photographed(images.DEPTH, images.depth_images)
-- A COLMAP model (`--set folder=PATH`).
---@type fun(given: lapwing.scan.of_colmap): lapwing.mission
M.of_colmap = photographed(images.COLMAP, images.colmap)

return M
