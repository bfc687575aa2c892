-- SPDX-License-Identifier: Apache-2.0
-- A course: the gates in the order of flight, lap by lap, and all checks that are possible before
-- planning.
local files = require "mission.race_file"
local paths = require "mission.paths"

local course = {}

local SHAPES = { ball = { "radius" }, rectangle = { "width", "height" },
                 triangle = { "width", "height" }, pentagon = { "radius", "side" },
                 hexagon = { "radius", "side" } }
local MOST = 10000      -- gates, laps together
local SAME = 1e-6       -- m, nearer than this two places are one

course.GATE = files.GATE

local function finite(x) return math.type(x) ~= nil and x == x and math.abs(x) < 1e6 end

local function point(fail, path, value)
  local fits = type(value) == "table" and #value == 3
  for i = 1, fits and 3 or 0 do fits = fits and finite(value[i]) end
  if not fits then fail(path, "expected three finite numbers, x, y and z in m") end
  return value
end

local function add_sizes(fail, path, given, gate)
  local shape = gate.shape
  local sizes = SHAPES[shape]
  local has = { name = true, shape = true, position = true, normal_yaw_deg = true,
                normal_pitch_deg = true, tunnel_length = true }
  local either, count = sizes[2] == "side", 0
  for _, size in ipairs(sizes) do
    has[size] = true
    local value = given[size]
    if value ~= nil then
      if value <= 0 then
        fail(path .. "." .. size, string.format("a %s cannot be entered with a %s of %s; expected "
                                                .. "metres above 0", shape, size, tostring(value)))
      end
      gate[size], count = value, count + 1
    elseif not either then
      fail(path, string.format("a %s needs its %s", shape, table.concat(sizes, " and ")))
    end
  end
  if either and count ~= 1 then fail(path, "expected either a radius or a side") end
  for key in pairs(given) do
    if not has[key] then fail(path .. "." .. key, string.format("a %s has none", shape)) end
  end
end

-- A gate, checked against GATE, as the constraint and the certificate want it.
local function gate_of(fail, path, given)
  local gate = { name = given.name or path, shape = given.shape,
                 position = point(fail, path .. ".position", given.position) }
  add_sizes(fail, path, given, gate)
  if gate.shape == "ball" then return gate end
  local yaw, pitch = given.normal_yaw_deg, given.normal_pitch_deg or 0
  if not yaw then
    fail(path .. ".normal_yaw_deg", "missing; expected the direction of flight in degrees")
  end
  if math.abs(pitch) > 89 then
    fail(path .. ".normal_pitch_deg", "expected degrees upwards, between -89 and 89")
  end
  yaw, pitch = math.rad(yaw), math.rad(pitch)
  gate.direction = { math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch),
                     math.sin(pitch) }
  gate.tunnel_length = given.tunnel_length or 0
  if gate.tunnel_length < 0 then fail(path .. ".tunnel_length", "expected metres, 0 or more") end
  return gate
end

-- The place at a share of the tunnel, from -0.5 to 0.5.
function course.place(gate, share)
  local place = lapwing.vector(gate.position)
  if not gate.direction then return place end
  return place + share * (gate.tunnel_length * lapwing.vector(gate.direction))
end

local function end_of(fail, given, path)
  if given == nil then return nil end
  if type(given) ~= "table" then
    fail(path, "expected {x, y, z}, or a position and a velocity, got " .. tostring(given))
  end
  if #given > 0 then return point(fail, path, given) end
  point(fail, path .. ".position", given.position)
  if given.velocity ~= nil then point(fail, path .. ".velocity", given.velocity) end
  for _, v in ipairs(given.velocity or {}) do
    if v ~= 0 then fail(path .. ".velocity", "a course begins and ends at rest or free") end
  end
  return given.position
end

-- Gates inside each other could only be flown through at once. `each`: how many a lap has.
local function check_apart(fail, gates, each)
  for i = 2, #gates do
    local a, b = gates[i - 1], gates[i]
    if a.direction and b.direction and paths.distance(a.position, b.position) < SAME then
      fail(string.format("gates[%d]", (i - 1) % each + 1), string.format(
        "gates '%s' and '%s' overlap at %g %g %g", a.name, b.name,
        a.position[1], a.position[2], a.position[3]))
    end
  end
