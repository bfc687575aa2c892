-- SPDX-License-Identifier: Apache-2.0
-- Camera shots of designers: JSON with a camera pose and a target point per keyframe.
--
-- lookFromNED and lookAtNED are metres north, east and down of refLLH; a shot without them carries
-- latitude, longitude and altitude, taken from refLLH or else from its first keyframe. The flight
-- ends at the last keyframe. The points looked at are the track of a subject "look-at", straight in
-- between; a vehicle without a gimbal turns its yaw towards them instead.
local shot_file = {}

-- Of a keyframe, as far as they are read; files hold others beside them.
local KEYS = { "cameraPose", "lookAt", "lookAtNED", "lookFromNED" }
local STEEP = 1e-3  -- m, horizontal distance below which a look has no heading

local function number(file, value, path)
  if math.type(value) == nil then file:fail(path, "expected a number") end
  return value
end

-- `path`: of the value, or of what it should be in.
local function table_of(file, value, path, what)
  if type(value) ~= "table" then file:fail(path, what .. " is missing, or not a table") end
  return value
end

local function geodetic(file, value, path, what)
  table_of(file, value, path, what)
  return { lat = number(file, value.lat, path .. ".lat"),
           lon = number(file, value.lng, path .. ".lng"),
           alt = number(file, value.altitude, path .. ".altitude") }
end

-- World position of one point of a keyframe, whose keys are ned and pose: from north, east, down,
-- or from geodetic figures.
local function place(file, origin, entry, path, ned, pose)
  local given = entry[ned]
  if given ~= nil then
    path = path .. "." .. ned
    table_of(file, given, path, ned)
    return { number(file, given.e, path .. ".e"), number(file, given.n, path .. ".n"),
             -number(file, given.d, path .. ".d") }
  end
  if entry[pose] == nil then
    file:fail(path .. "." .. ned, string.format("missing; expected {n, e, d}, or %s", pose))
  end
  return lapwing.local_from_geodetic(origin, geodetic(file, entry[pose], path .. "." .. pose, pose))
end

-- The points looked at as the track of a subject, at rest before the first and after the last.
local function subject_of(track, times)
  if #track == 0 then return {} end
  if track[1].time > times[1] then
    table.insert(track, 1, { time = times[1], position = track[1].position })
  end
  if track[#track].time < times[#times] then
    track[#track + 1] = { time = times[#times], position = track[#track].position }
  end
  if #track == 1 then return { { name = "look-at", position = track[1].position } } end
  return { { name = "look-at", track = track } }
end

-- {keyframes, origin, subjects} of the file that the option `input` names.
function shot_file.read(run)
  local name = run.options.input
  if not name then lapwing.fail("no shot: --set input=PATH") end
  local shot, file = lapwing.read_json(name, "shots")
  file:expect_keys("", { "keyFrameList", "keyframeTimes", "refLLH" }, true)
  local list = table_of(file, shot.keyFrameList, "", "keyFrameList")
  local times = table_of(file, shot.keyframeTimes, "", "keyframeTimes")
  if #list == 0 or #list ~= #times then
    file:fail("keyframeTimes", string.format("%d keyframes, but %d times", #list, #times))
  end
  local origin
  if shot.refLLH then
    origin = geodetic(file, shot.refLLH, "refLLH", "refLLH")
  else
    local first = table_of(file, list[1], "keyFrameList[1]", "keyframe 1")
    local path = "keyFrameList[1].cameraPose"
    origin = geodetic(file, first.cameraPose, path, "keyframe 1: cameraPose")
  end
  local keyframes, track = {}, {}
  local gimbal = run:vehicle(run.options.vehicle).gimbal
  for i, entry in ipairs(list) do
    local path = string.format("keyFrameList[%d]", i)
    table_of(file, entry, path, "keyframe " .. i)
    file:expect_keys(path, KEYS, true)
    local from = place(file, origin, entry, path, "lookFromNED", "cameraPose")
    local time = number(file, times[i], string.format("keyframeTimes[%d]", i))
    local keyframe = { time = time, position = from }
    if entry.lookAtNED or entry.lookAt then
      local at = place(file, origin, entry, path, "lookAtNED", "lookAt")
      track[#track + 1] = { time = keyframe.time, position = at }
      local east, north = at[1] - from[1], at[2] - from[2]
      if not gimbal and east ^ 2 + north ^ 2 > STEEP ^ 2 then
        keyframe.yaw_deg = math.deg(math.atan(north, east))
      end
    end
    keyframes[i] = keyframe
  end
  return { keyframes = keyframes, origin = origin, subjects = gimbal and subject_of(track, times) }
end

return shot_file
