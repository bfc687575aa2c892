-- SPDX-License-Identifier: Apache-2.0
-- What a scan tells its user beside the plan: what was known, and where the tour shows little.
local first = require "mission.scan_first"

local M = {}

local LITTLE = 0.5         -- share of the budget; whatever leaves more than the rest is told so

-- What is said of what came before the tour; `views` says what the tour chose among.
function M.notes(run, known, explored, views)
  local notes
  if explored then
    notes = { string.format("explored first: %d depth images on %.0f m in %.0f s, %.0f %% of the "
                            .. "surface; %s", explored.images, explored.length, explored.flight,
                            100 * explored.observed_surface / explored.surface, explored.reason),
              views }
  else
    local before = string.format("%d depth images %s", known.images,
                                 run.options.rounds > 1 and "so far" or "of the first flight")
    notes = { (known.images > 0 and before or "files of an earlier flight") .. ", " .. views }
  end
  notes[#notes + 1] = first.warning(run)
  notes[#notes + 1] = first.sparse(run)
  return notes
end

-- What is said where the start leads to few of the views, however much of the battery is used.
function M.cut_off(graph)
  if graph.joined >= LITTLE * graph.candidates then return nil end
  return graph.reach .. ". What the others would show is not seen. More candidates "
         .. "(candidates.most), first flights nearer to the region or a lower motions.alpha "
         .. "would join more"
end

-- What is said of a tour that leaves most of the battery although it may have more images.
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
