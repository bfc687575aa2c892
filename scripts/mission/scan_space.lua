-- SPDX-License-Identifier: Apache-2.0
-- The space of a scan: surface, region of interest, heights and places of its first flights.
local city = require "mission.scan_city"
local exploration = require "mission.scan_exploration"
local images = require "mission.scan_images"
local named_scene = require "mission.named_scene"
local patterns = require "mission.scan_patterns"
local regions = require "mission.scan_regions"
local resolution = require "mission.scan_resolution"
local site = require "mission.scan_site"

local M = {}

local SAFE_ABOVE = 4      -- m of a region, unless said otherwise
local FLIGHT_ABOVE, FLIGHT_ABOVE_ELSE = { crosshatch = 5 }, 15  -- m of the safe height, likewise
local VIEW = 4            -- m from a wall, to look along it, round a mesh's bounds
local DOWN_APART = 0.5    -- heights over the floor, between images that look down
local FEWEST_DOWN, MOST_DOWN, MOST_CROSSED = 6, 200, 400  -- images, unless said otherwise
local RANGE = 60          -- m, where nothing asks for more
local FARTHEST = 200      -- m; farther than that a user says so
local LOOKS_DOWN = 0.5    -- sine of the pitch below the horizon; what looks flatter is no measure
local OVERHEAD = 2        -- m of free air above the highest first flight
local surfaces = setmetatable({}, { __mode = "k" })

-- What the first flight is flown in, or nothing with files of an earlier one.
function M.surface_of(run)
  if surfaces[run] then return surfaces[run] end
  local o = run.options
  local surface
  if o.input and not site.wanted(run) then
    surface = city.wanted(run) and city.read(run)
      or run:read_surface { file = o.input, unit = o.unit, up = o.up }
    if o.ground then surface:add_ground() end
  elseif o.scene then
    surface = run:surface(named_scene(run))
  end
  surfaces[run] = surface
  return surface
end

M.prior_files, M.resolution = resolution.prior_files, resolution.of

-- How far the map and the reconstruction may move a surface up or down.
local function moved(run) return M.resolution(run) + run.options.surface.cell end

-- The default region of a mesh: larger than its bounds, so that its outermost walls belong to the
-- region and are seen from outside, and so do the reconstructed roof and ground.
local function around(run, bounds)
  local o, lower, upper = run.options, {}, {}
  for axis = 1, 3 do
    local more = axis == 3 and moved(run) or math.max(o.body[1], o.body[2]) + o.mesh_room + VIEW
    lower[axis], upper[axis] = bounds.lower[axis] - more, bounds.upper[axis] + more
  end
  return { lower = lower, upper = upper }
end

-- The box of interest: as given, round the regions, the scene's own, or round the mesh.
function M.region_of(run)
  local given = regions.of(run) or run.options.region
  if given.lower and given.upper then return given end
  if given.lower or given.upper then run:fail("region", "expected both lower and upper") end
  if site.wanted(run) then return site.box(run, moved(run)) end
  if images.wanted(run) then return images.region(run) end
  local surface = M.surface_of(run)  -- there is one, or first.check has refused
  return run.options.input and around(run, surface.region) or surface.region
end

-- What the lowest flight is measured from: the region's lower corner as given, or a mesh's lowest.
local function lowest(run)
  local o, region = run.options, M.region_of(run)
  if o.input and not o.region.lower and #o.regions == 0 then return region.lower[3] + moved(run) end
  return region.lower[3]
end

function M.safe_height(run)
  return run.options.safe_height or M.region_of(run).upper[3] + SAFE_ABOVE
end

-- Images that a grid looking down wants.
local function down_wanted(run, height)
  local region = M.region_of(run)
  local area = (region.upper[1] - region.lower[1]) * (region.upper[2] - region.lower[2])
  return math.ceil(area / (DOWN_APART * (height - region.lower[3])) ^ 2)
end

-- As given, or as surveyors fly: a crosshatch for what stands up, and a grid that looks down for
-- roofs, grounds and narrow courts.
function M.flights_of(run)
  local o = run.options
  if #o.flights > 0 then return o.flights end
  local height = M.safe_height(run) + FLIGHT_ABOVE.crosshatch
  local views = math.max(FEWEST_DOWN, math.min(MOST_DOWN, down_wanted(run, height)))
  return { { pattern = "crosshatch", height = height },
           { pattern = "meander", height = height, pitch_deg = -80, reach = 0, views = views } }
end

function M.height_of(run, flight)
  local height = flight.height
    or M.safe_height(run) + (FLIGHT_ABOVE[flight.pattern] or FLIGHT_ABOVE_ELSE)
  if height < M.safe_height(run) then
    run:fail("flights", string.format("a first flight at %.4g m is below safe_height, %.4g m",
                                      height, M.safe_height(run)))
  end
  return height
end

function M.pitch_of(flight)
  return flight.pitch_deg or (flight.pattern == "crosshatch" and -45 or -60)
