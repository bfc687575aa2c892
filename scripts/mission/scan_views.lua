-- SPDX-License-Identifier: Apache-2.0
-- Tours of views that are given, such as those of an earlier plan that nobody photographed.
local space = require "mission.scan_space"
local zones = require "mission.scan_zones"

local M = {}

local function angle(name, lowest, highest, summary)
  return { name = name, type = "number", unit = "deg", required = true, minimum = lowest,
           maximum = highest, summary = summary }
end

-- A view, as options state it.
M.POSE = {
  { name = "position", type = "numbers", size = 3, unit = "m", required = true,
    summary = "position of the camera" },
  angle("yaw_deg", -360, 360, "heading of the camera"),
  angle("pitch_deg", -90, 90, "pitch of the camera, up is positive"),
}

M.DECLARATION = {
  name = "views", type = "tables",
  summary = "views to photograph, as many as the budget allows; they replace "
    .. "candidates and information, and motions join them whether their images match or not",
  table = M.POSE }

local NEIGHBOURS = 30  -- views that each one is joined with, whether their images match or not

-- The view with its angles in rad.
function M.placed(view)
  return { position = view.position, yaw = math.rad(view.yaw_deg),
           pitch = math.rad(view.pitch_deg) }
end

function M.wanted(run) return #run.options.views > 0 end

-- What does not go with views that are given.
function M.check(run, in_passing)
  if not M.wanted(run) then return end
  if in_passing then
    run:fail("views", "the model cannot stand still: its images are taken in passing, and no "
                      .. "views are given")
  end
  if run.options.rounds > 1 then run:fail("rounds", "views are given, so there is one round") end
end

-- The views as places from which a graph is made, without those that have no room, which are said.
function M.poses(run, known, poses)
  if not M.wanted(run) then return poses end
  local o, views = run.options, {}
  for k, view in ipairs(o.views) do views[k] = M.placed(view) end
  local free = known:free_views { views = views, body = zones.body(run), mesh_room = o.mesh_room,
                                  allowed = space.room(run, views) }
  local kept, numbers = {}, {}
  for _, number in ipairs(free) do
    kept[#kept + 1] = views[number]
    numbers[number] = true
  end
  for k, view in ipairs(views) do
    local why = zones.rules(run):forbids { position = view.position, body = zones.body(run) }
    if why then run:fail("views", string.format("view %d is forbidden: %s", k, why)) end
    if not numbers[k] then
      print(string.format("warning: view %d at (%.4g, %.4g, %.4g) is left out: map and mesh leave "
                          .. "the vehicle no room there", k, table.unpack(view.position)))
    end
  end
  if #kept == 0 then run:fail("views", "none of them has room for the vehicle in map and mesh") end
  return kept
end

-- The settings of the graph of these views.
function M.settle(run, graph)
  if not M.wanted(run) then return graph end
  graph.each = true
  graph.candidates.most = #graph.starts
  graph.motions = { alpha = 0, neighbours = NEIGHBOURS, among = 4 * NEIGHBOURS }
  return graph
end

return M
