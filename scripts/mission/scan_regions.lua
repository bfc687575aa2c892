-- SPDX-License-Identifier: Apache-2.0
-- Regions of interest as polygons on the ground with heights, weights and holes, and what the
-- heights of polygons are above.
local polygons = require "mission.scan_polygons"
local site = require "mission.scan_site"

local M = {}

local SAME = 1e-3  -- m, between two statements of one height
local RELIEF = 1   -- m within an outline, above which a note tells it

M.DECLARATIONS = {
  { name = "regions", type = "tables", summary = "regions of interest as prisms over polygons, in "
    .. "place of region", table = polygons.polygon {
    { name = "holes", type = "tables", summary = "polygons that do not belong to it",
      table = polygons.CORNERS },
    { name = "from", type = "number", unit = "m", minimum = -1e5, maximum = 1e5,
      summary = "lower end; a file may state its own" },
    { name = "to", type = "number", unit = "m", minimum = -1e5, maximum = 1e5,
      summary = "upper end; a file may state its own" },
    { name = "weight", type = "number", above = 0, maximum = 1e6,
      summary = "what its surface counts beside that of other regions; a file may state its own; "
        .. "absent: 1" } } },
  { name = "coordinates", type = "text", default = "",
    summary = "reference system of `corners` and of GeoJSON files, as EPSG:28992; empty: metres "
      .. "in the world, and WGS 84 in files" },
  { name = "heights", type = "choice", default = "unstated",
    choices = { "unstated", "world", "ground", "sea", "ellipsoid" },
    summary = "what from, to, floor and ceiling are above; unstated: the world's origin, for "
      .. "corners in metres only" },
  { name = "ground_level", type = "number", unit = "m", minimum = -1e5, maximum = 1e5,
    summary = "height of level ground in the world, for heights above the ground; absent: the "
      .. "terrain (terrain.ground), or the ground of an origin whose height is above the ground" },
}

-- The height of level ground in the world, for heights above the ground; nil: not known, or not
-- asked for.
local function ground_level(run)
  local o = run.options
  if o.heights ~= "ground" then
    if o.ground_level then
      run:fail("ground_level", "is for heights above the ground: state heights = \"ground\", or "
                               .. "remove it")
    end
    return nil
  end
  local origin = o.origin.height_of == "ground" and o.origin.height and -o.origin.height
  local stated = o.ground_level
  if stated and site.has_ground(run) then
    run:fail("ground_level", "the terrain (terrain.ground) states the ground as well: remove one")
  end
  if stated and origin and math.abs(stated - origin) > SAME then
    run:fail("ground_level", string.format(
      "%.6g m, and origin.height says that the ground is at %.6g m: both must agree", stated,
      origin))
  end
  return stated or origin or nil
end

local notes = setmetatable({}, { __mode = "k" })  -- of runs

-- What the ground does within zones and regions, where it matters.
function M.notes(run) return notes[run] or {} end

-- A polygon's ends, stated above the terrain. A zone holds whatever the ground does within its
-- outline: closed airspace and regions reach from the lowest ground to the highest one, airspace
-- that must not be left ends at what all of its ground allows.
local function over_terrain(run, option, number, prism, inner)
  local path = string.format("%s[%d]", option, number)
  local what = prism.name ~= "" and "'" .. prism.name .. "': " or ""
  if not (prism.low or prism.high) then return end
  local lowest, highest = site.ground_within(run, prism.corners)
  if not lowest then
    run:fail(path, what .. "its heights are above the ground, and terrain.ground knows no ground "
                   .. "within it")
  end
  if highest - lowest > RELIEF then
    notes[run] = notes[run] or {}
    table.insert(notes[run], string.format(
      "%s%s: the ground within it lies between %.4g and %.4g m, and its heights are above %s of it",
      path, prism.name ~= "" and " '" .. prism.name .. "'" or "", lowest, highest,
      inner and "all" or "the lowest and the highest part"))
  end
  if inner then lowest, highest = highest, lowest end
  prism.low, prism.high = prism.low and prism.low + lowest, prism.high and prism.high + highest
  if prism.low and prism.high and prism.low >= prism.high then
    run:fail(path, string.format("%sthe ground within it rises by %.4g m, more than is between its "
                                 .. "floor and its ceiling: state parts of it", what,
                                 lowest - highest))
  end
end

-- The prisms of all entries of an option, and the numbers of these entries. `inner`: of airspace
-- that must not be left.
function M.prisms(run, option, low, high, inner)
  local level = ground_level(run)
  if run.options.heights ~= "ground" or not site.has_ground(run) then
    return polygons.prisms(run, option, low, high, run.options.heights, level)
  end
  local prisms, numbers = polygons.prisms(run, option, low, high, "world")
  for k, prism in ipairs(prisms) do over_terrain(run, option, numbers[k], prism, inner) end
  return prisms, numbers
end

local found = setmetatable({}, { __mode = "k" })  -- of runs

-- {lower, upper, prisms}, or nil where no regions are stated.
function M.of(run)
  local o = run.options
  if #o.regions == 0 then return nil end
  if found[run] then return found[run] end
  if o.region.lower or o.region.upper then
    run:fail("regions", "a region is stated as well: give one of them")
  end
  local prisms, numbers = M.prisms(run, "regions", "from", "to")
  local lower, upper = polygons.across(prisms)
  lower[3], upper[3] = math.huge, -math.huge
  for k, prism in ipairs(prisms) do
    if not (prism.low and prism.high) then
      run:fail(string.format("regions[%d]", numbers[k]), string.format(
        "%s%s missing: a region ends below and above",
        prism.name ~= "" and "'" .. prism.name .. "': " or "",
        prism.low and "to is" or prism.high and "from is" or "from and to are"))
    end
    lower[3], upper[3] = math.min(lower[3], prism.low), math.max(upper[3], prism.high)
  end
  found[run] = { lower = lower, upper = upper, prisms = prisms }
  return found[run]
end

return M
