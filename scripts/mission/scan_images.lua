-- SPDX-License-Identifier: Apache-2.0
-- Scans whose first flight was real: depth images with poses, or a COLMAP model, in place of a
-- simulated flight. What they measured becomes map and mesh by the same code.
local meshing = require "mission.scan_meshing"

local M = {}

local PER_VOXEL = 40          -- voxels that the median depth has, where no resolution is stated
local FINEST, COARSEST = 0.01, 0.2  -- m, of those
local FARTHEST = 60           -- m of depth, unless said otherwise
local MOST_STARTS = 1500      -- places that are tried
local STEPS = 12              -- of them before each image at most
local FITS = 3                -- bodies side by side that the shorter side of what is seen must hold

-- Of a folder of depth images.
M.FOLDER = { name = "folder", type = "text",
             summary = "folder of the images, in place of a first flight" }
M.DEPTH = { name = "images", type = "table", summary = "layout of a folder of depth images",
            table = {
  { name = "depth", type = "text", default = "*.depth.png",
    summary = "names of the depth images, 16-bit PNG; 0 and 65535 are no measurement" },
  { name = "pose", type = "text", default = "*.pose.txt",
    summary = "names of the poses, 4 x 4 numbers; the same `*`" },
  { name = "intrinsics", type = "text", default = "camera-intrinsics.txt",
    summary = "file of the camera: fx 0 cx, 0 fy cy, 0 0 1" },
  { name = "camera", type = "numbers", size = 4, unit = "px",
    summary = "fx, fy, cx, cy in place of that file" },
  { name = "unit", type = "number", unit = "m", default = 0.001, above = 0, maximum = 1,
    summary = "metres that 1 in a depth image is" },
  { name = "poses_to_camera", type = "boolean", default = false,
    summary = "poses take the world to the camera; false: the camera to the world" },
  { name = "up", type = "numbers", size = 3,
    summary = "direction in the world of the poses that points up; absent: z if cameras and level "
    .. "surfaces agree with it within 10 degrees, else their direction" } } }

-- Of a COLMAP model.
M.COLMAP = { name = "colmap", type = "table", summary = "scale and place of a COLMAP model: one of "
             .. "photos, distances and scale", table = {
  { name = "photos", type = "text",
    summary = "folder of the photographs, with GPS positions in their EXIF data" },
  { name = "gps_accuracy", type = "number", unit = "m", default = 5, above = 0, maximum = 1000,
    summary = "accuracy of these positions; photographs three times farther off are left out" },
  { name = "distances", type = "tables", summary = "measured distances", table = {
    { name = "from_image", type = "text", summary = "name of the image at one end" },
    { name = "to_image", type = "text", summary = "name of the image at the other end" },
    { name = "from", type = "numbers", size = 3, summary = "one end in the model's coordinates" },
    { name = "to", type = "numbers", size = 3, summary = "the other end in these" },
    { name = "metres", type = "number", unit = "m", required = true, above = 0,
      summary = "distance of the ends" } } },
  { name = "scale", type = "number", unit = "m", above = 0,
    summary = "metres per unit of the model" },
  { name = "up", type = "numbers", size = 3,
    summary = "direction in the model that points up; absent: estimated, or by GPS" } } }

local sources = setmetatable({}, { __mode = "k" })  -- of runs: how their images are read
local read = setmetatable({}, { __mode = "k" })     -- of runs

