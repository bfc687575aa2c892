-- SPDX-License-Identifier: Apache-2.0
-- Scans of sites that a surveyor has measured: a point cloud, or rasters of heights, in place of a
-- first flight.
--
-- A cloud tells what is occupied. What is free: the open sky above the highest voxel of each column
-- that has points or a mesh between them, and the lines from scanners to points, where scanners are
-- stated. A raster tells what is solid: all that is under it; what is above it is open sky.
-- Everything else is unknown and blocks flight: what lies under roofs and behind overhangs, and
-- columns without data below the safe height.
local polygons = require "mission.scan_polygons"
local resolution = require "mission.scan_resolution"

local M = {}

local LONGEST = 200  -- m, longest line from a scanner

local function number(name, unit, summary)
  return { name = name, type = "number", unit = unit, above = 0, maximum = 1e6, summary = summary }
end

-- Where data lie, the same for all kinds of them.
local function reference(of, more)
  local entries = {
    { name = "system", type = "text", default = "",
      summary = "reference system of its coordinates, as EPSG:28992; empty: as the file says" },
    { name = "zero", type = "numbers", size = 3,
      summary = "the world's origin in its coordinates, for a " .. of .. " without reference "
        .. "system; absent: 0, 0, 0" },
    number("height_unit", "m", "metres per unit of its heights; absent: as the file says, else the "
           .. "unit of x and y"),
  }
  return table.move(more, 1, #more, #entries + 1, entries)
end

M.DECLARATIONS = {
  { name = "cloud", type = "table", summary = "point cloud of `scan.of_cloud`",
    table = reference("cloud", {
      { name = "columns", type = "text", default = "",
        summary = "columns of a text, as \"x y z - nx ny nz\"; empty: as its first line says, or "
          .. "x y z" },
      { name = "without", type = "text", default = "7 18",
        summary = "classes of points that are left out; 7 and 18 are noise" },
      { name = "scanners", type = "tables", summary = "places from which it was measured", table = {
        { name = "position", type = "numbers", size = 3,
          summary = "in the coordinates of the cloud" } } },
      { name = "free", type = "choice", default = "auto",
        choices = { "auto", "sky", "scanners", "both" },
        summary = "what is free: open sky above the surface, lines from scanners to points, or "
          .. "both; auto: scanners if they are stated, else sky" } }) },
  { name = "terrain", type = "table", summary = "rasters of heights of `scan.of_terrain`",
    table = reference("raster", {
      { name = "ground", type = "text", default = "",
        summary = "raster of the terrain without buildings and plants, for heights above ground" }
    }) },
}

local sources = setmetatable({}, { __mode = "k" })  -- of runs: "cloud" or "terrain"
local found = setmetatable({}, { __mode = "k" })    -- of runs: sites

-- Called first by missions over a surveyor's data.
function M.expect(run, source) sources[run] = source end
function M.wanted(run) return sources[run] ~= nil end

-- Options that only simulated first flights have.
local SIMULATED = { "scene", "prior.map", "prior.mesh", "ground", "up", "flights", "noise.dropped",
                    "noise.sigma", "exploration.images", "surface.stride" }
local LACKS = {
  cloud = "no point cloud: name one with --set input=PATH (.las, .ply, .pcd, .xyz)",
  terrain = "no raster of heights: name one with --set input=PATH (GeoTIFF, .asc)",
}

local function refuse_others(run)
  for _, declared in ipairs(M.DECLARATIONS) do
    for _, entry in ipairs(sources[run] ~= declared.name and declared.table or {}) do
      local option = declared.name .. "." .. entry.name
      if run:stated(option) then run:fail(option, "is for scan.of_" .. declared.name) end
    end
  end
end

-- What is wrong before anything is read.
function M.check(run)
  local o = run.options
  refuse_others(run)
  if not M.wanted(run) then return end
  if not o.input then lapwing.fail(LACKS[sources[run]]) end
  for _, option in ipairs(SIMULATED) do
    if run:stated(option) then
      run:fail(option, string.format("is for a simulated first flight, and a %s takes its place: "
                                     .. "remove it", sources[run]))
    end
  end
  if o.rounds > 1 then
    run:fail("rounds", "rounds after the first need a simulation, and there is only a "
                       .. sources[run])
  end
  local free = o.cloud.free
  if #o.cloud.scanners == 0 and (free == "scanners" or free == "both") then
    run:fail("cloud.free", "'" .. free .. "' needs cloud.scanners")
  end
end

-- What of the data counts: the region, as far as the tour flies around it, and a view beyond.
local function kept(run)
  local o = run.options
  local lower, upper = o.region.lower, o.region.upper
  if #o.regions > 0 then
    -- Their outlines alone: the data may be what their heights are above.
    lower, upper = polygons.across(polygons.prisms(run, "regions", "from", "to", "world"))
  end
  if not (lower and upper) then return nil, nil end
  local beyond = o.reach + 2 * (math.max(o.body[1], o.body[2]) + o.gps_accuracy) + o.mesh_room
  return { lower[1] - beyond, lower[2] - beyond }, { upper[1] + beyond, upper[2] + beyond }
end

local function site_of(run)
  if found[run] then return found[run] end
  local o, source = run.options, sources[run]
  local stated = o[source]
  local lower, upper = kept(run)
  local asked = { file = o.input, option = source, system = stated.system, zero = stated.zero,
                  unit = o.unit, height_unit = stated.height_unit, resolution = resolution.of(run),
                  spacing = o.surface.spacing, lower = lower, upper = upper }
  if source == "cloud" then
    asked.columns, asked.without, asked.scanners = stated.columns, stated.without, stated.scanners
    found[run] = run:read_cloud(asked)
  else
    asked.ground, asked.cell = stated.ground, o.surface.cell
    found[run] = run:read_terrain(asked)
  end
  for _, note in ipairs(found[run].notes) do print("note: " .. note) end
  return found[run]
end

function M.points(run) return site_of(run).points end

-- Whether the data tell the ground beneath buildings and plants.
function M.has_ground(run) return sources[run] == "terrain" and run.options.terrain.ground ~= "" end

-- The lowest and the highest ground within a polygon {x, y, ...}, or nil where none is known.
function M.ground_within(run, corners) return site_of(run):ground_within(corners) end

-- The default region: as far as the data reach, and `moved` metres above and below.
function M.box(run, moved)
  local site = site_of(run)
  local lower, upper = site.lower, site.upper
  return { lower = { lower[1], lower[2], lower[3] - moved },
           upper = { upper[1], upper[2], upper[3] + moved } }
end

local function free_by(run)
  local cloud = run.options.cloud
  if sources[run] ~= "cloud" then return "sky" end
  if cloud.free ~= "auto" then return cloud.free end
  return #cloud.scanners > 0 and "scanners" or "sky"
end

-- Map and mesh of the prior.
function M.add(run, known, safe_height)
  local o, site = run.options, site_of(run)
  if site.upper[3] > safe_height then
    run:fail("safe_height", string.format("the data reach up to %.4g m, above %.4g m from which "
                                          .. "all air is said to be free: raise it",
                                          site.upper[3], safe_height))
  end
  known:add_site { site = site, cell = o.surface.cell, trim = o.surface.trim,
                   method = o.surface.method, free = free_by(run),
                   ceiling = safe_height, range = LONGEST }
end

local RULES = {
  sky = "open sky above the highest voxel of each column that has any",
  scanners = "lines from scanners to points",
  both = "open sky above the highest voxel of each column that has any, and lines from scanners to "
    .. "points",
}

-- Notes of the plan; `views` describes the candidates of the tour.
function M.notes(run, views)
  local site = found[run]
  local under = sources[run] == "terrain" and "; solid: all that is under the surface" or ""
  local notes = { string.format("%s: %s, %s", site.name, site.description, views),
                  "free below safe_height: " .. RULES[free_by(run)] .. under
                    .. "; unknown: all else" }
  for _, note in ipairs(site.notes) do notes[#notes + 1] = note end
  return notes
end

return M
