-- SPDX-License-Identifier: Apache-2.0
-- The environment of a film as a problem needs it: obstacles, flight zones, the tracking volume.
local parts = require "mission.film_parts"
local tracks = require "mission.tracks"

local M = {}

local MOST_OBSTACLES = 300
local ROOM = 15  -- m about the keyframes, in which a map is looked at
local SAGS = 0.1  -- m below the lowest keyframe, of which nothing is said

-- Where flights may be: the zones, and the tracking volume as one more, as obstacles to stay inside
-- of.
local function add_flight_zones(run, options, obstacles)
  local zones = table.move(options.flight_zones, 1, #options.flight_zones, 1, {})
  local volume = options.volume
  if volume and (volume.lower or volume.upper) then
    local low, high = volume.lower, volume.upper
    if not (low and high) then run:fail("volume", "expected lower and upper") end
    for i = 1, 3 do
      if low[i] >= high[i] then run:fail("volume", "lower must be below upper in x, y and z") end
    end
    zones[#zones + 1] = { name = "volume", floor = low[3], ceiling = high[3],
      corners = { low[1], low[2], high[1], low[2], high[1], high[2], low[1], high[2] } }
  end
  for _, zone in ipairs(zones) do
    obstacles[#obstacles + 1] = { type = "prism", side = "keep_inside", name = zone.name,
                                  corners = zone.corners, floor = zone.floor,
                                  ceiling = zone.ceiling }
  end
end

-- Whether the options say how low flights may be.
local function bounded_below(options)
  local volume = options.volume
  if options.ground or volume and volume.lower then return true end
  for _, zone in ipairs(options.flight_zones) do
    if zone.floor then return true end
  end
  for _, obstacle in ipairs(options.obstacles) do
    if obstacle.type == "half_space" then return true end
  end
  return false
end

-- A sentence on a path that comes near height 0 by itself, where nothing says what the ground is;
-- or nil. `path`: x, y, z in turn.
function M.low_pass(options, keyframes, path)
  if bounded_below(options) then return nil end
  local lowest, low = math.huge, math.huge
  for _, k in ipairs(keyframes) do lowest = math.min(lowest, k.position[3]) end
  for i = 3, #path, 3 do low = math.min(low, path[i]) end
  if low >= math.min(options.margin, lowest - SAGS) then return nil end
  return string.format("the path comes down to height %.2f m, lower than any keyframe, and no "
    .. "ground is stated: `ground = 0` makes level ground at height 0 an obstacle", low)
end

-- The box about the keyframes in which distances of maps are wanted.
local function surroundings(keyframes)
  local lower, upper = {}, {}
  for i = 1, 3 do
    lower[i], upper[i] = math.huge, -math.huge
    for _, k in ipairs(keyframes) do
      lower[i] = math.min(lower[i], k.position[i] - ROOM)
      upper[i] = math.max(upper[i], k.position[i] + ROOM)
    end
  end
  return { lower = lower, upper = upper }
end

-- What surrounds a problem, from the options `obstacles`, `ground`, `flight_zones` and `volume`:
-- obstacles as run:problem takes them, and the rest of its environment.
function M.of(run, options, keyframes)
  if #options.obstacles > MOST_OBSTACLES then
    run:fail("obstacles", string.format("%d are more than %d, the limit of a film",
                                        #options.obstacles, MOST_OBSTACLES))
  end
  local obstacles = {}
  for i, given in ipairs(options.obstacles) do
    local made = {}
    for key, value in pairs(given) do made[key] = value end
    if made.name == "" then made.name = given.file end
    obstacles[i] = made
  end
  if options.ground then
    obstacles[#obstacles + 1] = { type = "half_space", name = "ground", opaque = false,
                                  point = { 0, 0, options.ground }, normal = { 0, 0, 1 } }
  end
  add_flight_zones(run, options, obstacles)
  return { obstacles = obstacles, margin = options.margin, region = surroundings(keyframes) }
end

-- The arguments of run:problem that say what surrounds it.
function M.stated(environment, arguments)
  arguments.obstacles = environment.obstacles
  arguments.environment = { margin = environment.margin, region = environment.region,
                            subjects = environment.subjects }
  return arguments
end

-- The environment that a request states, subjects and bystanders included; and the bystanders.
function M.state(run, request, camera)
  local options = run.options
  local environment = M.of(run, options, request.keyframes)
  environment.subjects = {}
  for i, subject in ipairs(camera and camera.list or {}) do
    environment.subjects[i] = { name = subject.name, height = subject.height,
                                width = subject.width, distance = subject.distance,
                                track = subject.track }
  end
  local bystanders = tracks.checked(run, options.keep_away, request.stretch, "keep_away",
                                    "bystander")
  for i, bystander in ipairs(bystanders) do
    for _, subject in ipairs(environment.subjects) do
      if subject.name == bystander.name then
        run:fail("keep_away[" .. i .. "].name", "'" .. subject.name .. "' is taken")
      end
    end
    environment.subjects[#environment.subjects + 1] = { name = bystander.name, filmed = false,
      distance = bystander.distance, track = bystander.track }
  end
  return environment, bystanders
end

-- Whether any obstacle can hide a subject.
function M.hides(environment)
  for _, obstacle in ipairs(environment.obstacles) do
    if obstacle.opaque ~= false and obstacle.side ~= "keep_inside" then return true end
  end
  return false
end

-- Whether the flight keeps a distance from anything.
function M.near_things(options, subjects)
  if #options.obstacles > 0 or #options.flight_zones > 0 or #options.keep_away > 0
     or options.ground or options.volume and options.volume.lower then return true end
  for _, subject in ipairs(subjects) do
    if subject.distance then return true end
  end
  return false
end

local function moves(environment)
  for _, obstacle in ipairs(environment.obstacles) do
    if obstacle.track and #obstacle.track > 0 then return true end
  end
  return false
end

-- Constraints that keep a problem clear of its environment; or within a corridor, whose boxes are
-- free of all that stands still.
function M.add(p, environment, camera, corridor)
  if corridor then p:add_constraint { type = "corridor", regions = corridor } end
  if #environment.obstacles > 0 and (not corridor or moves(environment)) then
    p:add_constraint { type = "obstacle" }
  end
  for _, subject in ipairs(camera and camera.list or {}) do
    if subject.distance then
      p:add_constraint { type = "subject_distance", name = "distance to " .. subject.name,
                         subject = subject.name, distance = subject.distance }
    end
  end
  for _, subject in ipairs(environment.subjects or {}) do
    if subject.filmed == false then
      p:add_constraint { type = "subject_distance", name = "distance to " .. subject.name,
                         subject = subject.name, distance = subject.distance }
    end
  end
end

-- The speeds that keyframes are timed by, wanted in between them as well: along the straight leg,
-- which keeps the term convex where the flight goes round something.
function M.add_cruise(p, request, weight, part)
  local stretch = request.stretch
  for i, leg in ipairs(request.cruise) do
    local speed, way = leg.speed / stretch, lapwing.normalize(lapwing.vector(leg.to) - leg.from)
    local spans = parts.spans(part, { { start = leg.start * stretch,
                                        finish = leg.finish * stretch } })
    if #spans > 0 then
      p:add_cost { name = "cruise " .. i, weight = weight, spans = spans,
                   residual = function(s) return lapwing.dot(s.velocity, way) - speed end }
    end
  end
end

-- The film's own limit of speed, as a constraint of a script: the certificate judges it.
function M.add_speed_limit(p, options, held)
  if not options.speed_limit then return end
  p:add_constraint { name = "speed_limit", upper = options.speed_limit, held = held,
                     value = function(s) return lapwing.norm(s.velocity) end }
end

return M
