-- SPDX-License-Identifier: Apache-2.0
-- The graph of the plan before, for a program that plans again and again, as the studio does. Edits
-- of what comes after it, as of budget and batteries, need no other one.
local exploration = require "mission.scan_exploration"
local fleet = require "mission.scan_fleet"
local images = require "mission.scan_images"
local site = require "mission.scan_site"
local tiles = require "mission.scan_tiles"

local M = {}
local LATE = "tour batteries drones accuracy accuracy_share closed_loop pixel_error"

-- Where a graph depends on its options alone, and is not changed afterwards.
local function possible(run, in_passing)
  return not (in_passing or run.options.rounds > 1 or tiles.wanted(run) or site.wanted(run)
              or images.wanted(run) or exploration.wanted(run))
end

local function settings(run, graph)
  return { without = LATE, also = tostring(fleet.wanted(run)), graph = graph }
end

-- Graph and prior, or nil. Where only an estimate is asked for, and there is none, the plan ends.
function M.recall(run, in_passing)
  if possible(run, in_passing) then return run:kept_graph(settings(run)) end
  return run:kept_graph { without = LATE, never = true }
end

function M.keep(run, in_passing, graph)
  if possible(run, in_passing) and not run:cancelled() then run:kept_graph(settings(run, graph)) end
end

return M
