-- SPDX-License-Identifier: Apache-2.0
-- The options of a film: their declarations, and the expansion of short forms.
local input = {}

local GRID = 0.1         -- s, between the samples of a track that is a function
local MOST_SAMPLES = 10000
local OFF_TRACK = 0.25   -- m, that the function may leave the straight way between two samples

-- A track as a function of time becomes a list, so that options are plain data.
local function sampled(track, duration, what)
  if not duration then
    lapwing.fail(what .. ": a function needs the film's duration, or keyframes with times")
  end
  local function at(time)
    local position = track(time)
    if type(position) ~= "table" or #position ~= 3 then
      lapwing.fail(string.format("%s: expected {x, y, z} at %g s, got %s", what, time,
                                 type(position)))
    end
    return position
  end
  local count = math.min(MOST_SAMPLES, math.ceil(duration / GRID))
  local list = {}
  for i = 0, count do
    local time = duration * i / count
    list[i + 1] = { time = time, position = at(time) }
    local before = list[i]
    if before then
      local middle = (lapwing.vector(before.position) + list[i + 1].position) / 2
      local off = lapwing.norm(lapwing.vector(at((before.time + time) / 2)) - middle)
      if off > OFF_TRACK then
        lapwing.fail(string.format("%s: between %.4g and %.4g s it is %.3g m off a straight line; "
          .. "give a list of times and positions", what, before.time, time, off))
      end
    end
  end
  return list
end

-- The duration that a shot gives, or the last time of its keyframes.
local function duration_of(given)
  if given.duration then return given.duration end
  local last
  for _, k in ipairs(type(given.keyframes) == "table" and given.keyframes or {}) do
    if type(k) == "table" and type(k.time) == "number" then last = math.max(last or 0, k.time) end
  end
  return last
end

