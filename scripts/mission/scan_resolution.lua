-- SPDX-License-Identifier: Apache-2.0
-- The edge of a scan's voxels: as stated, or that of the map of an earlier flight.
local exploration = require "mission.scan_exploration"
local images = require "mission.scan_images"

local M = {}

-- {map, mesh} of an earlier flight, or nothing.
function M.prior_files(run)
  local files = run.options.prior
  if not files.map and not files.mesh then return nil end
  if not (files.map and files.mesh) then
    run:fail("prior", "expected both a map and a mesh of an earlier flight")
  end
  return files
end

local resolutions = setmetatable({}, { __mode = "k" })  -- of runs

-- The edge of the map's voxels: files of an earlier flight have theirs, whatever a quick look asks.
function M.of(run)
  if resolutions[run] then return resolutions[run] end
  local o, files = run.options, M.prior_files(run)
  local edge = o.resolution or images.resolution(run)
               or exploration.wanted(run) and exploration.RESOLUTION or o.effort.resolution
  if files then
    edge = run:map_resolution(files.map)
    if o.resolution and math.abs(o.resolution - edge) > 1e-9 * edge then
      run:fail("resolution", string.format(
        "%.6g m, and the prior's map '%s' has voxels of %.6g m: leave resolution out",
        o.resolution, files.map, edge))
    end
  end
  resolutions[run] = edge
  return edge
end

return M
