-- SPDX-License-Identifier: Apache-2.0
-- Courses of races: gates and their directions, laps, free forms, and what is refused.
local check = require "check"
local course = require "mission.race_course"

local T = {}

local function read(options)
  options.laps, options.free_form = options.laps or 1, options.free_form or {}
  options.tolerance = options.tolerance or 0.5
  return course.read(check.run(options))
end

local function gate(more)
  local made = { shape = "rectangle", width = 2, height = 1, position = { 0, 0, 3 },
                 normal_yaw_deg = 0 }
  for name, value in pairs(more) do made[name] = value end
  return made
end

function T.directions_of_gates()
  for _, case in ipairs { { 0, 0, { 1, 0, 0 } }, { 90, nil, { 0, 1, 0 } }, { 180, 0, { -1, 0, 0 } },
                          { 0, 30, { math.sqrt(3) / 2, 0, 0.5 } },
                              { -90, -60, { 0, -0.5, -math.sqrt(3) / 2 } } }
  do
    local made = read { gates = { gate { normal_yaw_deg = case[1], normal_pitch_deg = case[2] } } }
    check.near(made.gates[1].direction, case[3], 1e-12)
  end
end

function T.a_tunnel_goes_half_before_and_half_behind()
  local made = read { gates = { gate { normal_yaw_deg = 90, tunnel_length = 4 },
                                { shape = "ball", radius = 1, position = { 9, 0, 3 } } } }
  local function place(g, share)
    local p = course.place(made.gates[g], share)
    return { p.x, p.y, p.z }
  end
  check.near(place(1, -0.5), { 0, -2, 3 }, 1e-12)
  check.near(place(1, 0.5), { 0, 2, 3 }, 1e-12)
  check.near(place(1, 0), { 0, 0, 3 }, 1e-12)
  check.near(place(2, 0.5), { 9, 0, 3 }, 1e-12, "a ball has no tunnel")
end

function T.sizes_that_do_not_fit_are_named()
  local function refused(message, given) check.fails(message, read, { gates = { given } }) end
  local place = { 0, 0, 3 }
  refused("gates[1]: a rectangle needs its width and height",
          { shape = "rectangle", width = 2, position = place, normal_yaw_deg = 0 })
  refused("gates[1].radius: a rectangle has none", gate { radius = 1 })
  refused("gates[1].normal_yaw_deg: missing", { shape = "hexagon", side = 1, position = place })
  refused("gates[1]: expected either a radius or a side",
          { shape = "hexagon", side = 1, radius = 1, position = place, normal_yaw_deg = 0 })
  refused("gates[1]: expected either a radius or a side",
          { shape = "pentagon", position = place, normal_yaw_deg = 0 })
  refused("gates[1]: a ball needs its radius", { shape = "ball", position = place })
  refused("gates[1].side: a ball has none", { shape = "ball", radius = 1, side = 2,
                                              position = place })
  for _, size in ipairs { 0, -1 } do
    refused("gates[1].width: a rectangle cannot be entered with a width of " .. size,
            gate { width = size })
  end
  refused("gates[1].normal_pitch_deg: expected degrees upwards", gate { normal_pitch_deg = 90 })
  refused("gates[1].tunnel_length: expected metres, 0 or more", gate { tunnel_length = -1 })
  for _, position in ipairs { { 1, 2 }, { 1, 2, 0 / 0 }, { 1, 2, 1 / 0 }, { 1, 2, 1e7 },
                              { 1, 2, "3" },
                              { 1, 2, 3, 4 }, "here" } do
    refused("gates[1].position: expected three finite numbers", gate { position = position })
  end
end

local function balls(count)
  local list = {}
  for i = 1, count do list[i] = { shape = "ball", radius = 1, position = { 5 * i, 0, 3 } } end
  return list
end

