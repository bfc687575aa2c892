-- SPDX-License-Identifier: Apache-2.0
-- Notes and warnings of a scan: the prior knowledge, and tours that use little of it.
local first = require "mission.scan_first"
local images = require "mission.scan_images"
local site = require "mission.scan_site"
local tiles = require "mission.scan_tiles"

local M = {}

local LITTLE = 0.5         -- share of the budget or of the candidates below which a note is given

-- Notes on the flight before the tour; `views` describes the candidates of the tour.
function M.notes(run, known, explored, views)
  local notes
  if explored then
    notes = { string.format("explored first: %d depth images on %.0f m in %.0f s, %.0f %% of the "
                            .. "surface; %s", explored.images, explored.length, explored.flight,
                            100 * explored.observed_surface / explored.surface, explored.reason),
              views }
  elseif site.wanted(run) then
    notes = site.notes(run, views)
  elseif images.wanted(run) then
    notes = images.notes(run, views)
  else
    local before = string.format("%d depth images %s", known.images,
                                 run.options.rounds > 1 and "so far" or "of the first flight")
    notes = { (known.images > 0 and before or "files of an earlier flight") .. ", " .. views }
  end
  notes[#notes + 1] = first.warning(run)
  notes[#notes + 1] = first.sparse(run)
  notes[#notes + 1] = tiles.note(run)
  return notes
end

-- The note for a start that is connected to few candidates, or nil.
function M.cut_off(graph)
  if graph.joined >= LITTLE * graph.candidates then return nil end
  return graph.reach .. ". The content of the others is not seen. More candidates "
         .. "(candidates.most), first flights closer to the region or a lower motions.alpha "
         .. "connect more of them"
end

-- The note for the start of a drone, one of several, that is connected to few candidates, or nil.
function M.cut_off_start(graph, drone)
  local joined = graph.joined_from[drone]
  if joined >= LITTLE * graph.candidates then return nil end
  return string.format("the start of drone %d is connected to %d of %d candidates", drone, joined,
                       graph.candidates)
end

-- The note for a tour that uses little of the budget although it may have more images, or nil.
function M.little_used(run, tour, budget)
  local most = run.options.tour.images
  if run:cancelled() or tour.seconds >= LITTLE * budget or (most > 0 and tour.images >= most) then
    return nil
  end
  return string.format("the tour takes %.3g of %.6g s (%s: %s); %d views lie within the budget",
                       tour.seconds, budget, tour.name,
                       tour.message ~= "" and tour.message or tour.status, tour.reachable)
end

-- What a plan states of its tour, for --json.
function M.figures(graph, tour, budget, evaluations, explored)
  return { score = tour.score, upper_bound = tour.upper_bound, gap = tour.gap,
           seconds = tour.seconds, budget = budget, images = tour.images,
           candidates = graph.candidates, motions = graph.motions,
           reachable_score = tour.reachable_score, evaluations = evaluations,
           explored_seconds = explored and explored.flight }
end

return M
