-- SPDX-License-Identifier: Apache-2.0
-- Times of keyframes: what is filled in, what contradicts itself, turns of yaw, and how fast a leg
-- may be.
local check = require "check"
local times = require "mission.keyframe_times"

local T = {}

local VEHICLE = { name = "test", speed_across = 10, climb_speed = 4, descent_speed = 2,
                  acceleration_across = 5, flight_time = 600 }

local function at(x, y, z, more)
  local k = { position = { x, y, z } }
  for name, value in pairs(more or {}) do k[name] = value end
  return k
end

local function times_of(list)
  local found = {}
  for i, k in ipairs(list) do found[i] = k.time end
  return found
end

local function filled(list, duration, options)
  return times_of((times.filled(list, duration, VEHICLE, options)))
end

function T.untimed_legs_take_as_long_as_the_longest_needs()
  -- Across at half the speed: 100 m in 20 s; climbing 20 m at half of 4 m/s in 10 s.
  check.near(filled { at(0, 0, 0), at(100, 0, 0), at(100, 0, 20) }, { 0, 20, 40 }, 1e-12)
  check.near(filled { at(0, 0, 0), at(0, 0, 20) }, { 0, 10 }, 1e-12)
  check.near(filled { at(0, 0, 20), at(0, 0, 0) }, { 0, 20 }, 1e-12, "down at half of 2 m/s")
  -- A short leg is one of speeding up and slowing down: sqrt(8 d / a).
  check.near(filled { at(0, 0, 0), at(3, 4, 0) }, { 0, math.sqrt(8) }, 1e-12)
  check.near(filled { at(0, 0, 0), at(0, 0, 0.1) }, { 0, 1 }, 1e-12, "the shortest leg")
  check.near(filled { at(0, 0, 0) }, { 0 }, 0)
  check.near(filled({ at(0, 0, 0) }, 9), { 0 }, 0, "one keyframe keeps its time")
end

function T.untimed_ones_stand_evenly_between_timed_ones()
  local a, b, c, d = at(0, 0, 0), at(1, 0, 0), at(2, 0, 0), at(3, 0, 0)
  check.near(filled({ a, b, c, d }, 12), { 0, 4, 8, 12 }, 1e-12)
  check.near(filled({ a, at(1, 0, 0, { time = 6 }), c, d }, 12), { 0, 6, 9, 12 }, 1e-12)
  check.near(filled({ a, b, at(2, 0, 0, { time = 5 }), d }, 12), { 0, 2.5, 5, 12 }, 1e-12)
  check.near(filled({ at(0, 0, 0, { time = 2 }), b, at(2, 0, 0, { time = 8 }) }), { 2, 5, 8 },
             1e-12)
  -- Behind the last time, at the pace of the longest leg: here sqrt(8 / 5) s of every metre.
  local pace = math.sqrt(8 / 5)
  check.near(filled { a, at(1, 0, 0, { time = 5 }), c, d }, { 0, 5, 5 + pace, 5 + 2 * pace }, 1e-12)
end

-- Keyframes may be missed by 0.5 m each: 51 m are 50 m. Of what follows the tolerances of the
-- verifier take 1 %.
function T.a_leg_takes_at_least_what_straight_flight_takes()
  local options = { start = "rest", finish = "rest", model = { type = "quadrotor" } }
  local function least(to, ends, late, more)
    local all = {}
    for name, value in pairs(options) do all[name] = value end
    for name, value in pairs(more or {}) do all[name] = value end
    return times.least_of_leg(at(0, 0, 0), to, VEHICLE, all, ends or {}, late or 0)
  end
  check.near(least(at(51, 0, 0)), 0.99 * 5, 1e-12, "at 10 m/s")
  check.near(least(at(51, 0, 0), nil, 0.1), 0.99 * 5 - 0.2, 1e-12, "late at the end, early before")
  -- At rest, 10 m/s are reached after 10 m and 2 s.
  check.near(least(at(51, 0, 0), { first = true }), 0.99 * 6, 1e-12)
  check.near(least(at(51, 0, 0), { first = true, last = true }), 0.99 * 7, 1e-12)
  check.near(least(at(9, 0, 0), { last = true }), 0.99 * math.sqrt(2 * 8 / 5), 1e-12)
  check.near(least(at(9, 0, 0), { first = true, last = true }), 0.99 * 2 * math.sqrt(8 / 5), 1e-12)
  check.near(least(at(51, 0, 0), { first = true }, 0, { start = "moving" }), 0.99 * 5, 1e-12)
  check.near(least(at(51, 0, 0), { first = true }, 0, { model = { type = "velocity" } }), 0.99 * 5,
             1e-12)
  check.near(least(at(51, 0, 0), {}, 0, { speed_limit = 4 }), 0.99 * 12.5, 1e-12)
  check.near(least(at(50, 0, 0), {}, 0, { hard = 0.01 }), 0.99 * 49.98 / 10, 1e-12)
  check.near(least(at(3, 0, 9)), 0.99 * 2, 1e-12, "up at 4 m/s")
  check.near(least(at(3, 0, -9)), 0.99 * 4, 1e-12, "down at 2 m/s")
  check.near(least(at(0.5, 0, 0), {}, 0.1), 1e-3, 1e-12, "nothing is known")
