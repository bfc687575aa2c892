-- Camera shots as designers draw them: JSON with a camera pose and a point looked at per keyframe.
--
-- lookFromNED and lookAtNED are metres north, east and down of refLLH; a shot without them carries
-- latitude, longitude and altitude, taken from refLLH or else from its first keyframe. The flight
-- ends at the last keyframe. The points looked at are the track of a subject "look-at", straight in
-- between; a vehicle without a gimbal turns its yaw towards them instead.
local shot_file = {}

local STEEP = 1e-3  -- m, horizontal distance below which a look has no heading

local function number(run, value, what)
  if math.type(value) == nil then run:fail("input", what .. ": expected a number") end
  return value
end

local function table_of(run, value, what)
  if type(value) ~= "table" then run:fail("input", what .. " is missing") end
  return value
end

local function geodetic(run, value, what)
  table_of(run, value, what)
  return { lat = number(run, value.lat, what .. ".lat"),
           lon = number(run, value.lng, what .. ".lng"),
           alt = number(run, value.altitude, what .. ".altitude") }
end

-- World position of one point of a keyframe: from north, east, down, or from geodetic figures.
local function place(run, origin, ned, pose, what)
  if ned then
    return { number(run, ned.e, what .. ".e"), number(run, ned.n, what .. ".n"),
             -number(run, ned.d, what .. ".d") }
  end
  return lapwing.local_from_geodetic(origin, geodetic(run, pose, what))
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
  if not name then lapwing.fail("give the shot to fly: --set input=PATH") end
  local shot = lapwing.read_json(name, "shots")
  local list = table_of(run, shot.keyFrameList, name .. ": keyFrameList")
  local times = table_of(run, shot.keyframeTimes, name .. ": keyframeTimes")
  if #list == 0 or #list ~= #times then
    run:fail("input", string.format("%s: %d keyframes, but %d times", name, #list, #times))
  end
  local origin
  if shot.refLLH then
    origin = geodetic(run, shot.refLLH, name .. ": refLLH")
  else
    origin = geodetic(run, table_of(run, list[1], name .. ": keyframe 1").cameraPose,
                      name .. ": keyframe 1: cameraPose")
  end
  local keyframes, track = {}, {}
  local gimbal = run:vehicle(run.options.vehicle).gimbal
  for i, entry in ipairs(list) do
    local what = string.format("%s: keyframe %d", name, i)
    local from = place(run, origin, entry.lookFromNED, entry.cameraPose, what .. ": lookFrom")
    local keyframe = { time = number(run, times[i], what .. ": time"), position = from }
    if entry.lookAtNED or entry.lookAt then
      local at = place(run, origin, entry.lookAtNED, entry.lookAt, what .. ": lookAt")
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
