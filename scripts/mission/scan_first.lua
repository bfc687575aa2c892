-- SPDX-License-Identifier: Apache-2.0
-- The first flight of a scan and its results (thesis 4.3): a map, a mesh, free places. Only the
-- simulator uses the scene itself.
local city = require "mission.scan_city"
local checks = require "mission.scan_first_checks"
local exploration = require "mission.scan_exploration"
local images = require "mission.scan_images"
local meshing = require "mission.scan_meshing"
local patterns = require "mission.scan_patterns"
local site = require "mission.scan_site"
local space = require "mission.scan_space"
local zones = require "mission.scan_zones"

local M = {}

local warnings = setmetatable({}, { __mode = "k" })  -- of runs: what the user should know
local sparse = setmetatable({}, { __mode = "k" })    -- likewise

-- What is wrong before anything is flown.
function M.check(run)
  local o = run.options
  if o.scene and o.input then
    run:fail("input", string.format("a mesh file in place of the scene '%s': give one of them",
                                    o.scene))
  end
  site.check(run)
  city.check(run)
  images.check(run)
  if not o.input and (o.ground or o.unit or o.up ~= "file") then
    run:fail(o.ground and "ground" or o.unit and "unit" or "up",
             "is for the mesh file of input, which is not set (the mesh of a prior "
             .. "is in the frame of its map)")
  end
  checks.prior(run)
  zones.check(run)
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

-- What the user should know of the first flight, or nothing.
function M.warning(run) return warnings[run] end

-- That it has fewer images than overlap wants, or nothing.
function M.sparse(run) return sparse[run] end

-- The camera of depth images that are taken in simulation: the plan's, with fewer pixels where
-- less effort is asked for.
local function depth_camera(run)
  local camera, across = run.options.camera, run.options.effort.pixels
  if across == 0 or across >= camera.width then return camera end
  local share = across / camera.width
  return { width = across, height = math.max(1, math.floor(camera.height * share + 0.5)),
           focal = camera.focal * share }
end

-- Depth images from the poses, into the map and the surface.
function M.look(run, known, surface, poses)
  local o = run.options
  known:look { surface = surface, poses = poses, camera = depth_camera(run),
               range = space.range(run), noise = o.noise }
end

local function new_prior(run)
  local o = run.options
  local map = type(o.map) == "table" and o.map or { type = o.map }
  map.resolution, map.maximum_range = space.resolution(run), space.range(run)
  return run:prior { map = map, spacing = o.surface.spacing, range = space.range(run),
                     stride = o.surface.stride }
end

-- The air that the user says is free: from the safe height up, round the region, the patterns and
-- the box `air`, if there is one.
local function open_air(run, known, surface, poses, air)
  local o, region = run.options, space.region_of(run)
  local margin = zones.body(run)[1] + 1
  local lower = { region.lower[1] - o.reach, region.lower[2] - o.reach, space.safe_height(run) }
  local upper = { region.upper[1] + o.reach, region.upper[2] + o.reach, space.ceiling_of(run) }
  for _, pose in ipairs(poses) do
    for axis = 1, 2 do
      lower[axis] = math.min(lower[axis], pose.position[axis])
      upper[axis] = math.max(upper[axis], pose.position[axis])
    end
  end
  for axis = 1, air and 3 or 0 do
    lower[axis] = math.min(lower[axis], air.lower[axis])
    upper[axis] = math.max(upper[axis], air.upper[axis])
  end
  for axis = 1, 2 do lower[axis], upper[axis] = lower[axis] - margin, upper[axis] + margin end
  upper[3] = upper[3] + zones.body(run)[3]
  known:open_air { lower = lower, upper = upper, surface = surface }
end

