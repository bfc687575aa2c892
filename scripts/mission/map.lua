-- SPDX-License-Identifier: Apache-2.0
-- Maps of depth images, of views of a scene, or of map files.
--
--   local map = require "mission.map"
--   return map.of_scene { name = "street", scene = "street" }
--   return map.of_folder { name = "my depth" }       -- --set input=FOLDER
--   return map.of_file { name = "my map" }           -- --set input=FILE
--
-- Missions of kind `map` return a map instead of a plan. The parameters that all map plugins share
-- are options of the mission (`resolution`, `mode`, `pixel_step`, `observations`). `map` selects
-- the plugin only: `--set map=octomap` changes speed and memory, not the map.
local depth_sensor = require "mission.depth_sensor"
local mission_of = require "mission.mission_of"
local named_scene = require "mission.named_scene"
local views = require "mission.views"

local M = {}

local MODEL = { name = "model", type = "text", refused = "a map is made of depth images, and "
  .. "nothing flies; a scan (examples/scan) or a film flies with a model" }
local SHARED = {  -- as the backends' own defaults
  { name = "resolution", type = "number", unit = "m", default = 0.2, minimum = 0.001,
    maximum = 100, summary = "edge of a voxel" },
  { name = "mode", type = "choice", choices = { "discretised", "exact" }, default = "discretised",
    summary = "one ray per voxel that contains a point, or one per point" },
  { name = "pixel_step", type = "integer", default = 1, minimum = 1, maximum = 64,
    summary = "use every n-th pixel of every n-th row" },
  { name = "observations", type = "boolean", default = false,
    summary = "count the measurements of each voxel, for its uncertainty" },
}
-- Options of the mission that are parameters of every backend: `map.resolution` is an error.
local SCANS = { resolution = "it is an option of the mission: set resolution instead",
                mode = "it is an option of the mission: set mode instead",
                pixel_step = "it is an option of the mission: set pixel_step instead",
                observations = "it is an option of the mission: set observations instead" }

local function settled_with(list, key, why)
  local all = { [key] = why }
  for name, reason in pairs(list) do all[name] = reason end
  return all
end

local function map_with(settled)
  return { name = "map", type = "plugin", kind = "map", default = "brick", settled = settled,
           summary = "map plugin and its update rule" }
end
local INPUT = { name = "input", type = "text", summary = "file or folder to read" }

local FOLDER = { INPUT, {
  name = "range", type = "number", unit = "m", minimum = 0.01, maximum = 1000,
  summary = "range beyond which a ray clears voxels and adds no hit; absent: none" } }

local width, height, view_deg = depth_sensor.image(10000)
local SENSOR = { width, height, view_deg, depth_sensor.depth(0.01) }

local function declarations(map, ...)
  local all = { map, MODEL }
  for _, list in ipairs { ... } do
    for _, declared in ipairs(list) do all[#all + 1] = declared end
  end
  return all
end

-- The map that the options ask for, with what the mission itself knows.
local function new_map(run, known)
  local o = run.options
  local made = type(o.map) == "table" and o.map or { type = o.map }
  for _, shared in ipairs(SHARED) do
    if o[shared.name] ~= nil then made[shared.name] = o[shared.name] end
  end
  for key, value in pairs(known) do made[key] = value end
  return run:map(made)
end

local function missing_input(what, example)
  return string.format("%s is missing: --set input=PATH (%s)", what, example)
end

-- Views of a scene that scripts/scene makes, from a flight over and through it.
---@param given lapwing.map.of_scene
---@return lapwing.mission
function M.of_scene(given)
  local own = {
    { name = "scene", type = "text", summary = "scene of scripts/scene: street, suburb, ..." },
    { name = "scene_seed", type = "integer", default = 1, minimum = 0, maximum = 9007199254740991,
      summary = "seed of the scene" },
    { name = "sensor", type = "table", table = SENSOR, summary = "depth camera" },
    { name = "views", type = "integer", default = 400, minimum = 1, maximum = 100000,
      summary = "number of images" },
  }
  local declared = declarations(
    map_with(settled_with(SCANS, "maximum_range",
                          "the sensor has it: set sensor.range instead")), SHARED, own)
  return mission_of("map", declared, given, function(run)
    local o = run.options
    local scene = named_scene(run)
    local surface = run:surface(scene)
    local made = new_map(run, { maximum_range = o.sensor.range })
    made:scan {
      surface = surface,
      poses = views.over(surface, o.views),
      range = o.sensor.range,
      camera = { width = o.sensor.width, height = o.sensor.height,
                 view_deg = o.sensor.view_deg },
      noise = { dropped = o.sensor.dropped, sigma = o.sensor.sigma },
    }
    return made
  end)
end

-- Depth images with poses: a folder of NAME.depth.png, NAME.pose.txt and camera-intrinsics.txt.
---@param given lapwing.map.of_folder
---@return lapwing.mission
function M.of_folder(given)
  local declared = declarations(
    map_with(settled_with(SCANS, "maximum_range", "set range instead")), SHARED, FOLDER)
  return mission_of("map", declared, given, function(run)
    local o = run.options
    if not o.input then
      lapwing.fail(missing_input("a folder of depth images", "NAME.depth.png, NAME.pose.txt"))
    end
    local made = new_map(run, { maximum_range = o.range })
    made:scan_folder(o.input)
    return made
  end)
end

-- A map file: .bt or .ot. The edge of its voxels is the file's.
---@param given lapwing.map.of_file
---@return lapwing.mission
function M.of_file(given)
  local declared = declarations(map_with {
    resolution = "the file determines it",
    mode = "a file is read, not scanned", pixel_step = "a file is read, not scanned",
    maximum_range = "a file is read, not scanned" }, { INPUT })
  return mission_of("map", declared, given, function(run)
    local o = run.options
    if not o.input then lapwing.fail(missing_input("a map", ".bt or .ot")) end
    local made = new_map(run, { resolution = run:map_resolution(o.input) })
    made:load(o.input)
    return made
  end)
end

return M
