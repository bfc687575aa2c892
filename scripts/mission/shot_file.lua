-- Camera shots as designers draw them: JSON with a camera pose and a point looked at per keyframe.
--
-- lookFromNED and lookAtNED are metres north, east and down of refLLH; a shot without them carries
-- latitude, longitude and altitude, taken from refLLH or else from its first keyframe. The flight
-- ends at the last keyframe. Yaw follows the direction of the look where that has one.
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

-- {keyframes, origin} of the file that the option `input` names.
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
  local keyframes = {}
  for i, entry in ipairs(list) do
    local what = string.format("%s: keyframe %d", name, i)
    local from = place(run, origin, entry.lookFromNED, entry.cameraPose, what .. ": lookFrom")
    local keyframe = { time = number(run, times[i], what .. ": time"), position = from }
    if entry.lookAtNED or entry.lookAt then
      local at = place(run, origin, entry.lookAtNED, entry.lookAt, what .. ": lookAt")
      local east, north = at[1] - from[1], at[2] - from[2]
      if east ^ 2 + north ^ 2 > STEEP ^ 2 then
        keyframe.yaw_deg = math.deg(math.atan(north, east))
      end
    end
    keyframes[i] = keyframe
  end
  return { keyframes = keyframes, origin = origin }
end

return shot_file