-- Where the first flights would take their images.
local function survey_poses(run)
  local poses = {}
  for _, flight in ipairs(space.flights_of(run)) do
    for _, pose in ipairs(space.poses_of(run, flight)) do poses[#poses + 1] = pose end
  end
  return poses
end

-- The prior of a surveyor's data, and places over it, from which candidates grow.
local function surveyed(run, air)
  local known, poses = new_prior(run), zones.allowed(run, survey_poses(run))
  zones.check_home(run, space.room(run, poses), space.safe_height(run))
  run:phase("prior mesh")
  site.add(run, known, space.safe_height(run))
  open_air(run, known, nil, poses, air)
  return known, poses
end

-- What is to be known of a simulated first flight, whether it is flown or was.
function M.remind(run)
  local o, files = run.options, space.prior_files(run)
  if not (o.scene or o.input) or files and #o.flights == 0 then return end
  zones.allowed(run, survey_poses(run))
  if not files then warnings[run] = checks.range(run) end
  sparse[run] = space.sparse(run)
  if sparse[run] then print("note: " .. sparse[run]) end
end

-- For viewers: what the images of a simulated first flight show of the ground.
local function tell(run, poses)
  run:first_flight { poses = poses, camera = run.options.camera, range = space.range(run),
                     level = space.region_of(run).lower[3] }
end

-- Where the first flight would take its images, for an estimate on the map of a plan before.
local function expected(run)
  local o, files = run.options, space.prior_files(run)
  local poses = {}
  if (o.scene or o.input) and not (files and #o.flights == 0) then
    poses = zones.allowed(run, survey_poses(run))
    tell(run, poses)
  end
  zones.check_home(run, space.room(run, poses), space.safe_height(run))
  return poses
end

-- The prior with its mesh, the poses of the first flights, the simulated surface or nil, and the
-- exploration or nil, which has at most `seconds`. `air` is a box that is free above the safe
-- height as well. For an estimate, `before` is the prior of a plan before: then nothing is flown.
function M.knowledge(run, seconds, vehicle, air, before)
  if before then return before, expected(run) end
  local o, files = run.options, space.prior_files(run)
  if site.wanted(run) or images.wanted(run) or exploration.wanted(run)
     or files and #o.flights == 0 then
    -- Where only a first flight is asked for, the plan ends here, before anything takes time.
    run:first_flight { poses = {}, camera = o.camera }
  end
  if site.wanted(run) then return surveyed(run, air) end
  if images.wanted(run) then
    local known, allowed = new_prior(run), space.room(run, {})
    local function open(prior) open_air(run, prior, nil, {}, air) end
    zones.check_home(run, allowed, math.min(space.safe_height(run), allowed.upper[3]))
    local places = images.knowledge(run, known, space.range(run), allowed, o.safe_height and open)
    return known, zones.allowed(run, places)
  end
  local surface = space.surface_of(run)
  if not surface and not files then
    lapwing.fail("no scene: name a scene, a mesh with --set input=PATH (.obj, .ply, .dae, "
                 .. "...), or the files of an earlier flight with prior = { map =, mesh = }")
  end
  if exploration.wanted(run) then
    local known, poses, done = exploration.knowledge(run, surface, space.region_of(run),
                                                     space.room(run, {}), seconds, vehicle)
    return known, poses, surface, done
  end
  local known, poses = new_prior(run), {}
  if surface and not (files and #o.flights == 0) then
    poses = zones.allowed(run, survey_poses(run))
    tell(run, poses)
  end
  zones.check_home(run, space.room(run, poses), space.safe_height(run))
  if files then
    known:load { map = files.map, mesh = files.mesh, camera = depth_camera(run),
                 range = space.range(run) }
  end
  if surface and not (files and #o.flights == 0) then
    M.remind(run)
    run:phase("first flight")
    open_air(run, known, surface, poses, air)
    M.look(run, known, surface, poses)
    run:phase("prior mesh")
    known:reconstruct(meshing(run))
  end
  return known, poses, surface
end

-- Where candidates grow from: where the tour begins, where it ends if that is elsewhere, and what
-- was flown through. With them, the number of the one in which the tour ends.
function M.starts(run, poses)
  local o = run.options
  local starts = {}
  local function looking_in(position)
    return patterns.looking_in(position, space.region_of(run), 0)
  end
  if o.start then starts[1] = looking_in(o.start) end
  for _, pose in ipairs(poses) do starts[#starts + 1] = pose end
  if not o.finish then return starts, 1 end
  table.insert(starts, 2, looking_in(o.finish))
  return starts, 2
end

return M
