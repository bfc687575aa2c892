-- SPDX-License-Identifier: Apache-2.0
-- Times and unwrapped yaw angles of keyframes. Functions return new lists of keyframes and do not
-- change their arguments.
local film_keyframes = require "mission.film_keyframes"

local times = {}

local SHORTEST_LEG = 1       -- s, between keyframes without times
local SHORTEST_LEAST = 1e-3  -- s, below which nothing is known of a leg
local CERTAIN = 0.99         -- share of the least time, for the tolerances of the verifier

-- Seconds for a leg at half the vehicle's speed, and for speeding up and slowing down.
local function leg_time(from, to, vehicle)
  local d = lapwing.vector(to) - from
  local across = lapwing.norm { d.x, d.y }
  local vertical = d.z > 0 and d.z / vehicle.climb_speed or -d.z / vehicle.descent_speed
  return math.max(SHORTEST_LEG, 2 * across / vehicle.speed_across, 2 * vertical,
                  math.sqrt(8 * across / vehicle.acceleration_across))
end

times.of_leg = leg_time

-- Other keyframes with the same fields, to be completed.
local function copies(keyframes)
  local list = {}
  for i, k in ipairs(keyframes) do
    list[i] = {}
    for name, value in pairs(k) do list[i][name] = value end
  end
  return list
end

-- A speed that the vehicle has in no direction.
local function check_reach(run, what, speed, vehicle)
  if not (speed and vehicle) then return end
  local vertical = math.max(vehicle.climb_speed, vehicle.descent_speed)
  local most = lapwing.norm { vehicle.speed_across, vertical }
  if speed > most then
    run:fail(what, string.format("%g m/s; the vehicle '%s' reaches at most %.4g m/s in any "
                                 .. "direction, %g m/s across", speed, vehicle.name, most,
                                 vehicle.speed_across))
  end
end

-- A `speed`, of the film or of a leg, times keyframes that have no time: what contradicts it.
function times.check_speed(run, film)
  local o, list = run.options, film.keyframes
  local untimed, own
  for i, k in ipairs(list) do
    local what = "keyframes[" .. i .. "]"
    own = own or k.speed and what .. ".speed"
    if k.speed and i == 1 then run:fail(what .. ".speed", "no leg leads to the first keyframe") end
    check_reach(run, what .. ".speed", k.speed, film.vehicle)
    if k.speed and k.time then run:fail(what .. ".speed", "give a time or a speed") end
    if k.speed and o.speed_limit and k.speed > o.speed_limit then
      run:fail(what .. ".speed", string.format("above the speed_limit of %g m/s", o.speed_limit))
    end
    if not k.time and i > 1 then untimed = untimed or i end
    if k.time and untimed and (own or o.speed) then
      run:fail(what .. ".time", string.format(
        "keyframe %d is timed by its speed: remove this time, or give that one a time", untimed))
    end
    if i > 1 and (k.speed or o.speed) and not k.time
       and lapwing.norm(lapwing.vector(k.position) - list[i - 1].position) == 0 then
      run:fail(what, "at the place of the keyframe before: a speed gives no time; give a time")
    end
  end
  check_reach(run, "speed", o.speed, film.vehicle)
  if not (own or o.speed) then return end
  local what = own or "speed"
  if o.timing ~= "given" and o.timing ~= "time_first" then
    run:fail(what, "times keyframes of timing = \"given\"; there is speed_limit")
  end
  if not untimed then
    run:fail(what, "every keyframe has a time; give times or a speed")
  end
  if film.duration then
    run:fail(what, "the duration determines the time of the film; give a duration or a speed")
  end
  if o.speed and o.speed_limit and o.speed > o.speed_limit then
    run:fail("speed", string.format("above the speed_limit of %g m/s", o.speed_limit))
  end
end

-- Gives each leg of a list, which is completed, the time that it takes at its speed, and what
-- speeding up from rest and slowing down take besides, at half the vehicle's acceleration. Returns
-- when which speed is flown.
local function fill_at_speed(list, vehicle, options)
  local cruise = {}
  for i = 2, #list do
    local from, to = list[i - 1], list[i]
    local speed = to.speed or options.speed
    local taken = leg_time(from.position, to.position, vehicle)
    if speed then
      local ramp = speed / vehicle.acceleration_across
      local first = i == 2 and options.start == "rest" and ramp or 0
      local last = i == #list and options.finish == "rest" and ramp or 0
      taken = lapwing.norm(lapwing.vector(to.position) - from.position) / speed + first + last
      local start, finish = from.time + 2 * first, from.time + taken - 2 * last
      if not to.time and finish > start then
        cruise[#cruise + 1] = { speed = speed, start = start, finish = finish,
                                from = from.position, to = to.position }
      end
    end
    to.time = to.time or from.time + taken
  end
  return cruise
end

