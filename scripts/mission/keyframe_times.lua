-- When keyframes are flown through, and with which turn of yaw.
local times = {}

local SHORTEST_LEG = 1  -- s, between keyframes without times

-- Seconds for a leg at half the vehicle's speed, and for speeding up and slowing down.
local function leg_time(from, to, vehicle)
  local across = math.sqrt((to[1] - from[1]) ^ 2 + (to[2] - from[2]) ^ 2)
  local up = to[3] - from[3]
  local vertical = up > 0 and up / vehicle.climb_speed or -up / vehicle.descent_speed
  return math.max(SHORTEST_LEG, 2 * across / vehicle.speed_across, 2 * vertical,
                  math.sqrt(8 * across / vehicle.acceleration_across))
end

local function length(a, b)
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
end

-- A `speed`, of the film or of a leg, times keyframes that have no time: what contradicts it.
local function check_speed(run, shot)
  local o, list = run.options, shot.keyframes
  local untimed, own
  for i, k in ipairs(list) do
    local what = "keyframes[" .. i .. "]"
    own = own or k.speed and what .. ".speed"
    if k.speed and i == 1 then run:fail(what .. ".speed", "no leg leads to the first keyframe") end
    if k.speed and k.time then run:fail(what .. ".speed", "give a time or a speed") end
    if k.speed and o.speed_limit and k.speed > o.speed_limit then
      run:fail(what .. ".speed", string.format("above the speed_limit of %g m/s", o.speed_limit))
    end
    if not k.time and i > 1 then untimed = untimed or i end
    if k.time and untimed and (own or o.speed) then
      run:fail(what .. ".time", string.format(
        "keyframe %d is timed by its speed: give this one no time, or that one a time", untimed))
    end
    if i > 1 and (k.speed or o.speed) and not k.time
       and length(k.position, list[i - 1].position) == 0 then
      run:fail(what, "at the place of the one before: no speed says how long it takes; give a time")
    end
  end
  if not (own or o.speed) then return end
  local what = own or "speed"
  if o.timing ~= "given" and o.timing ~= "time_first" then
    run:fail(what, "times keyframes of timing = \"given\"; there is speed_limit")
  end
  if not untimed then
    run:fail(what, "every keyframe has a time; give times or a speed")
  end
  if shot.duration then
    run:fail(what, "the duration says how long the film takes; give a duration or a speed")
  end
  if o.speed and o.speed_limit and o.speed > o.speed_limit then
    run:fail("speed", string.format("above the speed_limit of %g m/s", o.speed_limit))
  end
end
times.check_speed = check_speed

-- Each leg at its speed, and what speeding up from rest and slowing down take besides; at half the
-- vehicle's acceleration. Notes in shot.cruise when which speed is flown.
local function fill_at_speed(shot, vehicle, options)
  local list = shot.keyframes
  shot.cruise = {}
  for i = 2, #list do
    local speed = list[i].speed or options.speed
    local taken = leg_time(list[i - 1].position, list[i].position, vehicle)
    if speed then
      local ramp = speed / vehicle.acceleration_across
      local first = i == 2 and options.start == "rest" and ramp or 0
      local last = i == #list and options.finish == "rest" and ramp or 0
      taken = length(list[i].position, list[i - 1].position) / speed + first + last
      local from, to = list[i - 1].time + 2 * first, list[i - 1].time + taken - 2 * last
      if not list[i].time and to > from then
        shot.cruise[#shot.cruise + 1] = { speed = speed, start = from, finish = to,
                                          from = list[i - 1].position, to = list[i].position }
      end
    end
    list[i].time = list[i].time or list[i - 1].time + taken
  end
end

-- Keyframes without a time stand evenly between those that have one. Where nothing says how fast,
-- every leg takes as long as the longest one needs. With the film's `options` speeds count.
function times.fill(shot, vehicle, options)
  local list, pace, known = shot.keyframes, SHORTEST_LEG, 1
  local count = #list
  local timed_by_speed = options and options.speed
  for _, k in ipairs(list) do timed_by_speed = timed_by_speed or options and k.speed end
  if timed_by_speed then
    list[1].time = list[1].time or 0
    return fill_at_speed(shot, vehicle, options)
  end
  for i = 2, count do
    pace = math.max(pace, leg_time(list[i - 1].position, list[i].position, vehicle))
  end
  list[1].time = list[1].time or 0
  if count > 1 then list[count].time = list[count].time or shot.duration end
  for i = 2, count do
    if list[i].time then
      local each = (list[i].time - list[known].time) / (i - known)
      for j = known + 1, i - 1 do list[j].time = list[known].time + each * (j - known) end
      known = i
    end
  end
  for j = known + 1, count do list[j].time = list[known].time + pace * (j - known) end
end

function times.check(run, shot)
  for i, k in ipairs(shot.keyframes) do
    local before = shot.keyframes[i - 1]
    local problem
    if before and k.time == before.time then
      problem = string.format("%g s is keyframe %d's time as well; times must rise", k.time, i - 1)
    elseif before and k.time < before.time then
      problem = string.format("%g s comes before keyframe %d at %g s; times must rise", k.time,
                              i - 1, before.time)
    elseif shot.duration and k.time > shot.duration then
      problem = string.format("%g s is outside the duration of %g s", k.time, shot.duration)
    end
    if problem then run:fail("keyframes[" .. i .. "].time", problem) end
  end
end

-- Yaw in radians, each on the turn nearest to the one before.
function times.unwrap_yaw(keyframes)
  local before
  for _, k in ipairs(keyframes) do
    if k.yaw_deg then
      k.yaw = math.rad(k.yaw_deg)
      local turns = before and math.floor((k.yaw - before) / (2 * math.pi) + 0.5) or 0
      k.yaw = k.yaw - 2 * math.pi * turns
      before = k.yaw
    end
  end
end

-- The least factor on all times at which no leg asks for more than the vehicle's speeds, when each
-- end may be missed by `miss` metres and `late` seconds; and a sentence where a leg asks for more.
function times.fastest_leg(keyframes, vehicle, miss, late, speed_limit)
  local least, sentence = 0, nil
  for i = 2, #keyframes do
    local a, b = keyframes[i - 1], keyframes[i]
    local up = b.position[3] - a.position[3]
    local across = math.sqrt((b.position[1] - a.position[1]) ^ 2
                             + (b.position[2] - a.position[2]) ^ 2)
    local asked = { speed_across = across, climb_speed = up, descent_speed = -up }
    if speed_limit then asked.speed_limit = length(a.position, b.position) end
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

-- A flight that is longer than the battery lasts is none.
function times.check_battery(run, shot, stretch)
  local battery = run.options.battery or shot.vehicle.flight_time
  if shot.duration * stretch <= battery then return end
  run:fail("duration", string.format("%.4g s of flight are more than the %g s that %s",
    shot.duration * stretch, battery, run.options.battery and "`battery` allows"
    or "vehicle '" .. shot.vehicle.name .. "' flies on one battery"))
end

return times
