-- A course: the gates in the order of flight, laps written out, with everything checked that can be
-- checked before a flight is planned.
local course = {}

local SHAPES = { ball = { "radius" }, rectangle = { "width", "height" },
                 triangle = { "width", "height" }, pentagon = { "radius", "side" },
                 hexagon = { "radius", "side" } }
local MOST = 10000      -- gates, laps together
local SAME = 1e-6       -- m, nearer than this two places are one

local function distance(a, b)
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
end
course.distance = distance

local function finite(x) return math.type(x) ~= nil and x == x and math.abs(x) < 1e6 end

local function point(fail, what, value)
  local fits = type(value) == "table" and #value == 3
  for i = 1, fits and 3 or 0 do fits = fits and finite(value[i]) end
  if not fits then fail(what .. ": expected three finite numbers, x, y and z in m") end
  return value
end

-- A gate of a file or a script as the constraint and the certificate want it.
local function gate_of(fail, given, what)
  if type(given) ~= "table" then
    fail(string.format("%s: expected a gate {shape, position, ...}, got %s", what,
                       tostring(given)))
  end
  local shape = given.shape
  local sizes = SHAPES[shape]
  if type(shape) ~= "string" then
    fail(what .. ".shape: expected ball, hexagon, pentagon, rectangle or triangle")
  end
  if not sizes then
    fail(string.format("%s: no gate has the shape '%s'; there are ball, hexagon, pentagon, "
                       .. "rectangle and triangle", what, tostring(shape)))
  end
  local gate = { name = given.name or what, shape = shape,
                 position = point(fail, what .. ".position", given.position) }
  local known = { name = true, shape = true, position = true, normal_yaw = true,
                  normal_pitch = true, tunnel_length = true }
  local either, count = sizes[2] == "side", 0
  for _, size in ipairs(sizes) do
    known[size] = true
    local value = given[size]
    if value ~= nil then
      if not finite(value) or value <= 0 then
        fail(string.format("%s: a %s cannot be entered with a %s of %s; expected metres above 0",
                           what, shape, size, tostring(value)))
      end
      gate[size], count = value, count + 1
    elseif not either then
      fail(string.format("%s: a %s needs its %s", what, shape, table.concat(sizes, " and ")))
    end
  end
  if either and count ~= 1 then fail(what .. ": expected either a radius or a side") end
  for key in pairs(given) do
    if not known[key] then fail(string.format("%s: a %s has no '%s'", what, shape, key)) end
  end
  if shape == "ball" then return gate end
  local yaw, pitch = given.normal_yaw, given.normal_pitch or 0
  if not finite(yaw) or not finite(pitch) or math.abs(pitch) > 89 then
    fail(what .. ": expected the direction of flight, normal_yaw in degrees (and normal_pitch, "
         .. "within 89)")
  end
  yaw, pitch = math.rad(yaw), math.rad(pitch)
  gate.direction = { math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch),
                     math.sin(pitch) }
  gate.tunnel_length = given.tunnel_length or 0
  if not finite(gate.tunnel_length) or gate.tunnel_length < 0 then
    fail(what .. ".tunnel_length: expected metres, 0 or more")
  end
  return gate
end

-- The place at a share of the tunnel: -0.5 where it begins, 0.5 where it ends.
function course.place(gate, share)
  local p = {}
  for i = 1, 3 do
    local along = gate.direction and gate.direction[i] * gate.tunnel_length or 0
    p[i] = gate.position[i] + share * along
  end
  return p
end

local function end_of(fail, given, what)
  if given == nil then return nil end
  if type(given) ~= "table" then
    fail(what .. ": expected {x, y, z}, or a position and a velocity, got " .. tostring(given))
  end
  if #given == 3 then given = { position = given } end
  point(fail, what .. ".position", given.position)
  for key in pairs(given) do
    if key ~= "position" and key ~= "velocity" then
      fail(string.format("%s: there is no '%s'; it has position and velocity", what, key))
    end
  end
  if given.velocity ~= nil then point(fail, what .. ".velocity", given.velocity) end
  for _, v in ipairs(given.velocity or {}) do
    if v ~= 0 then fail(what .. ".velocity: a course begins and ends at rest, or freely") end
  end
  return given.position