-- {{x, y}, ...} as {x, y, ...}
local function with_flat_corners(entry)
  if type(entry) ~= "table" or type(entry.corners) ~= "table" then return entry end
  local copy, flat = {}, {}
  for key, value in pairs(entry) do copy[key] = value end
  for _, corner in ipairs(entry.corners) do
    for _, number in ipairs(type(corner) == "table" and corner or { corner }) do
      flat[#flat + 1] = number
    end
  end
  copy.corners = flat
  return copy
end

-- The options of a shot with its short forms written out: one `subject`, tracks that are functions,
-- looks by name.
function input.written_out(given)
  local out = {}
  for key, value in pairs(given) do out[key] = value end
  if out.subject ~= nil then
    if out.subjects ~= nil then lapwing.fail("give subject or subjects, not both") end
    if type(out.subject) ~= "table" then lapwing.fail("subject: expected a table") end
    out.subjects, out.subject = { out.subject }, nil
  end
  for _, option in ipairs { "subjects", "keep_away" } do
    local list = {}
    for i, entry in ipairs(type(out[option]) == "table" and out[option] or {}) do
      local what = string.format("%s[%d].track", option, i)
      if type(entry) == "table" then
        local copy = {}
        for key, value in pairs(entry) do copy[key] = value end
        if type(copy.track) == "function" then
          copy.track = sampled(copy.track, duration_of(out), what)
        end
        entry = copy
      end
      list[i] = entry
    end
    if type(out[option]) == "table" then out[option] = list end
  end
  if type(out.keyframes) == "table" then
    local list = {}
    for i, entry in ipairs(out.keyframes) do
      if type(entry) == "table" and type(entry.look_at) == "string" then
        local copy = {}
        for key, value in pairs(entry) do copy[key] = value end
        copy.subject, copy.look_at = copy.look_at, nil
        entry = copy
      end
      list[i] = entry
    end
    out.keyframes = list
  end
  for _, option in ipairs { "obstacles", "flight_zones" } do
    if type(out[option]) == "table" then
      local list = {}
      for i, entry in ipairs(out[option]) do list[i] = with_flat_corners(entry) end
      out[option] = list
    end
  end
  return out
end

local track = { name = "track", type = "tables", also = "fun(time: number): number[]",
  summary = "positions at times, linear in between; or a function of time",
  table = {
    { name = "time", type = "number", unit = "s", required = true, summary = "time in the film" },
    { name = "position", type = "numbers", size = 3, unit = "m", required = true,
      minimum = -1e6, maximum = 1e6, summary = "position of the centre" } } }

input.bystander = {
  { name = "name", type = "text", summary = "name in messages and reports" },
  { name = "position", type = "numbers", size = 3, unit = "m", minimum = -1e6, maximum = 1e6,
    summary = "fixed position; or give a track" },
  track,
  { name = "distance", type = "number", unit = "m", required = true, above = 0, maximum = 1e5,
    summary = "smallest distance of the path from it" },
}

input.subject = {
  { name = "name", type = "text", summary = "name, to which keyframes refer" },
  { name = "position", type = "numbers", size = 3, unit = "m", minimum = -1e6, maximum = 1e6,
    summary = "fixed position of the centre; or give a track" },
  track,
  { name = "live", type = "boolean", default = false,
    summary = "plan again at every `update`, from what was seen of the track until then" },
  { name = "delay", type = "number", unit = "s", default = 0, minimum = 0, maximum = 10,
    summary = "time after which a live subject is seen" },
  { name = "height", type = "number", unit = "m", default = 0, minimum = 0, maximum = 1e5,
    summary = "height of its upright cylinder" },
  { name = "width", type = "number", unit = "m", default = 0, minimum = 0, maximum = 1e5,
    summary = "diameter of its upright cylinder" },
  { name = "distance", type = "number", unit = "m", minimum = 0,
    summary = "distance that the flight keeps from its centre; absent: none" },
  { name = "place", type = "numbers", size = 2, minimum = 0, maximum = 1,
    summary = "wanted place in the image, from the upper left (0, 0) to the lower right (1, 1)" },
  { name = "size", type = "number", above = 0, maximum = 1,
    summary = "wanted height as a fraction of the image height, in the centre of the image" },
}

input.keyframe = {
  { name = "time", type = "number", unit = "s", minimum = 0,
    summary = "time; absent: even between the others, or set by a speed" },
  { name = "speed", type = "number", unit = "m/s", above = 0, maximum = 1e3,
    summary = "speed on the leg to it; absent: `speed` of the film" },
  { name = "time_weight", type = "number", above = 0,
    summary = "weight of the squared time error if times are wishes, in s of flight" },
  { name = "earliest", type = "number", unit = "s", minimum = 0,
    summary = "earliest time if times are wishes" },
  { name = "latest", type = "number", unit = "s", minimum = 0,
    summary = "latest time if times are wishes" },
  { name = "position", type = "numbers", size = 3, unit = "m", required = true,
    minimum = -1e6, maximum = 1e6, summary = "position in the world: east, north, up" },
  { name = "beside", type = "text",
    summary = "name of a subject: the position is relative to its place at that time" },
  { name = "yaw_deg", type = "number", unit = "deg",
    summary = "heading: 0 is east, counter-clockwise" },
  { name = "look_at", type = "numbers", size = 3, unit = "m", minimum = -1e6, maximum = 1e6,
    also = "string",
    summary = "target of the camera: a point, or the name of a subject; absent: as the keyframe "
    .. "before" },
  { name = "subject", type = "text",
    summary = "name of the filmed subject; set by `look_at = NAME`" },
}

input.cut = {
  { name = "start", type = "number", unit = "s", required = true, minimum = 0,
    summary = "start of the span" },
  { name = "finish", type = "number", unit = "s", minimum = 0,
    summary = "end; absent: as soon as the camera can film what follows" },
}

-- Beside the parameters of its shape.
input.obstacle = {
  { name = "name", type = "text", default = "", summary = "name in messages and reports" },
  { name = "side", type = "choice", default = "keep_out", choices = { "keep_out", "keep_inside" },
    summary = "where the flight stays" },
  { name = "opaque", type = "boolean", default = true,
    summary = "whether it hides subjects; false for closed airspace" },
  { name = "track", type = "tables", summary = "motion; absent: it stands still",
    table = {
      { name = "time", type = "number", unit = "s", required = true, summary = "time in the film" },
      { name = "move", type = "numbers", size = 3, unit = "m", required = true, minimum = -1e6,
        maximum = 1e6, summary = "displacement, linear between these times" } } },
}

input.flight_zone = {
  { name = "name", type = "text", default = "", summary = "name in messages and reports" },
  { name = "corners", type = "numbers", unit = "m", required = true, also = "number[][]",
    summary = "corners of the polygon: {{x, y}, ...}, or x, y, x, y, ..." },
  { name = "floor", type = "number", unit = "m", summary = "lower end; absent: none" },
  { name = "ceiling", type = "number", unit = "m", summary = "upper end; absent: none" },
}

input.volume = {
  { name = "lower", type = "numbers", size = 3, unit = "m", minimum = -1e6, maximum = 1e6,
    summary = "lowest corner, world" },
  { name = "upper", type = "numbers", size = 3, unit = "m", minimum = -1e6, maximum = 1e6,
    summary = "highest corner" },
}

return input
