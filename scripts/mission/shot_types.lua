-- SPDX-License-Identifier: Apache-2.0
-- Named shots: the camera moves of film crews, as keyframes.
--
-- Each takes a table and gives keyframes for film.shot, in time from `start` (0) over `duration`
-- seconds; several can be joined with shots.sequence. Places are in m, world; angles in degrees, 0
-- east, counter-clockwise. The arguments are declared below, like options of missions. The table of
-- the README and the annotations for editors are generated from these declarations.
--
--   keyframes = shots.orbit { center = {0, 0, 2}, radius = 12, height = 6, duration = 20 }
---@type lapwing.film.shots
local shots = {}

local ORBIT_SPACING = 5  -- deg of an orbit between two keyframes, at most

-- ---- what they take ---------------------------------------------------------------------

local function place(name, summary)
  return { name = name, type = "numbers", size = 3, unit = "m", required = true, minimum = -1e6,
           maximum = 1e6, summary = summary }
end
local function look(name, required, summary)
  return { name = name, type = "numbers", size = 3, unit = "m", required = required,
           minimum = -1e6, maximum = 1e6, also = "string", summary = summary }
end
local common = {
  { name = "duration", type = "number", unit = "s", required = true, above = 0, maximum = 1e5,
    summary = "duration of the shot" },
  { name = "start", type = "number", unit = "s", default = 0, minimum = 0, maximum = 1e5,
    summary = "start of the shot" },
  look("look_at", false, "target of the camera: a point, or the name of a subject"),
}
local function described(name, summary, own)
  return { name = name, summary = summary, gives = "lapwing.film.shot.keyframes[]",
           arguments = table.move(common, 1, #common, #own + 1, own) }
end

shots.described = {
  described("static", "The camera stands still.", { place("position", "position of the camera") }),
  described("pan", "The camera stands still and turns from one point to another.",
            { place("position", "position of the camera"),
              look("look_from", true, "target at the start"),
              look("look_to", true, "target at the end") }),
  described("dolly", "A straight line, as on rails.",
            { place("from_position", "start position"), place("to_position", "end position") }),
  described("orbit", "A circle around a center, at a constant rate except in the ramps.", {
    place("center", "centre of the circle; its height is ignored"),
    { name = "radius", type = "number", unit = "m", required = true, above = 0, maximum = 1e5,
      summary = "radius of the circle" },
    { name = "height", type = "number", unit = "m", required = true, minimum = -1e6,
      maximum = 1e6, summary = "height of the camera, in the world" },
    { name = "angle", type = "number", unit = "deg", default = 360, minimum = -36000,
      maximum = 36000, summary = "angle of the orbit; negative is clockwise" },
    { name = "from", type = "number", unit = "deg", default = 0, minimum = -36000,
      maximum = 36000, summary = "direction from the center at the start" },
    { name = "ramp", type = "number", unit = "s", default = 2, minimum = 0, maximum = 1e5,
      summary = "duration in which the rate rises at the start and falls at the end; 0: constant "
        .. "throughout, for a film that starts and finishes `free`" } }),
  described("crane", "Straight up or down, as on a crane.",
            { place("position", "start position"),
              { name = "by", type = "number", unit = "m", required = true, minimum = -1e5,
                maximum = 1e5, summary = "height difference; negative is downwards" } }),
  described("flyover", "An arc over an object, down to its far side.",
            { place("from_position", "start position"), place("to_position", "end position"),
              { name = "height", type = "number", unit = "m", required = true, minimum = -1e5,
                maximum = 1e5,
                summary = "height above the line between the ends, at half-time" } }),
}
local declared = {}
for _, shot in ipairs(shots.described) do declared[shot.name] = shot end

-- The arguments with their defaults; an error at the script's line where they do not fit.
local function arguments(what, given)
  local plain, list = {}, declared[what].arguments
  if type(given) ~= "table" then
    lapwing.fail("shots." .. what .. ": expected a table, got " .. type(given))
  end
  for key, value in pairs(given) do plain[key] = value end
  local checked = table.move(list, 1, #list, 1, {})
  for i, argument in ipairs(checked) do
    if argument.also == "string" and type(plain[argument.name]) == "string" then
      checked[i] = { name = argument.name, type = "text", summary = argument.summary }
    end
  end
  return lapwing.arguments("shots." .. what, checked, plain)
end

-- ---- what they give ---------------------------------------------------------------------

local function at(given, share, position, look_at)
  return { time = given.start + share * given.duration, position = position,
           look_at = look_at or given.look_at }
end

-- Keyframes are options: lists of numbers that a script may change.
local function list_of(v) return { v.x, v.y, v.z } end
local function raised(position, up) return list_of(lapwing.vector(position) + { 0, 0, up }) end
local function middle(a, b) return list_of((lapwing.vector(a) + b) / 2) end

function shots.static(given)
  given = arguments("static", given)
  return { at(given, 0, given.position), at(given, 1, given.position) }
end

function shots.pan(given)
  given = arguments("pan", given)
  return { at(given, 0, given.position, given.look_from),
           at(given, 1, given.position, given.look_to) }
end

function shots.dolly(given)
  given = arguments("dolly", given)
  local a, b = given.from_position, given.to_position
  return { at(given, 0, a), at(given, 0.5, middle(a, b)), at(given, 1, b) }
end

-- The share of an orbit that is behind after `time`: the rate rises smoothly, without a jump of the
-- acceleration, over `ramp`, is constant, and falls likewise.
local function turned(time, duration, ramp)
  if time > duration / 2 then return 1 - turned(duration - time, duration, ramp) end
  local rate = 1 / (duration - ramp)
  if time >= ramp then return rate * (time - ramp / 2) end
  local x = time / ramp
  return rate * ramp * x ^ 4 * (x * x - 3 * x + 2.5)
end

function shots.orbit(given)
  given = arguments("orbit", given)
  local duration, ramp = given.duration, given.ramp
  if 2 * ramp > duration then
    lapwing.fail(string.format("shots.orbit.ramp: two of %g s are more than the %g s of the shot",
                               ramp, duration))
  end
  local rate = math.abs(given.angle) / (duration - ramp)  -- deg/s, the largest
  local count = math.max(2, math.ceil(rate * duration / ORBIT_SPACING))
  local keyframes = {}
  for i = 0, count do
    local share = turned(duration * i / count, duration, ramp)
    local direction = math.rad(given.from + given.angle * share)
    keyframes[i + 1] = at(given, i / count, {
      given.center[1] + given.radius * math.cos(direction),
      given.center[2] + given.radius * math.sin(direction), given.height })
  end
  return keyframes
end

function shots.crane(given)
  given = arguments("crane", given)
  return { at(given, 0, given.position), at(given, 0.5, raised(given.position, given.by / 2)),
           at(given, 1, raised(given.position, given.by)) }
end

function shots.flyover(given)
  given = arguments("flyover", given)
  local a, b = given.from_position, given.to_position
  return { at(given, 0, a), at(given, 0.5, raised(middle(a, b), given.height)),
           at(given, 1, b) }
end

-- Lists without times, which a speed times: in order, a place that ends one list and begins the
-- next once, with what the next says of it and the speed of the leg that leads to it.
local function sequence_of_places(lists)
  local all = {}
  for _, list in ipairs(lists) do
    for i, keyframe in ipairs(list) do
      local taken, last = {}, i == 1 and all[#all]
      for key, value in pairs(keyframe) do taken[key] = value end
      if last and lapwing.norm(lapwing.vector(last.position) - taken.position) == 0 then
        taken.speed, taken.time = taken.speed or last.speed, last.time
        all[#all] = nil
      end
      all[#all + 1] = taken
    end
  end
  return all
end

-- Several lists of keyframes in one, each beginning where the one before ends in time. A keyframe
-- at the time of the one before it replaces it. Keyframes that a speed times have no times, except
-- the very first; then all lists have none.
function shots.sequence(...)
  local lists, timed, untimed = { ... }, nil, nil
  for i, list in ipairs(lists) do
    for j, keyframe in ipairs(list) do
      local what = string.format("keyframe %d of list %d", j, i)
      if not keyframe.time then untimed = untimed or what
      elseif i > 1 or j > 1 then timed = timed or what end
    end
  end
  if timed and untimed then
    lapwing.fail(string.format("shots.sequence: %s has no time, but %s has one: give every "
                               .. "keyframe a time, or none and a speed", untimed, timed))
  end
  if untimed then return sequence_of_places(lists) end
  local all, offset = {}, 0
  for _, list in ipairs(lists) do
    local finish = offset
    for _, keyframe in ipairs(list) do
      local moved = {}
      for key, value in pairs(keyframe) do moved[key] = value end
      moved.time = keyframe.time + offset
      if #all > 0 and moved.time <= all[#all].time then all[#all] = nil end
      all[#all + 1] = moved
      finish = math.max(finish, moved.time)
    end
    offset = finish
  end
  return all
end

return shots