-- The declarations of a function whose first flight was real.
function M.declarations(common, own)
  local all = { M.FOLDER, own }
  return table.move(common, 1, #common, 3, all)
end

-- The run reads its images by `reader(run)`, which returns lapwing.flight_images.
function M.expect(run, reader) sources[run] = reader end

function M.wanted(run) return sources[run] ~= nil end

-- The images of a folder of depth images.
function M.depth_images(run)
  local o = run.options.images
  return run:read_depth_images { folder = run.options.folder, depth = o.depth, pose = o.pose,
                                 intrinsics = o.intrinsics, camera = o.camera, unit = o.unit,
                                 poses_to_camera = o.poses_to_camera, up = o.up }
end

-- The images of a COLMAP model.
function M.colmap(run)
  local o = run.options.colmap
  return run:read_colmap { folder = run.options.folder, photos = o.photos,
                           gps_accuracy = o.gps_accuracy, distances = o.distances,
                           scale = o.scale, up = o.up, spacing = run.options.surface.spacing }
end

function M.of(run)
  if not read[run] then
    if not run.options.folder then
      run:fail("folder", "the folder of the images is missing: --set folder=PATH")
    end
    read[run] = sources[run](run)
    for _, note in ipairs(read[run].notes) do print("note: " .. note) end
  end
  return read[run]
end

-- What cannot be had together with images of a real flight, and a body that has no room.
function M.check(run)
  if not M.wanted(run) then return end
  local o = run.options
  local simulated = o.scene and "scene" or o.input and "input" or o.prior.map and "prior"
    or #o.flights > 0 and "flights" or o.exploration.images > 0 and "exploration"
  if simulated then
    run:fail(simulated, "the images of the folder are the first flight: leave this out")
  end
  local images, edge = M.of(run), 2 * math.max(o.body[1], o.body[2])
  local across = math.min(images.upper[1] - images.lower[1], images.upper[2] - images.lower[2])
  if FITS * edge > across then
    run:fail("body", string.format(
      "the images show a place that is %.3g m across, which has no room for views of a vehicle of "
      .. "%.3g m: use --config scan/room for a small vehicle in a room, or a smaller body", across,
      edge))
  end
end

local function nice(value)
  local power = 10 ^ math.floor(math.log(value, 10) + 1e-9)
  for _, step in ipairs { 5, 2, 1 } do
    if value >= step * power * (1 - 1e-9) then return step * power end
  end
end

-- The edge of a voxel: the largest of 1, 2, 5, 10 ... cm of which the median depth has enough.
function M.resolution(run)
  if not M.wanted(run) then return nil end
  return math.max(FINEST, math.min(COARSEST, nice(M.of(run).median_depth / PER_VOXEL)))
end

-- The box of what the images measured, to whole voxels.
function M.region(run)
  local images, edge = M.of(run), run.options.resolution or M.resolution(run)
  local region = { lower = {}, upper = {} }
  for axis = 1, 3 do
    region.lower[axis] = edge * math.floor(images.lower[axis] / edge)
    region.upper[axis] = edge * math.ceil(images.upper[axis] / edge)
  end
  return region
end

-- Depth that is used: nearly all of it.
function M.range(run)
  if not M.wanted(run) then return nil end
  return math.min(FARTHEST, math.ceil(2 * M.of(run).far_depth) / 2)
end

-- The highest that the tour flies, unless said otherwise: as high as the cameras or what they saw.
function M.ceiling(run)
  return math.max(M.of(run).upper[3], M.of(run).camera_upper[3])
end

-- Views before the cameras, where the images measured free space for the vehicle.
local function starts(run, known, allowed)
  local o, images = run.options, M.of(run)
  local views = images.views
  local every = math.max(1, math.ceil(#views * STEPS / MOST_STARTS))
  local step = math.max(images.median_depth / STEPS, M.resolution(run))
  local places = {}
  for k = 1, #views, every do
    local view = views[k]
    local ahead = { math.cos(view.pitch) * math.cos(view.yaw),
                    math.cos(view.pitch) * math.sin(view.yaw), math.sin(view.pitch) }
    for far = 0, STEPS - 1 do
      local position = {}
      for axis = 1, 3 do position[axis] = view.position[axis] + far * step * ahead[axis] end
      places[#places + 1] = { position = position, yaw = view.yaw, pitch = math.min(0, view.pitch) }
    end
  end
  local free = {}
  for _, number in ipairs(known:free_views { views = places, body = o.body,
                                             mesh_room = o.mesh_room, allowed = allowed }) do
    free[#free + 1] = places[number]
  end
  if #free == 0 and not o.start then
    run:fail("body", string.format(
      "none of %d places before the cameras has room for a box of %.3g x %.3g x %.3g m and %.3g m "
      .. "from the mesh: only what the images saw is free. Choose a smaller body, mesh_room or "
      .. "resolution, a safe_height above which the air is free, or take more images", #places,
      2 * o.body[1], 2 * o.body[2], 2 * o.body[3], o.mesh_room))
  end
  return free
end

-- Integrates the images into an empty prior, makes its mesh, and returns where candidates grow
-- from. `open_air(known)` adds the air that the user says is free.
function M.knowledge(run, known, range, allowed, open_air)
  local o = run.options
  run:phase("images")
  if open_air then open_air(known) end
  known:take_images { images = M.of(run), range = range }
  run:phase("prior mesh")
  known:reconstruct(meshing(run))
  return starts(run, known, allowed)
end

-- For the notes of the plan.
function M.notes(run, views)
  local images = M.of(run)
  local notes = { string.format(
    "%d images of '%s' in place of a first flight, median depth %.3g m, voxels of %.3g m; %s",
    images.images, images.name, images.median_depth, run.options.resolution or M.resolution(run),
    views) }
  return table.move(images.notes, 1, #images.notes, 2, notes)
end

return M
