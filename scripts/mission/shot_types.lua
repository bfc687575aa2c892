-- Named shots as keyframes: how a film crew asks for a camera move.
--
-- Each takes a table and gives keyframes for film.shot, evenly in time from `start` (0) over
-- `duration` seconds; several can be joined with shots.sequence. Places are in m, world; angles in
-- degrees, 0 east, counter-clockwise.
--
--   keyframes = shots.orbit { center = {0, 0, 2}, radius = 12, height = 6, duration = 20 }
local shots = {}

local SPACING = 15  -- deg of an orbit between two keyframes

-- Checked arguments: what a shot needs, and what it may be given besides.
local function arguments(what, given, needed, optional)
  if type(given) ~= "table" then lapwing.fail("shots." .. what .. ": expected a table") end
  local known = { duration = true, start = true, look_at = true }
  for _, key in ipairs(needed) do known[key] = true end
  for _, key in ipairs(optional or {}) do known[key] = true end
  for key in pairs(given) do
    if not known[key] then lapwing.fail("shots." .. what .. ": unknown key '" .. key .. "'") end
  end
  for _, key in ipairs(needed) do
    if given[key] == nil then lapwing.fail("shots." .. what .. ": needs " .. key) end
  end
  local numbers = { duration = true, radius = true, height = true, angle = true, from = true,
                    start = true, by = true }
  for key, value in pairs(given) do
    local expected = numbers[key] and "number" or (key ~= "look_at" and "table")
    if expected and type(value) ~= expected then
      lapwing.fail(string.format("shots.%s.%s: expected a %s, got %s", what, key,
                                 expected == "table" and "position" or expected, type(value)))
    end
  end
  if type(given.duration) ~= "number" or given.duration <= 0 then
    lapwing.fail("shots." .. what .. ".duration: expected seconds above 0")
  end
  return given
end

local function at(given, share, position, look_at)
  return { time = (given.start or 0) + share * given.duration, position = position,
           look_at = look_at or given.look_at }
end

local function raised(position, up) return { position[1], position[2], position[3] + up } end

-- The camera stands still.
function shots.static(given)
  arguments("static", given, { "position" })
  return { at(given, 0, given.position), at(given, 1, given.position) }
end

-- The camera stands still and turns from one look to another, points or names of subjects.
function shots.pan(given)
  arguments("pan", given, { "position", "look_from", "look_to" })
  return { at(given, 0, given.position, given.look_from),
           at(given, 1, given.position, given.look_to) }
end

-- A straight line, as on rails.
function shots.dolly(given)
  arguments("dolly", given, { "from_position", "to_position" })
  local a, b = given.from_position, given.to_position
  local middle = { (a[1] + b[1]) / 2, (a[2] + b[2]) / 2, (a[3] + b[3]) / 2 }
  return { at(given, 0, a), at(given, 0.5, middle), at(given, 1, b) }
end

-- Around a center, `angle` degrees (360; negative is clockwise) from direction `from` (0), at a
-- height in the world.
function shots.orbit(given)
  arguments("orbit", given, { "center", "radius", "height" }, { "angle", "from" })
  local angle, from = given.angle or 360, given.from or 0
  local count = math.max(2, math.ceil(math.abs(angle) / SPACING))
  local keyframes = {}
  for i = 0, count do
    local direction = math.rad(from + angle * i / count)
    keyframes[i + 1] = at(given, i / count, {
      given.center[1] + given.radius * math.cos(direction),
      given.center[2] + given.radius * math.sin(direction), given.height })
  end
  return keyframes
end

-- Straight up, or down with `by` below 0, as on a crane's arm.
function shots.crane(given)
  arguments("crane", given, { "position", "by" })
  return { at(given, 0, given.position), at(given, 0.5, raised(given.position, given.by / 2)),
           at(given, 1, raised(given.position, given.by)) }
end

-- Over something and down on its far side: `height` above the line between the ends at half-time.
function shots.flyover(given)
  arguments("flyover", given, { "from_position", "to_position", "height" })
  local a, b = given.from_position, given.to_position
  local top = { (a[1] + b[1]) / 2, (a[2] + b[2]) / 2, (a[3] + b[3]) / 2 + given.height }
  return { at(given, 0, a), at(given, 0.5, top), at(given, 1, b) }
end

-- Several lists of keyframes in one, each beginning where the one before ends in time. A keyframe
-- at the time of the one before it replaces it.
function shots.sequence(...)
  local all, offset = {}, 0
  for _, list in ipairs { ... } do
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