end

function T.what_is_given_is_not_changed()
  local list = { at(0, 0, 0), at(9, 0, 0), at(9, 9, 0, { yaw_deg = 20, look_at = { 1, 2, 3 } }) }
  local result = times.filled(list, 30, VEHICLE)
  for _, k in ipairs(list) do check.equal(k.time, nil) end
  check.equal(result[3].yaw_deg, 20)
  check.equal(result[3].look_at, { 1, 2, 3 })
  times.with_yaw(list)
  check.equal(list[3].yaw, nil)
end

-- d / v, and half the vehicle's acceleration used to reach v from rest and to leave it: v / a more.
function T.a_speed_times_legs()
  local legs = { at(0, 0, 0), at(30, 0, 40), at(30, 0, 90) }
  local free = { speed = 5, start = "free", finish = "free" }
  check.near(filled(legs, nil, free), { 0, 10, 20 }, 1e-12)
  check.near(filled(legs, nil, { speed = 5, start = "rest", finish = "rest" }), { 0, 11, 22 },
             1e-12)
  check.near(filled(legs, nil, { speed = 5, start = "rest", finish = "free" }), { 0, 11, 21 },
             1e-12)
  -- One leg's own speed; the others as they like.
  legs[3].speed = 10
  check.near(filled(legs, nil, free), { 0, 10, 15 }, 1e-12)
  local slow = filled({ at(0, 0, 0), at(100, 0, 0), at(100, 0, 10, { speed = 1 }) }, nil,
                      { start = "free", finish = "free" })
  check.near(slow, { 0, 20, 30 }, 1e-12, "the leg without a speed by itself")
end

-- While speeding up and slowing down no speed is promised.
function T.when_a_speed_is_flown()
  local list = { at(0, 0, 0), at(50, 0, 0), at(100, 0, 0) }
  local _, cruise = times.filled(list, nil, VEHICLE, { speed = 5, start = "rest", finish = "rest" })
  check.near(cruise, { { speed = 5, start = 2, finish = 11, from = { 0, 0, 0 }, to = { 50, 0, 0 } },
                       { speed = 5, start = 11, finish = 20, from = { 50, 0, 0 },
                         to = { 100, 0, 0 } } }, 1e-12)
  -- Too short a leg has no such time at all.
  local _, none = times.filled({ at(0, 0, 0), at(4, 0, 0) }, nil, VEHICLE,
                               { speed = 5, start = "rest", finish = "rest" })
  check.equal(none, {})
  local _, still = times.filled(list, 10, VEHICLE, { start = "rest", finish = "rest" })
  check.equal(still, {}, "no speed was asked for")
end

local function refused(message, options, keyframes, duration)
  options.timing = options.timing or "given"
  check.fails(message, times.check_speed, check.run(options),
              { keyframes = keyframes, duration = duration })
end

function T.contradicted_speeds_are_named()
  local a, b = at(0, 0, 0), at(9, 0, 0)
  refused("keyframes[1].speed: no leg leads to the first", {}, { at(0, 0, 0, { speed = 3 }), b })
  refused("keyframes[2].speed: give a time or a speed", {},
          { a, at(9, 0, 0, { speed = 3, time = 4 }) })
  refused("keyframes[2].speed: above the speed_limit of 2 m/s", { speed_limit = 2 },
          { a, at(9, 0, 0, { speed = 3 }) })
  refused("speed: above the speed_limit of 2 m/s", { speed = 3, speed_limit = 2 }, { a, b })
  refused("keyframes[3].time: keyframe 2 is timed by its speed", { speed = 3 },
          { a, b, at(20, 0, 0, { time = 9 }) })
  refused("keyframes[2]: at the place of the keyframe before", { speed = 3 }, { a, at(0, 0, 0) })
  refused("speed: times keyframes of timing = \"given\"", { speed = 3, timing = "free" }, { a, b })
  refused("keyframes[2].speed: times keyframes", { timing = "path_first" },
          { a, at(9, 0, 0, { speed = 1 }) })
  refused("speed: every keyframe has a time", { speed = 3 }, { a, at(9, 0, 0, { time = 3 }) })
  refused("speed: the duration determines the time", { speed = 3 }, { a, b }, 20)
  times.check_speed(check.run { speed = 3, speed_limit = 3, timing = "given" },
                    { keyframes = { a, b } })
  times.check_speed(check.run { timing = "free" }, { keyframes = { a, a } })
