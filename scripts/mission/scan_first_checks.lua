-- SPDX-License-Identifier: Apache-2.0
-- What is wrong with a first flight, or with the files of an earlier one.
local exploration = require "mission.scan_exploration"
local space = require "mission.scan_space"

local M = {}

-- What files of an earlier flight leave open: all of it at once, with where the mesh is.
function M.prior(run)
  local o, files = run.options, space.prior_files(run)
  if not files or exploration.wanted(run) then return end
  local flown_in = o.scene or o.input
  local lacks, give = {}, {}
  if not (o.start or #o.fleet.starts > 0 or flown_in and #o.flights > 0) then
    lacks[1], give[1] = "the start of the tour", "start = {x, y, z}"
  end
  if not (flown_in or #o.regions > 0 or o.region.lower and o.region.upper) then
    lacks[#lacks + 1] = "the region of interest"
    give[#give + 1] = "region = { lower = {x, y, z}, upper = {x, y, z} }"
  end
  if #lacks == 0 then return end
  local mesh = run:read_surface { file = files.mesh }
  local from, to = mesh.lower, mesh.upper
  run:fail("prior", string.format(
    "files of an earlier flight do not state %s: give %s. The mesh '%s' lies between "
    .. "{%.4g, %.4g, %.4g} and {%.4g, %.4g, %.4g}", table.concat(lacks, " and "),
    table.concat(give, " and "), files.mesh, from[1], from[2], from[3], to[1], to[2], to[3]))
end

-- Checks `range`: at least one first flight must see the upper side of the region in its steepest
-- images. A warning states if none sees the floor, because the space near it then stays unknown.
function M.range(run)
  local o, region, range = run.options, space.region_of(run), space.range(run)
  local half = math.atan(o.camera.height / 2, o.camera.focal)
  local function nearest(z)
    local least = math.huge
    for _, flight in ipairs(space.flights_of(run)) do
      local steepest = math.min(math.pi / 2, half - math.rad(space.pitch_of(flight)))
      if steepest > 0 then
        least = math.min(least, (space.height_of(run, flight) - z) / math.sin(steepest))
      end
    end
    return least
  end
  local cure = "a longer range, steeper images (flights, pitch_deg) or a lower safe_height"
  local floor, upper = nearest(region.lower[3]), nearest(region.upper[3])
  if upper > range then
    run:fail("range", string.format(
      "no first flight sees the region: the shortest ray to its upper side is "
      .. "%.4g m long, and depth is measured up to %g m; use %s", upper, range, cure))
  end
  if floor <= range then return nil end
  local warning = string.format(
    "no first flight sees the floor of the region: the shortest ray is %.4g m long, and depth is "
    .. "measured up to %g m; use %s", floor, range, cure)
  print("warning: " .. warning)
  return warning
end

return M
