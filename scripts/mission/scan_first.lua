-- The first flight of a scan, and what is known after it (thesis 4.3): a map, a mesh, places that
-- are free. What was flown in is asked by the simulator alone.
local named_scene = require "mission.named_scene"
local exploration = require "mission.scan_exploration"
local patterns = require "mission.scan_patterns"

local M = {}

local SAFE_ABOVE = 4      -- m of a region, unless said otherwise
local FLIGHT_ABOVE = 15   -- m of the safe height, likewise
local OVERHEAD = 2        -- m of free air above the highest first flight

local surfaces = setmetatable({}, { __mode = "k" })  -- of runs
local warnings = setmetatable({}, { __mode = "k" })  -- likewise, what the user should know

-- What the first flight is flown in, or nothing with files of an earlier one.
local function surface_of(run)
  if surfaces[run] then return surfaces[run] end
  local o = run.options
  local surface
  if o.input then
    surface = run:read_surface { file = o.input, unit = o.unit, up = o.up }
    if o.ground then surface:add_ground() end
  elseif o.scene then
    surface = run:surface(named_scene(run))
  end
  surfaces[run] = surface
  return surface
end

local function prior_files(run)
  local files = run.options.prior
  if not files.map and not files.mesh then return nil end
  if not (files.map and files.mesh) then
    run:fail("prior", "expected both a map and a mesh of an earlier flight")
  end
  return files
end

-- The box of interest: as given, or the scene's own.
function M.region_of(run)
  local given = run.options.region
  if given.lower and given.upper then return given end
  if given.lower or given.upper then run:fail("region", "expected both lower and upper") end
  local surface = surface_of(run)
  if not surface then
    run:fail("region", "files of an earlier flight do not say which region is of interest: give "
                       .. "region = { lower = {x, y, z}, upper = {x, y, z} }")
  end
  return surface.region
end

local function safe_height(run)
  return run.options.safe_height or M.region_of(run).upper[3] + SAFE_ABOVE
end

local function flights_of(run)
  local o = run.options
  if #o.flights > 0 then return o.flights end
  return { { pattern = "meander", views = 30, pitch_deg = -60, reach = 5 } }
end

local function height_of(run, flight)
  local height = flight.height or safe_height(run) + FLIGHT_ABOVE
  if height < safe_height(run) then
    run:fail("flights", string.format("a first flight at %.4g m is below safe_height, %.4g m",
                                      height, safe_height(run)))
  end
  return height
end

-- The highest that anything flies.
local function ceiling_of(run)
  local given = run.options.ceiling
  local flown = not prior_files(run) and not exploration.wanted(run)  -- over the safe height
  if given and flown and given < safe_height(run) then
    run:fail("ceiling", string.format("%.4g m is below safe_height, %.4g m, over which the first "
                                      .. "flight goes", given, safe_height(run)))
  end
  if given then return given end
  local ceiling = safe_height(run) + OVERHEAD
  if flown then
    for _, flight in ipairs(flights_of(run)) do
      ceiling = math.max(ceiling, height_of(run, flight) + OVERHEAD)
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
  lower[3], upper[3] = region.lower[3] + o.floor, ceiling_of(run)
  if lower[3] >= upper[3] then
    run:fail("region", string.format("the tour would have to fly over %.4g m (region and floor) "
                                     .. "and below %.4g m (ceiling)", lower[3], upper[3]))
  end
  return { lower = lower, upper = upper }
end

-- What is wrong before anything is flown.
function M.check(run)
  local o = run.options
  if o.scene and o.input then
    run:fail("input", string.format("a mesh file in place of the scene '%s': give one of them",
                                    o.scene))
  end
  if not o.input and (o.ground or o.unit or o.up ~= "file") then
    run:fail(o.ground and "ground" or o.unit and "unit" or "up",
             "is of an input, a mesh file to be flown over, and there is none (a prior's mesh is "
             .. "in its map's frame)")
  end
  local region = o.region
  if region.lower and region.upper then
    for axis = 1, 3 do
      if not (region.lower[axis] < region.upper[axis]) then
        run:fail("region", string.format("lower must be below upper: %.6g and %.6g along %s",
                                         region.lower[axis], region.upper[axis],
                                         ("xyz"):sub(axis, axis)))
      end
    end
  end
end