end

-- Gates inside each other could only be flown through at once.
local function check_apart(fail, gates)
  for i = 2, #gates do
    local a, b = gates[i - 1], gates[i]
    if a.direction and b.direction and distance(a.position, b.position) < SAME then
      fail(string.format("gates '%s' and '%s' stand inside each other, at %g %g %g", a.name, b.name,
                         a.position[1], a.position[2], a.position[3]))
    end
  end
end

-- Start, finish and part of every gate must be above the floor.
local function check_floor(fail, made, gates, floor)
  if not floor then return end
  for _, name in ipairs { "start", "finish" } do
    local place = made[name]
    if place and place[3] <= floor then
      fail(string.format("%s: %g m above the ground, and the flight stays above %g m", name,
                         place[3], floor))
    end
  end
  for _, gate in ipairs(gates) do
    local up = gate.height and gate.height / 2 or gate.radius or gate.side
    if gate.position[3] + up <= floor then
      fail(string.format("gate '%s' cannot be entered: it ends %.3g m above the ground, and the "
                         .. "flight stays above %g m", gate.name, gate.position[3] + up, floor))
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

local function read(run)
  local o = run.options
  local ways = {}
  for _, way in ipairs { "gates", "keyframes" } do
    if #o[way] > 0 then ways[#ways + 1] = way end
  end
  if o.free_form.length then ways[#ways + 1] = "free_form" end
  if #ways > 1 then
    run:fail(ways[2], "a course is given in one way; there are " .. table.concat(ways, " and "))
  end
  if o.laps > 1 and not o.closed then
    run:fail("laps", "laps are flown on a closed course: set closed = true")
  end
  if not o.input then return o end
  local file = o.input:match("%.json$") and lapwing.read_json(o.input, "tracks")
               or lapwing.read_yaml(o.input, "tracks")
  for key, value in pairs(file) do
    if (key == "gates" or key == "waypoints") and (type(value) ~= "table" or #value == 0) then
      run:fail("input", string.format("%s: %s: expected a list", o.input, key))
    end
    if key ~= "start" and key ~= "end" and key ~= "gates" and key ~= "waypoints" then
      run:fail("input", string.format("%s: a course has no '%s'; it has start, end, gates and "
                                      .. "waypoints", o.input, key))
    end
  end
  return { start = file.start, finish = file["end"], gates = file.gates,
           keyframes = file.waypoints, closed = o.closed, laps = o.laps }
end

-- {gates =, start = {x, y, z} or nil, finish = likewise, closed =}
function course.read(run)
  local o = run.options
  local given = read(run)
  local function fail(text) run:fail(o.input and "input" or "gates", text) end
  local list = {}
  for i, gate in ipairs(given.gates or {}) do
    list[#list + 1] = gate_of(fail, gate, string.format("gates[%d]", i))
  end
  for i, k in ipairs(given.keyframes or {}) do
    list[#list + 1] = { name = "keyframe " .. i, shape = "ball", radius = o.tolerance,
                        position = point(fail, string.format("keyframes[%d]", i),
                                         type(k) == "table" and k.position or k) }
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
    fail("a course needs gates, keyframes, a free_form length, or --set input=FILE")
  end
  if made.closed and (made.start or made.finish) then
    fail("a closed course has neither start nor end: it is flown round and round")
  end
  if #list * o.laps > MOST then fail(string.format("more than %d gates in all laps", MOST)) end
  for _ = 1, o.laps do
    for _, gate in ipairs(list) do made.gates[#made.gates + 1] = gate end
  end
  check_apart(fail, made.gates)
  check_floor(fail, made, list, o.floor)
  return made
end

return course
