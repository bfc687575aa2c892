-- SPDX-License-Identifier: Apache-2.0
-- Large regions, square by square. The candidates of a square are evaluated with few pixels, and
-- one tour over it chooses those that are worth flying to, with more time than the batteries have
-- for the square. Only these, from all squares, are evaluated with all pixels and joined by
-- motions. The tours are then planned among all of them at once.
local few = require "mission.scan_few"
local patterns = require "mission.scan_patterns"
local space = require "mission.scan_space"
local tours = require "mission.scan_tours"

local M = {}

M.DECLARATION = {
  name = "tiles", type = "table",
  summary = "squares of a large region, whose candidates are chosen one square after the other",
  table = {
    { name = "edge", type = "number", unit = "m", above = 0, maximum = 1e5,
      summary = "largest edge of a square on the ground; absent: the region is not divided" },
    { name = "halo", type = "number", unit = "m", default = 30, minimum = 0, maximum = 1e5,
      summary = "width of the border around a square that its candidates also look at" },
    { name = "pixels", type = "integer", default = 150, minimum = 1, maximum = 10000,
      summary = "pixels per row in the evaluation of all candidates of a square" },
    { name = "pool", type = "number", default = 2.5, minimum = 1, maximum = 100,
      summary = "time of the tour that chooses views of a square, as a multiple of the time that "
        .. "the batteries have for each square" },
  },
}
local ITERATIONS = 500  -- of the solver that chooses
local JOINING = 1       -- thirds of the chosen views that are added of the first flight

local notes = setmetatable({}, { __mode = "k" })  -- of runs

function M.wanted(run) return run.options.tiles.edge ~= nil end

-- What does not go with squares.
function M.check(run, in_passing)
  local o = run.options
  if not M.wanted(run) then
    for _, name in ipairs { "halo", "pixels", "pool" } do
      if run:stated("tiles." .. name) then
        run:fail("tiles." .. name, "is for squares of the region: set tiles.edge")
      end
    end
    return
  end
  local function refuse(option, why) run:fail("tiles.edge", option .. why) end
  if in_passing then refuse("the model", " takes images in passing, which needs no squares") end
  if #o.views > 0 then refuse("views", " are given, so that nothing is chosen in squares") end
  if o.exploration.images > 0 then refuse("exploration", " is for regions without squares") end
  if o.rounds > 1 then refuse("rounds", ": squares are for one round") end
end

-- The squares: the space of their candidates, which together is `room`, and what they look at.
local function squares(run, room)
  local region, t = space.region_of(run), run.options.tiles
  local counts, list = {}, {}
  for axis = 1, 2 do
    counts[axis] = math.max(1, math.ceil((region.upper[axis] - region.lower[axis]) / t.edge))
  end
  local function between(axis, k)
    return region.lower[axis]
           + (region.upper[axis] - region.lower[axis]) * k / counts[axis]
  end
  for row = 1, counts[2] do
    for column = 1, counts[1] do
      local allowed = { lower = { 0, 0, room.lower[3] }, upper = { 0, 0, room.upper[3] } }
      local seen = { lower = { 0, 0, region.lower[3] }, upper = { 0, 0, region.upper[3] } }
      for axis, k in ipairs { column, row } do
        local low, high = between(axis, k - 1), between(axis, k)
        seen.lower[axis] = math.max(region.lower[axis], low - t.halo)
        seen.upper[axis] = math.min(region.upper[axis], high + t.halo)
        allowed.lower[axis] = k == 1 and room.lower[axis] or low
        allowed.upper[axis] = k == counts[axis] and room.upper[axis] or high
      end
      list[#list + 1] = { allowed = allowed, seen = seen }
    end
  end
  return list
end

local function holds(box, p)
  for axis = 1, 3 do
    if p[axis] < box.lower[axis] or p[axis] > box.upper[axis] then return false end
  end
  return true
end

-- Where the candidates of a square grow from: its part of `poses`, and the air above its middle.
local function starts_of(run, square, poses)
  local starts = {}
  for _, pose in ipairs(poses) do
    if holds(square.allowed, pose.position) then starts[#starts + 1] = pose end
  end
  starts = few(starts, 0, run.options.candidates.most)
  local middle = { 0, 0, math.min(space.safe_height(run) + 2, square.allowed.upper[3]) }
  for axis = 1, 2 do
    middle[axis] = (square.seen.lower[axis] + square.seen.upper[axis]) / 2
  end
  starts[#starts + 1] = patterns.looking_in(middle, square.seen, 0)
  return starts
end

-- Views from all squares that are worth flying to. `graph`: the settings of the graph of the whole
-- region; `poses`: of the first flight; `seconds`: of all tours together.
local function chosen_in_squares(run, graph, poses, seconds)
  local o, chosen = run.options, {}
  local list = squares(run, graph.allowed)
  local pixels = o.effort.pixels
  local settings = {}
  for key, value in pairs(graph) do settings[key] = value end
  settings.across = pixels > 0 and math.min(pixels, o.tiles.pixels) or o.tiles.pixels
  settings.solver, settings.iterations = tours.solver(run), ITERATIONS
  settings.budget = o.tiles.pool * seconds / #list
  for number, square in ipairs(list) do
    run:progress((number - 1) / #list, string.format("square %d of %d", number, #list))
    settings.allowed, settings.tile = square.allowed, square.seen
    settings.starts = starts_of(run, square, poses)
    for _, view in ipairs(run:tile_views(settings)) do chosen[#chosen + 1] = view end
  end
  notes[run] = string.format("%d squares, in which %d views were chosen", #list, #chosen)
  return chosen
end

-- The views of the graph of the whole region: the first `needed` of `starts`, some of the others,
-- so that squares are joined, and those that are chosen in the squares.
function M.starts(run, graph, starts, needed)
  local o = run.options
  local seconds = tours.budget(run) * math.max(o.batteries, o.drones)
  local chosen = chosen_in_squares(run, graph, starts, seconds)
  if #chosen == 0 then
    run:fail("tiles.edge", "no view of any square tells of the region within the time that the "
                           .. "batteries have for a square: larger squares, more batteries or a "
                           .. "larger tiles.pool give them more")
  end
  local all = few(starts, needed, JOINING * #chosen)
  all = table.move(all, 1, #all, 1, {})
  return table.move(chosen, 1, #chosen, #all + 1, all)
end

-- What was done, or nothing.
function M.note(run) return notes[run] end

return M