function T.laps_are_written_out()
  local made = read { gates = balls(3), laps = 4, closed = true }
  check.equal(#made.gates, 12)
  for i = 1, 12 do check.equal(made.gates[i].position, { 5 * ((i - 1) % 3 + 1), 0, 3 }) end
  check.equal(#read { gates = balls(3) }.gates, 3)
  check.fails("laps: laps need a closed course", read, { gates = balls(3), laps = 2 })
  check.fails("laps: more than 10000 gates in all laps", read,
              { gates = balls(3), laps = 3334, closed = true })
  check.equal(#read { gates = balls(2), laps = 5000, closed = true }.gates, 10000)
end

function T.keyframes_are_balls_of_the_tolerance()
  local made = read { keyframes = { { position = { 1, 2, 3 } }, { 4, 5, 6 } }, tolerance = 0.25 }
  check.equal(made.gates[1], { name = "keyframe 1", shape = "ball", radius = 0.25,
                               position = { 1, 2, 3 } })
  check.equal(made.gates[2].position, { 4, 5, 6 })
  check.fails("keyframes[2]: expected three finite numbers", read,
              { keyframes = { { 1, 2, 3 }, 5 } })
end

function T.a_course_is_given_in_one_way()
  check.fails("keyframes: give one course; there are gates and keyframes", read,
              { gates = balls(1), keyframes = { { 1, 2, 3 } } })
  check.fails("gates: a course needs gates, keyframes", read, {})
  check.fails("gates: a course needs gates", read, { gates = {}, keyframes = {} })
  check.fails("free_form: give one course", read,
              { gates = balls(1), free_form = { length = 9 } })
end

function T.start_and_finish()
  local made = read { gates = balls(1), start = { 1, 2, 3 },
                      finish = { position = { 4, 5, 6 }, velocity = { 0, 0, 0 } } }
  check.equal({ made.start, made.finish }, { { 1, 2, 3 }, { 4, 5, 6 } })
  check.fails("finish.velocity: a course begins and ends at rest", read,
              { gates = balls(1), finish = { position = { 4, 5, 6 }, velocity = { 0, 1, 0 } } })
  check.fails("start: expected {x, y, z}, or a position and a velocity, got 5", read,
              { gates = balls(1), start = 5 })
  check.fails("start.position: expected three", read, { gates = balls(1), start = {} })
  check.fails("start: a closed course has neither start nor finish", read,
              { gates = balls(2), closed = true, start = { 1, 2, 3 } })
  check.fails("finish: a closed course has neither", read,
              { gates = balls(2), closed = true, finish = { 1, 2, 3 } })
end

-- Two gates with a direction at one place could only be flown through at once; balls may be there.
function T.gates_stand_apart()
  check.fails("gates[2]: gates 'gates[1]' and 'gates[2]' overlap at 0 0 3", read,
              { gates = { gate {}, gate { normal_yaw_deg = 90 } } })
  check.fails("gates[1]: gates 'a' and 'a' overlap at", read,
              { gates = { gate { name = "a" } }, laps = 2, closed = true })
  read { gates = { gate {}, gate { position = { 0, 0, 3.001 } } } }
  read { gates = { gate {}, { shape = "ball", radius = 1, position = { 0, 0, 3 } } } }
end

function T.gates_reach_above_the_floor()
  check.fails("gates[1]: gate 'gates[1]' cannot be entered: it ends 3.5 m above the ground, and "
              .. "the flight stays above 4 m", read, { gates = { gate {} }, floor = 4 })
  read { gates = { gate {} }, floor = 3.4 }
  check.fails("cannot be entered", read, { gates = { gate {} }, floor = 3.5 })
  check.fails("start: 2 m above the ground, and the flight stays above 2 m", read,
              { gates = balls(1), start = { 0, 0, 2 }, floor = 2 })
end

-- The turn from point to point is bounded by the curvature, the height by half of itself.
function T.a_free_form_turns_no_faster_than_it_may()
  local made = read { free_form = { length = 300, spacing = 7, height = 10, curvature = 0.05 } }
  local points, before, left, right, sum = made.gates, nil, 0, 0, 0
  check.equal(#points, 44, "every 300 / 43 m")
  for i = 2, #points do
    local a, b = points[i - 1].position, points[i].position
    local across = math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2)
    check.near(across, 300 / 43, 1e-9, "even steps")
    local heading = math.atan(b[2] - a[2], b[1] - a[1])
    if before then
      local turn = (heading - before + math.pi) % (2 * math.pi) - math.pi
      check.yes(math.abs(turn) <= 0.05 * 300 / 43 + 1e-9, "turn " .. turn)
      if turn > 0 then left = left + 1 else right = right + 1 end
      sum = sum + math.abs(turn)
    end
    before = heading
    check.yes(b[3] >= 5 and b[3] <= 15, "height " .. b[3])
  end
  check.yes(left >= 10 and right >= 10, "it wanders to both sides")
  -- Half of the last turn, and up to a whole one by chance: about half of the limit in the mean.
  check.yes(sum / 42 > 0.2 * 0.05 * 300 / 43 and sum / 42 < 0.8 * 0.05 * 300 / 43, "mean turn")
  check.equal(points[1].position, { 0, 0, 10 })
  check.equal(points[44].name, "keyframe 44")
end

return check.all(T)
