-- SPDX-License-Identifier: Apache-2.0
-- What surrounds a film: obstacles, flight zones and the tracking volume, as a problem wants them.
local tracks = require "mission.tracks"

local M = {}

local MOST_OBSTACLES = 300
local ROOM = 15  -- m about the keyframes, in which a map is looked at

local FORMS = { sphere = { center = true, radius = true }, box = { lower = true, upper = true },
                no_fly_zone = { corners = true, floor = false, ceiling = false },
                mesh = { file = true }, map = { file = true } }

-- Where flights may be: the zones, and the tracking volume as one more.
local function flight_zones(run, options)
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
  return zones
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
  return lower, upper
end

-- The environment of a problem from the options `obstacles`, `flight_zones` and `volume`.
function M.of(run, options, keyframes)
  local obstacles = options.obstacles
  if #obstacles > MOST_OBSTACLES then
    run:fail("obstacles", string.format("%d are more than the %d that a film can keep clear of",
                                        #obstacles, MOST_OBSTACLES))
  end
  local environment = { spheres = {}, boxes = {}, zones = {}, meshes = {}, maps = {},
                        flight_zones = flight_zones(run, options), margin = options.margin }
  local lists = { sphere = environment.spheres, box = environment.boxes,
                  no_fly_zone = environment.zones, mesh = environment.meshes,
                  map = environment.maps }
  for i, given in ipairs(obstacles) do
    local made = { name = given.name ~= "" and given.name or given.file or "" }
    if given.type == "map" then made.lower, made.upper = surroundings(keyframes) end
    for form, keys in pairs(FORMS) do
      for key, needed in pairs(keys) do
        local what = string.format("obstacles[%d].%s", i, key)
        if form ~= given.type and given[key] ~= nil and FORMS[given.type][key] == nil then
          run:fail(what, "a " .. given.type .. " has none")
        elseif form == given.type and needed and given[key] == nil then
          run:fail(string.format("obstacles[%d]", i), "a " .. form .. " needs " .. key)
        elseif form == given.type then
          made[key] = given[key]
        end
      end
    end
    table.insert(lists[given.type], made)
  end
  return environment
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

-- Constraints that keep a problem clear of its environment; or within a corridor.
function M.add(p, environment, camera, corridor)
  if corridor then
    p:add_constraint { type = "corridor", regions = corridor }
  else
    for form, plugin in pairs { spheres = "sphere_obstacle", boxes = "box_obstacle",
                                zones = "no_fly_zone", flight_zones = "flight_zone" } do
      if #environment[form] > 0 then p:add_constraint { type = plugin } end
    end
    if #environment.meshes + #environment.maps > 0 then p:add_constraint { type = "clearance" } end
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
