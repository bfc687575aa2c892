-- SPDX-License-Identifier: Apache-2.0
-- The keyframes of a film in its problem: places, yaws, task, and which of them cannot be met.
local tracks = require "mission.tracks"

local M = {}

M.MISS = 0.5              -- m, allowed where `hard` says nothing
M.LATE = 0.1              -- s, by which a keyframe may be early or late; `hard` allows none

-- Keyframes with all times multiplied: places, yaws, task, and a straight guess through them.
function M.of(request, options)
  local made = { places = {}, yaws = {}, task = {}, times = {}, positions = {}, headings = {} }
  local heading = 0
  for _, k in ipairs(request.keyframes) do heading = k.yaw or heading if k.yaw then break end end
  for i, k in ipairs(request.keyframes) do
    local time = k.time * request.stretch
    heading = k.yaw or heading
    made.places[i] = { time = time, value = k.position }
    if k.yaw then made.yaws[#made.yaws + 1] = { time = time, value = { k.yaw } } end
    made.times[i], made.positions[i], made.headings[i] = time, k.position, heading
    if not k.live then  -- nobody can promise a place beside a live subject
      made.task[#made.task + 1] = { time = time, position = k.position, yaw = k.yaw,
                                    tolerance = options.hard or M.MISS,
                                    time_tolerance = options.hard and 0 or M.LATE }
    end
  end
  return made
end

-- A keyframe so deep in an obstacle, or so near to a subject, that it cannot be met.
function M.check(run, p, request, camera, bystanders)
  local options = run.options
  local reach = options.hard or M.MISS
  for i, k in ipairs(request.keyframes) do
    if k.live then goto continue end  -- the flight comes as near as it may
    local time = k.time * request.stretch
    local distance, name = p:nearest_obstacle(k.position, time)
    local function check_people(what, people)
      for _, person in ipairs(people) do
        local at = tracks.at(person.track, k.time * request.stretch)
        local away = lapwing.norm(lapwing.vector(k.position) - at)
        if person.distance and away + reach < person.distance then
          run:fail("keyframes[" .. i .. "].position", string.format(
            "%.3g m from %s '%s', and %g m are required", away, what, person.name,
            person.distance))
        end
      end
    end
    check_people("subject", camera and camera.list or {})
    check_people("bystander", bystanders)
    local outside, zone = p:flight_zone_distance(k.position, time)
    if outside + reach < options.margin then
      run:fail("keyframes[" .. i .. "].position", string.format(
        "%s flight zone '%s': %.3g m %s its edge, and %g m are required",
        outside < 0 and "outside" or "too near the edge of", zone, math.abs(outside),
        outside < 0 and "beyond" or "from", options.margin))
    end
    if distance + reach < options.margin then
      run:fail("keyframes[" .. i .. "].position", string.format(
        "%s obstacle '%s': %.3g m from its surface, and %g m are required",
        distance < 0 and "inside" or "too near", name, distance, options.margin))
    end
    ::continue::
  end
end

return M
