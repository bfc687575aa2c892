-- SPDX-License-Identifier: Apache-2.0
-- A kind of mission that the library does not have: the inspection of a facade. The camera keeps
-- its distance, looks along the normal of the wall, and goes over it as a lawn is mown.
--   lapwing run examples/facade/facade.lua
--   lapwing run examples/facade/facade.lua --set wall.width=20 --set overlap=0.8
local options = lapwing.options({
  { name = "vehicle", type = "vehicle", default = "vehicles/solo", summary = "file or table" },
  { name = "wall", type = "table", summary = "a rectangle on the ground", table = {
    { name = "corner", type = "numbers", size = 3, unit = "m", default = {0, 0, 0},
      summary = "its left foot, seen from outside: east, north, up" },
    { name = "normal_deg", type = "number", unit = "deg", default = -90, summary = "it faces" },
    { name = "width", type = "number", unit = "m", default = 12, above = 0, summary = "along" },
    { name = "height", type = "number", unit = "m", default = 8, above = 0, summary = "up" } } },
  { name = "stand_off", type = "number", unit = "m", default = 4, minimum = 1, maximum = 100,
    summary = "from the wall" },
  { name = "overlap", type = "number", default = 0.6, minimum = 0, maximum = 0.95,
    summary = "share of a picture that the next row sees again" },
  { name = "speed", type = "number", unit = "m/s", default = 1.5, above = 0, summary = "along it" },
  { name = "solver", type = "plugin", kind = "trajectory_solver", default = "iqp",
    summary = "trajectory solver" },
}, {})

-- Rows from the top down, every second one backwards: {time, position} at their ends.
local function mown(o, out, along, rows, top)
  local stops, time = {}, 0
  for row = 1, rows do
    local up = rows > 1 and top - (row - 1) * (top - 1.5) / (rows - 1) or top
    for _, side in ipairs(row % 2 == 1 and { 0, 1 } or { 1, 0 }) do
      local at = {}
      for i = 1, 2 do
        at[i] = o.wall.corner[i] + o.stand_off * out[i] + side * o.wall.width * along[i]
      end
      at[3] = o.wall.corner[3] + up
      local before = stops[#stops] and stops[#stops].position or at
      local apart = lapwing.norm(lapwing.vector(at) - lapwing.vector(before))
      time = time + apart / o.speed + (#stops > 0 and 2 or 0)  -- 2 s for the turn
      stops[#stops + 1] = { time = time, position = at }
    end
  end
  return stops
end

local function plan(run)
  local o = run.options
  local vehicle = run:vehicle(o.vehicle)
  local normal = math.rad(o.wall.normal_deg)
  local out, along = { math.cos(normal), math.sin(normal) }, { -math.sin(normal), math.cos(normal) }
  local seen = 2 * o.stand_off * math.tan(vehicle.half_view.up)  -- m of wall, from top to bottom
  local rows = math.max(1, math.ceil(o.wall.height / (seen * (1 - o.overlap))))
  local stops = mown(o, out, along, rows, math.max(1.5, o.wall.height))
  local facing = normal + math.pi  -- against the normal
  local p = run:problem { vehicle = vehicle, duration = stops[#stops].time, step = 0.2 }
  p:add_model { type = "quadrotor" }
  local places, guess = {}, { times = {}, positions = {}, yaws = {} }
  for i, stop in ipairs(stops) do
    places[i] = { time = stop.time, value = stop.position }
    guess.times[i], guess.positions[i], guess.yaws[i] = stop.time, stop.position, facing
  end
  p:add_cost { type = "keyframe", weight = 100, keyframes = places }
  p:add_cost { type = "derivative", block = "force", order = 2, weight = 1e-3 }
  p:add_cost { name = "stand_off", weight = 20, residual = function(s)  -- m from where it should be
    local away = s.position - o.wall.corner
    return away.x * out[1] + away.y * out[2] - o.stand_off
  end }
  p:add_cost { name = "normal", weight = 20, residual = function(s) return s.yaw - facing end }
  p:add_constraint { type = "input_limits", across = "extent" }
  p:add_constraint { type = "state_limits" }
  p:add_constraint { type = "boundary_state", start = "rest", finish = "rest", start_yaw = facing }
  p:guess_path(guess)
  p:finish()
  local task = { keyframes = {} }
  for i, stop in ipairs(stops) do
    task.keyframes[i] = { time = stop.time, position = stop.position, yaw = facing,
                          tolerance = 0.5, time_tolerance = 0.1 }
  end
  return run:plan { solution = run:solve(p, o.solver), task = task }
end

return { kind = "facade", name = "facade", options = options, plan = plan }
