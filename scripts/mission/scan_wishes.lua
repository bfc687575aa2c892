-- SPDX-License-Identifier: Apache-2.0
-- What the user wants of single views: pinned ones, which every plan takes, and places without
-- views.
local views = require "mission.scan_views"

local M = {}

M.DECLARATIONS = {
  { name = "pinned", type = "tables",
    summary = "views that the plan takes, whatever they show; the others are chosen around them",
    table = views.POSE },
  { name = "forbidden", type = "tables", summary = "balls in which no view is chosen; the flight "
    .. "may pass through them, and the start may lie there", table = {
      { name = "position", type = "numbers", size = 3, unit = "m", required = true,
        summary = "middle of the ball" },
      { name = "within", type = "number", default = 1, unit = "m", above = 0, maximum = 1e5,
        summary = "radius of the ball" } } },
}

-- What does not go with wishes.
function M.check(run, in_passing)
  for _, name in ipairs { "pinned", "forbidden" } do
    if #run.options[name] > 0 then
      if in_passing then
        run:fail(name, "the model cannot stand still: its images are taken in passing, where no "
                       .. "single view is chosen")
      end
      if views.wanted(run) then run:fail(name, "views are given, and they alone are flown to") end
    end
  end
end

-- Into the settings of a graph.
function M.settle(run, graph)
  local o = run.options
  graph.pinned, graph.viewless = {}, o.forbidden
  for k, view in ipairs(o.pinned) do graph.pinned[k] = views.placed(view) end
  return graph
end

-- An error where a pinned view is on none of the tours; `within` says what they may take.
function M.require_all(run, planned, graph, within)
  if #planned.missed == 0 or run:cancelled() then return end
  local first = planned.missed[1]
  local p = run.options.pinned[first].position
  local joined = graph.joined_from[#graph.joined_from - #run.options.pinned + first]
  run:fail("pinned", string.format(
    "view %d at (%.4g, %.4g, %.4g) is on no tour %s; %s", first, p[1], p[2], p[3], within,
    joined < graph.joined
      and string.format("its motions lead to %d other candidates, not to the start: its image "
                        .. "matches none of the others, or the way there is blocked", joined - 1)
      or "a larger budget, or fewer pinned views, would leave time for it"))
end

return M