-- How far the ground may be seen: some first flight must see the region's upper side at the
-- steepest of its images; where none sees the floor that is said, for nothing down there will be
-- known.
local function check_range(run)
  local o, region = run.options, M.region_of(run)
  local half = math.atan(o.camera.height / 2, o.camera.focal)
  local function nearest(z)
    local least = math.huge
    for _, flight in ipairs(flights_of(run)) do
      local steepest = math.min(math.pi / 2, half - math.rad(flight.pitch_deg))
      if steepest > 0 then
        least = math.min(least, (height_of(run, flight) - z) / math.sin(steepest))
      end
    end
    return least
  end
  local cure = "a longer range, steeper images (flights, pitch_deg) or a lower safe_height"
  local floor, upper = nearest(region.lower[3]), nearest(region.upper[3])
  if upper > o.range then
    run:fail("range", string.format(
      "no first flight would see anything of the region: to its upper side the shortest ray is "
      .. "%.4g m long, and depth is measured to %g m; %s would help", upper, o.range, cure))
  end
  if floor <= o.range then return nil end
  local warning = string.format(
    "no first flight sees the region's floor: the shortest ray is %.4g m long, and depth is "
    .. "measured to %g m; %s would show it", floor, o.range, cure)
  print("warning: " .. warning)
  return warning
end

-- What the user should know of the first flight, or nothing.
function M.warning(run) return warnings[run] end

-- Depth images from the poses, into the map and the surface.
function M.look(run, known, surface, poses)
  local o = run.options
  known:look { surface = surface, poses = poses, camera = o.camera, range = o.range,
               noise = o.noise }
end

local function new_prior(run)
  local o = run.options
  local map = type(o.map) == "table" and o.map or { type = o.map }
  map.resolution, map.maximum_range = o.resolution, o.range
  return run:prior { map = map, spacing = o.surface.spacing, range = o.range,
                     stride = o.surface.stride }
end

-- The air that the user says is free: from the safe height up, round the region and the patterns.
local function open_air(run, known, surface, poses)
  local o, region = run.options, M.region_of(run)
  local margin = o.body[1] + 1
  local lower = { region.lower[1] - o.reach, region.lower[2] - o.reach, safe_height(run) }
  local upper = { region.upper[1] + o.reach, region.upper[2] + o.reach, ceiling_of(run) }
  for _, pose in ipairs(poses) do
    for axis = 1, 2 do
      lower[axis] = math.min(lower[axis], pose.position[axis])
      upper[axis] = math.max(upper[axis], pose.position[axis])
    end
  end
  for axis = 1, 2 do lower[axis], upper[axis] = lower[axis] - margin, upper[axis] + margin end
  upper[3] = upper[3] + o.body[3]
  known:open_air { lower = lower, upper = upper, surface = surface }
end

-- What is known (a prior with its mesh), the poses of the first flights, what they were flown in,
-- if anything, and the vehicle's exploration, if there was one, which has so many seconds.
function M.knowledge(run, seconds, vehicle)
  local o = run.options
  local files, surface = prior_files(run), surface_of(run)
  if not surface and not files then
    lapwing.fail("nothing to scan: name a scene, a mesh with --set input=PATH (.obj, .ply, .dae, "
                 .. "...), or the files of an earlier flight with prior = { map =, mesh = }")
  end
  if exploration.wanted(run) then
    local known, poses, done = exploration.knowledge(run, surface, M.region_of(run),
                                                     M.room(run, {}), seconds, vehicle)
    return known, poses, surface, done
  end
  local known, poses = new_prior(run), {}
  if files then known:load { map = files.map, mesh = files.mesh } end
  if surface and not (files and #o.flights == 0) then
    if not files then warnings[run] = check_range(run) end
    for _, flight in ipairs(flights_of(run)) do
      local made = patterns.over(M.region_of(run), flight.pattern, height_of(run, flight),
                                 flight.views, math.rad(flight.pitch_deg), flight.reach)
      for _, pose in ipairs(made) do poses[#poses + 1] = pose end
    end
    open_air(run, known, surface, poses)
    M.look(run, known, surface, poses)
    known:reconstruct { cell = o.surface.cell, trim = o.surface.trim }
  end
  return known, poses, surface
end

-- Where candidates grow from: where the tour begins, where it ends if that is elsewhere, and what
-- was flown through. With them, the number of the one in which the tour ends.
function M.starts(run, poses)
  local o = run.options
  local starts = {}
  local function looking_in(position)
    return patterns.looking_in(position, M.region_of(run), 0)
  end
  if o.start then starts[1] = looking_in(o.start) end
  for _, pose in ipairs(poses) do starts[#starts + 1] = pose end
  if #starts == 0 then
    run:fail("start", "with files of an earlier flight alone, say where the tour begins")
  end
  if not o.finish then return starts, 1 end
  table.insert(starts, 2, looking_in(o.finish))
  return starts, 2
end

return M