-- The keyframes with a time each. Those without one stand evenly between those that have one, or
-- before `duration`, where there is one. Where nothing says how fast, every leg takes as long as
-- the longest one needs. With the film's `options` speeds count; then also given is when which
-- speed is flown: {speed, start, finish, from, to}, s, m/s, m.
function times.filled(keyframes, duration, vehicle, options)
  local list, pace, known = copies(keyframes), SHORTEST_LEG, 1
  local count = #list
  local timed_by_speed = options and options.speed
  for _, k in ipairs(list) do timed_by_speed = timed_by_speed or options and k.speed end
  list[1].time = list[1].time or 0
  if timed_by_speed then return list, fill_at_speed(list, vehicle, options) end
  for i = 2, count do
    pace = math.max(pace, leg_time(list[i - 1].position, list[i].position, vehicle))
  end
  if count > 1 then list[count].time = list[count].time or duration end
  for i = 2, count do
    if list[i].time then
      local each = (list[i].time - list[known].time) / (i - known)
      for j = known + 1, i - 1 do list[j].time = list[known].time + each * (j - known) end
      known = i
    end
  end
  for j = known + 1, count do list[j].time = list[known].time + pace * (j - known) end
  return list, {}
end

-- Keyframes with times: what contradicts them, or the duration.
function times.check(run, keyframes, duration)
  for i, k in ipairs(keyframes) do
    local before = keyframes[i - 1]
    local problem
    if before and k.time == before.time then
      problem = string.format("%g s is also the time of keyframe %d; times must rise", k.time,
                              i - 1)
    elseif before and k.time < before.time then
      problem = string.format("%g s comes before keyframe %d at %g s; times must rise", k.time,
                              i - 1, before.time)
    elseif duration and k.time > duration then
      problem = string.format("%g s is outside the duration of %g s", k.time, duration)
    end
    if problem then run:fail("keyframes[" .. i .. "].time", problem) end
  end
end

-- The keyframes with their yaw in radians, each on the turn nearest to the one before.
function times.with_yaw(keyframes)
  local list, before = copies(keyframes), nil
  for _, k in ipairs(list) do
    if k.yaw_deg then
      local yaw = math.rad(k.yaw_deg)
      local turns = before and math.floor((yaw - before) / (2 * math.pi) + 0.5) or 0
      k.yaw = yaw - 2 * math.pi * turns
      before = k.yaw
    end
  end
  return list
end

-- The least factor on all times at which no leg asks for more than the vehicle's speeds, when each
-- end may be missed by `miss` metres and `late` seconds; and a sentence where a leg asks for more.
function times.fastest_leg(keyframes, vehicle, miss, late, speed_limit)
  local least, sentence = 0, nil
  for i = 2, #keyframes do
    local a, b = keyframes[i - 1], keyframes[i]
    local d = lapwing.vector(b.position) - a.position
    local asked = { speed_across = lapwing.norm { d.x, d.y }, climb_speed = d.z,
                    descent_speed = -d.z }
    if speed_limit then asked.speed_limit = lapwing.norm(d) end
    for name, distance in pairs(asked) do
      local limit, span = name == "speed_limit" and speed_limit or vehicle[name], b.time - a.time
      local factor = ((distance - 2 * miss) / limit - 2 * late) / span
      if factor > least then
        least = factor
        sentence = distance / span > limit and string.format(
          "%s of %.3g m/s from keyframe %d to %d exceeds %g m/s at %.4g s", name, distance / span,
          i - 1, i, limit, a.time) or nil
      end
    end
  end
  return least, sentence
end

-- Seconds that a leg between two keyframes takes at least: straight ahead at the speeds of the
-- vehicle, each end missed as far as the certificate allows, and early or late by `late` s.
-- `ends`: {first, last}, whether the film begins or ends with the leg.
function times.least_of_leg(from, to, vehicle, options, ends, late)
  local d = lapwing.vector(to.position) - from.position
  local miss = options.hard or film_keyframes.MISS
  local function left(distance) return math.max(0, distance - 2 * miss) end
  local across, speed = left(lapwing.norm { d.x, d.y }), vehicle.speed_across
  local least = across / speed
  local rests = (ends.first and options.start == "rest" and 1 or 0)
    + (ends.last and options.finish == "rest" and 1 or 0)
  -- Models without forces have their speed at once. Others reach it after v^2 / 2a metres.
  if options.model.type == "quadrotor" and rests > 0 then
    local a = vehicle.acceleration_across
    if 2 * a * across <= rests * speed ^ 2 then
      least = math.sqrt(2 * rests * across / a)
    else
      least = least + rests * speed / (2 * a)
    end
  end
  least = math.max(least, left(d.z) / vehicle.climb_speed, left(-d.z) / vehicle.descent_speed)
  if options.speed_limit then
    least = math.max(least, left(lapwing.norm(d)) / options.speed_limit)
  end
  return math.max(SHORTEST_LEAST, CERTAIN * least - 2 * late)
end

-- s, that one battery lasts.
function times.battery(run, vehicle) return run.options.battery or vehicle.flight_time end

-- Refuses a flight of `duration` seconds that is longer than the battery lasts.
function times.check_battery(run, vehicle, duration)
  local battery = times.battery(run, vehicle)
  if duration <= battery then return end
  run:fail("duration", string.format("%.4g s of flight are more than the %g s that %s", duration,
    battery, run.options.battery and "`battery` allows"
    or "vehicle '" .. vehicle.name .. "' has in one battery"))
end

return times
