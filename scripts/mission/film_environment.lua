-- SPDX-License-Identifier: Apache-2.0
-- The environment of a film as a problem needs it: obstacles, flight zones, the tracking volume.
local tracks = require "mission.tracks"

local M = {}

local MOST_OBSTACLES = 300
local ROOM = 15  -- m about the keyframes, in which a map is looked at

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

-- What surrounds a problem, from the options `obstacles`, `flight_zones` and `volume`: obstacles as
-- run:problem takes them, and the rest of its environment.
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
function M.add_cruise(p, request, weight)
  local stretch = request.stretch
  for i, leg in ipairs(request.cruise) do
    local speed, way = leg.speed / stretch, lapwing.normalize(lapwing.vector(leg.to) - leg.from)
    p:add_cost { name = "cruise " .. i, weight = weight,
                 spans = { { start = leg.start * stretch, finish = leg.finish * stretch } },
                 residual = function(s) return lapwing.dot(s.velocity, way) - speed end }
  end
end

-- The film's own limit of speed, as a constraint of a script: the certificate judges it.
function M.add_speed_limit(p, options, held)
  if not options.speed_limit then return end
  p:add_constraint { name = "speed_limit", upper = options.speed_limit, held = held,
                     value = function(s) return lapwing.norm(s.velocity) end }
end

return M