end

function T.times_must_rise_and_end_in_time()
  local function judged(list, duration)
    local keyframes = {}
    for i, time in ipairs(list) do keyframes[i] = { time = time } end
    return times.check(check.run(), keyframes, duration)
  end
  judged({ 0, 1, 2 }, 2)
  judged({ 3 }, nil)
  check.fails("keyframes[3].time: 1 s is also the time of keyframe 2", judged, { 0, 1, 1 })
  check.fails("keyframes[2].time: 1 s comes before keyframe 1 at 2 s", judged, { 2, 1 })
  check.fails("keyframes[2].time: 9.5 s is outside the duration of 9 s", judged, { 2, 9.5 }, 9)
end

function T.yaw_goes_the_short_way()
  local function turns(list)
    local keyframes, yaws = {}, {}
    for i, yaw in ipairs(list) do keyframes[i] = { yaw_deg = yaw or nil } end
    for i, k in ipairs(times.with_yaw(keyframes)) do
      yaws[i] = k.yaw and math.deg(k.yaw) or false
    end
    return yaws
  end
  check.near(turns { 170, -170, 170 }, { 170, 190, 170 }, 1e-9)
  check.near(turns { 0, 90, 180, 270, 0, 90 }, { 0, 90, 180, 270, 360, 450 }, 1e-9)
  check.near(turns { 10, false, 350 }, { 10, false, -10 }, 1e-9)
  check.near(turns { 720, 0 }, { 720, 720 }, 1e-9, "the first is as it was given")
  check.near(turns { 0, 3599 }, { 0, -1 }, 1e-9)
  for k, yaw in ipairs(turns { 5, 184, 3, -178, 91, -300 }) do
    check.near((yaw - ({ 5, 184, 3, -178, 91, -300 })[k]) / 360 % 1, 0, 1e-9, "whole turns")
  end
end

function T.how_much_slower_the_fastest_leg_must_be()
  local function fastest(list, miss, late, limit)
    return times.fastest_leg(list, VEHICLE, miss or 0, late or 0, limit)
  end
  local leg = { at(0, 0, 0, { time = 1 }), at(30, 40, 0, { time = 3 }) }
  local factor, sentence = fastest(leg)
  check.near(factor, 2.5, 1e-12)
  check.equal(sentence, "speed_across of 25 m/s from keyframe 1 to 2 exceeds 10 m/s at 1 s")
  -- Missing both ends by 5 m and 0.5 s: (50 - 10) / 10 - 1 of 2 s.
  check.near(fastest(leg, 5, 0.5), 1.5, 1e-12)
  factor, sentence = fastest { at(0, 0, 0, { time = 0 }), at(0, 0, 8, { time = 1 }) }
  check.near(factor, 2, 1e-12)
  check.yes(sentence:find("climb_speed of 8 m/s", 1, true), sentence)
  factor, sentence = fastest { at(0, 0, 8, { time = 0 }), at(0, 0, 0, { time = 1 }) }
  check.near(factor, 4, 1e-12)
  check.yes(sentence:find("descent_speed of 8 m/s", 1, true), sentence)
  -- A limit of one's own holds for the whole speed, upwards too.
  factor, sentence = fastest({ at(0, 0, 0, { time = 0 }), at(3, 0, 4, { time = 5 }) }, 0, 0, 0.5)
  check.near(factor, 2, 1e-12)
  check.yes(sentence:find("speed_limit of 1 m/s", 1, true), sentence)
  factor, sentence = fastest { at(0, 0, 0, { time = 0 }), at(5, 0, 0, { time = 1 }) }
  check.near(factor, 0.5, 1e-12)
  check.equal(sentence, nil, "slow enough")
  check.equal({ fastest { at(0, 0, 0, { time = 0 }) } }, { 0 })
end

function T.a_battery_lasts_as_long_as_it_does()
  times.check_battery(check.run(), VEHICLE, 600)
  check.fails("duration: 601 s of flight are more than the 600 s that vehicle 'test' has in one "
              .. "battery",
              times.check_battery, check.run(), VEHICLE, 601)
  times.check_battery(check.run { battery = 700 }, VEHICLE, 601)
  check.fails("700 s that `battery` allows", times.check_battery, check.run { battery = 700 },
              VEHICLE,
              701)
end

return check.all(T)