end

local function check_floor(fail, made, gates, floor)
  if not floor then return end
  for _, name in ipairs { "start", "finish" } do
    local place = made[name]
    if place and place[3] <= floor then
      fail(name, string.format("%g m above the ground, and the flight stays above %g m", place[3],
                               floor))
    end
  end
  for i, gate in ipairs(gates) do
    local up = gate.height and gate.height / 2 or gate.radius or gate.side
    if gate.position[3] + up <= floor then
      fail(string.format("gates[%d]", i), string.format(
        "gate '%s' cannot be entered: it ends %.3g m above the ground, and the flight stays above "
        .. "%g m", gate.name, gate.position[3] + up, floor))
    end
  end
end

-- A free-form course (thesis 3.7.2): a heading that wanders no faster than the curvature allows.
local function free_form(o)
  local f = o.free_form
  local count = math.max(2, math.ceil(f.length / f.spacing))
  local step, heading, height = f.length / count, 0, f.height
  local p, points = { 0, 0, f.height }, {}
  local turn = 0
  for i = 1, count + 1 do
    points[i] = { shape = "ball", radius = o.tolerance, position = { p[1], p[2], p[3] } }
    turn = 0.5 * turn + (math.random() - 0.5) * 2 * f.curvature * step
    turn = math.max(-f.curvature * step, math.min(f.curvature * step, turn))
    heading = heading + turn
    height = math.max(0.5 * f.height, math.min(1.5 * f.height,
                                               height + (math.random() - 0.5) * 0.2 * step))
    p = { p[1] + step * math.cos(heading), p[2] + step * math.sin(heading), height }
  end
  return points
end

-- The course as it is given, and a function that fails where a part of it was written.
local function read(run)
  local o = run.options
  local ways = {}
  for _, way in ipairs { "gates", "keyframes" } do
    if o[way] and #o[way] > 0 then ways[#ways + 1] = way end
  end
  if o.free_form.length then ways[#ways + 1] = "free_form" end
  if #ways > 1 then
    run:fail(ways[2], "give one course; there are " .. table.concat(ways, " and "))
  end
  if o.laps > 1 and not o.closed then
    run:fail("laps", "laps need a closed course: set closed = true")
  end
  if not o.input then return o, function(path, text) run:fail(path, text) end end
  local made, fail = files.read(o.input)
  made.closed, made.laps = o.closed, o.laps
  return made, fail
end

-- {gates =, start = {x, y, z} or nil, finish = likewise, closed =}
function course.read(run)
  local o = run.options
  local given, fail = read(run)
  local list = {}
  for i, gate in ipairs(given.gates or {}) do
    list[#list + 1] = gate_of(fail, string.format("gates[%d]", i), gate)
  end
  for i, k in ipairs(given.keyframes or {}) do
    local place = type(k) == "table" and k.position or k
    list[#list + 1] = { name = "keyframe " .. i, shape = "ball", radius = o.tolerance,
                        position = point(fail, string.format("keyframes[%d]", i), place) }
  end
  if o.free_form.length then
    for i, gate in ipairs(free_form(o)) do
      gate.name = "keyframe " .. i
      list[#list + 1] = gate
    end
  end
  local made = { gates = {}, closed = given.closed, start = end_of(fail, given.start, "start"),
                 finish = end_of(fail, given.finish, "finish") }
  if #list == 0 then
    fail("gates", "a course needs gates, keyframes, a free_form length, or --set input=FILE")
  end
  if made.closed and (made.start or made.finish) then
    fail(made.start and "start" or "finish",
         "a closed course has neither start nor finish")
  end
  if #list * o.laps > MOST then
    run:fail("laps", string.format("more than %d gates in all laps", MOST))
  end
  for _ = 1, o.laps do
    for _, gate in ipairs(list) do made.gates[#made.gates + 1] = gate end
  end
  check_apart(fail, made.gates, #list)
  check_floor(fail, made, list, o.floor)
  return made
end

return course