end

-- Where a first flight takes its images, and how many times farther apart than overlap wants.
function M.poses_of(run, flight)
  local region, height = M.region_of(run), M.height_of(run, flight)
  local hatched = flight.pattern == "crosshatch"
  local reach = flight.reach
    or (hatched and math.min(run.options.reach, (height - region.lower[3]) / 2) or 5)
  local views = flight.views or (hatched and MOST_CROSSED or 30)
  local poses, times = patterns.over(region, flight.pattern, height, views,
                                     math.rad(M.pitch_of(flight)), reach)
  if #poses == 0 then
    run:fail("flights", string.format(
      "no image of the %s shows the region: at a pitch of %.4g degrees and %.4g m "
      .. "above its floor it needs a larger reach", flight.pattern, M.pitch_of(flight),
      height - region.lower[3]))
  end
  if hatched and #poses > views then
    run:fail("flights", string.format("a crosshatch needs at least %d views here, and %d are given"
                                      .. "for", #poses, views))
  end
  return poses, times
end

-- Of runs: ranges, and the metres that images of a tour need.
local ranges, wanted = setmetatable({}, { __mode = "k" }), setmetatable({}, { __mode = "k" })
function M.want_range(run, metres) wanted[run] = math.min(math.ceil(metres), FARTHEST) end

-- How far depth is measured and rays go: as given, else so far that every first flight sees the
-- region's floor in the middle of its images, where that is possible, and as far as is wanted.
function M.range(run)
  if ranges[run] then return ranges[run] end
  local o, range = run.options, run.options.range
  if not range then
    range = images.range(run) or RANGE
    if M.surface_of(run) and not exploration.wanted(run) and not (M.prior_files(run)
                                                                  and #o.flights == 0) then
      local floor = M.region_of(run).lower[3]
      for _, flight in ipairs(M.flights_of(run)) do
        local down = math.sin(math.rad(-M.pitch_of(flight)))
        if down >= LOOKS_DOWN then
          local needed = math.ceil((M.height_of(run, flight) - floor) / down)
          range = math.max(range, math.min(needed, FARTHEST))
        end
      end
    end
    if range > RANGE then
      print(string.format("note: range is %g m, because the first flight sees no floor "
                          .. "within %g m", range, RANGE))
    end
    range = math.max(range, wanted[run] or 0)
  end
  ranges[run] = range
  return range
end

-- The note for a large region with fewer images than overlap needs, or nil. It covers only flights
-- whose number of images the user did not set.
function M.sparse(run)
  local parts = {}
  for _, flight in ipairs(M.flights_of(run)) do
    if flight.pattern == "crosshatch" and not flight.views then
      local poses, times = M.poses_of(run, flight)
      if times > 1.01 then
        parts[#parts + 1] = string.format(
          "the crosshatch has %d images, %.2g times as far apart as overlap needs", #poses, times)
      end
    end
  end
  if #run.options.flights == 0 then
    local down = M.flights_of(run)[2]
    local wanted = down_wanted(run, down.height)
    if wanted > down.views then
      parts[#parts + 1] = string.format("%d images look down in place of %d", down.views, wanted)
    end
  end
  if #parts == 0 then return nil end
  return "the region is large: " .. table.concat(parts, "; ")
         .. ". Flights with more views, or a smaller region, show more of it"
end

-- The highest that anything flies.
function M.ceiling_of(run)
  local given = run.options.ceiling
  local flown = not (M.prior_files(run) or exploration.wanted(run) or images.wanted(run))
  if given and flown and given < M.safe_height(run) then
    run:fail("ceiling", string.format("%.4g m is below safe_height, %.4g m, over which the first "
                                      .. "flight goes", given, M.safe_height(run)))
  end
  if given then return given end
  if images.wanted(run) and not run.options.safe_height then return images.ceiling(run) end
  local ceiling = M.safe_height(run) + OVERHEAD
  if flown then
    for _, flight in ipairs(M.flights_of(run)) do
      ceiling = math.max(ceiling, M.height_of(run, flight) + OVERHEAD)
    end
  end
  return ceiling
end

-- Where the tour may go: round the region and the poses of the first flight.
function M.room(run, poses)
  local o, region = run.options, M.region_of(run)
  local lower, upper = {}, {}
  for axis = 1, 2 do
    lower[axis], upper[axis] = region.lower[axis] - o.reach, region.upper[axis] + o.reach
    for _, pose in ipairs(poses) do
      lower[axis] = math.min(lower[axis], pose.position[axis])
      upper[axis] = math.max(upper[axis], pose.position[axis])
    end
  end
  lower[3], upper[3] = lowest(run) + o.floor, M.ceiling_of(run)
  if lower[3] >= upper[3] then
    run:fail("region", string.format("the tour must fly above %.4g m (region and floor) "
                                     .. "and below %.4g m (ceiling)", lower[3], upper[3]))
  end
  return { lower = lower, upper = upper }
end

return M
