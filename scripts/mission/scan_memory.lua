-- SPDX-License-Identifier: Apache-2.0
-- The graph of the plan before, for a program that plans again and again, as the studio does. Edits
-- of what comes after it, as of budget and batteries, need no other one.
local exploration = require "mission.scan_exploration"
local images = require "mission.scan_images"
local site = require "mission.scan_site"
local tiles = require "mission.scan_tiles"
local views = require "mission.scan_views"

local M = {}
local LATE = "tour batteries drones accuracy accuracy_share closed_loop pixel_error"
-- What an estimate may differ in from a plan whose map and mesh it is made on.
local NEAR = "region regions no_fly_zones flight_zones pilot home start finish fleet forbidden "
  .. "pinned"

-- Where a graph depends on its options alone, and is not changed afterwards.
local function possible(run, in_passing)
  return not (in_passing or run.options.rounds > 1 or tiles.wanted(run) or site.wanted(run)
              or images.wanted(run) or exploration.wanted(run))
end

-- Where a tour ends elsewhere than it begins, and begins at a view of the first flight, nobody says
-- which views those are in a changed graph.
local function settings(run, graph)
  local o = run.options
  local fixed = views.wanted(run) or (o.finish and not o.start)
  return { without = LATE, near = fixed and "" or NEAR, graph = graph }
end

local changed = setmetatable({}, { __mode = "k" })  -- of runs

-- Whether the graph of an estimate is changed from one of other options.
function M.changed(run) return changed[run] == true end

-- Graph and prior, or nil, and whether the graph is of these very options. Where only an estimate
-- is asked for, and there is no plan near it, the plan ends.
function M.recall(run, in_passing)
  if possible(run, in_passing) then
    local graph, known, same = run:kept_graph(settings(run))
    changed[run] = graph and not same
    return graph, known, same
  end
  return run:kept_graph { without = LATE, never = true }
end

function M.keep(run, in_passing, graph)
  if possible(run, in_passing) and not run:cancelled() then run:kept_graph(settings(run, graph)) end
end

return M
