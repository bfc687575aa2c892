-- SPDX-License-Identifier: Apache-2.0
-- Which look follows which, cuts between looks, and what the camera is asked for over a film.
local check = require "check"
local looks = require "mission.looks"
local subjects = require "mission.subjects"

local T = {}

local function still(name, x, y, z)
  return { name = name, track = { { time = 0, position = { x, y, z } } }, still = true, height = 0,
           width = 0, option = "subjects[1]" }
end

local A, B = still("a", 0, 10, 0), still("b", 20, 10, 0)
local BY_NAME = { a = A, b = B }

local function k(time, subject, point)
  return { time = time, position = { time, 0, 0 }, subject = subject, look_at = point }
end

-- "a 0, b 5, 1 2 3 9": what is looked at when.
local function shown(list)
  local parts = {}
  for i, look in ipairs(list) do
    parts[i] = (look.subject and look.subject.name or table.concat(look.point, " ")) .. " "
        .. look.time
  end
  return table.concat(parts, ", ")
end

local function of(keyframes, list)
  local found = looks.of(check.run(), keyframes, list or { A, B }, BY_NAME)
  return found and shown(found) or "nothing"
end

function T.keyframes_look_as_the_one_before()
  check.equal(of { k(0, "a"), k(2), k(4, "b"), k(6) }, "a 0, a 2, b 4, b 6")
  check.equal(of { k(0), k(2), k(4, "b") }, "b 0, b 2, b 4",
              "the first that looks, for those before")
  check.equal(of { k(0), k(2, nil, { 1, 2, 3 }), k(4), k(6, "a") },
              "1 2 3 0, 1 2 3 2, 1 2 3 4, a 6")
  check.equal(of({ k(0), k(2) }, { A }), "a 0, a 2", "a subject alone needs no word")
  check.equal(of({ k(0), k(2) }, {}), "nothing")
end

function T.wrong_looks_are_named()
  check.fails("keyframes[2].look_at: give a subject or a point", of,
              { k(0), k(1, "a", { 1, 2, 3 }) })
  check.fails("keyframes[1].look_at: no subject is named 'c'", of, { k(0, "c") })
  check.fails("subjects: with several, keyframes select one: look_at = \"a\"", of, { k(0) })
end

local function schedule(list, duration, cuts)
  local spans, points = looks.schedule(list, duration, cuts or {})
  local made = {}
  for i, s in ipairs(spans) do made[i] = { s.subject.name, s.start, s.finish } end
  return made, points
end

local function at(time, subject, point) return { time = time, subject = subject, point = point } end

function T.the_camera_goes_over_within_the_leg()
  -- A leg of 10 s: 3 s in its middle; a leg of 4 s: half of it.
  check.near(schedule({ at(0, A), at(10, B) }, 12), { { "a", 0, 3.5 }, { "b", 6.5, 12 } }, 1e-12)
  check.near(schedule({ at(1, A), at(5, B) }, 6), { { "a", 0, 2 }, { "b", 4, 6 } }, 1e-12)
  check.near(schedule({ at(0, A), at(5, A), at(9, A) }, 10), { { "a", 0, 10 } }, 1e-12)
  check.near(schedule({ at(0, A), at(10, B), at(20, A) }, 20),
             { { "a", 0, 3.5 }, { "b", 6.5, 13.5 }, { "a", 16.5, 20 } }, 1e-12)
end

function T.points_are_looked_at_on_the_way()
  local spans, points = schedule({ at(0, A), at(10, nil, { 1, 2, 3 }), at(20, B) }, 20)
  check.near(spans, { { "a", 0, 3.5 }, { "b", 16.5, 20 } }, 1e-12)
  check.equal(points, { { time = 10, position = { 1, 2, 3 } } })
end

function T.in_a_cut_it_jumps()
  local cuts = { { start = 4, finish = 4.5 } }
  check.near(schedule({ at(0, A), at(10, B) }, 12, cuts), { { "a", 0, 4 }, { "b", 4.5, 12 } },
             1e-12)
  -- A cut on another leg changes nothing, one that reaches past its leg ends with it.
  check.near(schedule({ at(0, A), at(3, A), at(13, B) }, 13, { { start = 1, finish = 2 } }),
             { { "a", 0, 6.5 }, { "b", 9.5, 13 } }, 1e-12)
  check.near(schedule({ at(0, A), at(10, B) }, 12, { { start = 9, finish = 11 } }),
             { { "a", 0, 9 }, { "b", 10, 12 } }, 1e-12)
end

local VEHICLE = { yaw_rate = 1, gimbal = { yaw_rate = 1, pitch_rate = 0.5, pitch_min = -1.5,
                                           pitch_max = 0.5 }, half_view = { up = 0.3 } }

local function cuts(given, stretch, duration)
  local path = { { time = 0, position = { 10, 0, 0 } } }
  return looks.cuts(check.run(), given, stretch or 1, duration or 20, VEHICLE, path,
                    { at(0, A), at(10, B) })
end

function T.a_cut_lasts_as_long_as_the_turn()
  check.equal(cuts { { start = 2, finish = 3 } }, { { start = 2, finish = 3 } })
  check.equal(cuts({ { start = 2, finish = 3 } }, 2), { { start = 4, finish = 6 } })
  -- From a, 45 degrees to the left, to b, 45 to the right: a quarter turn at 2 rad/s.
  check.near(cuts { { start = 2 } }, { { start = 2, finish = 2 + math.pi / 4 } }, 1e-9)
  -- Straight up by 45 degrees at 0.5 rad/s, where the gimbal takes longer than the yaw.
  local up = looks.cuts(check.run(), { { start = 2 } }, 1, 20, VEHICLE,
                        { { time = 0, position = { 0, 0, 0 } } },
                        { at(0, A), at(10, still("up", 0, 10, 10)) })
  check.near(up, { { start = 2, finish = 2 + math.pi / 2 } }, 1e-9)
  -- Behind the last look there is nothing to turn to: the least cut.
  check.near(cuts { { start = 15 } }, { { start = 15, finish = 15.2 } }, 1e-9)
end

function T.wrong_cuts_are_named()
  check.fails("cuts[1].finish: a cut ends after it starts", cuts, { { start = 2, finish = 2 } })
  check.fails("cuts[1]: ends at 21 s, after the film's 20 s", cuts, { { start = 2, finish = 21 } })
  check.fails("cuts[2].start: cuts must be in order and must not overlap", cuts,
              { { start = 2, finish = 3 }, { start = 3, finish = 4 } })
  check.fails("cuts[2].start: cuts must be in order", cuts,
              { { start = 5, finish = 6 }, { start = 2, finish = 3 } })
end

function T.tracks_must_cover_what_is_looked_at()
  local walker = { name = "w", option = "subjects[3]",
                   track = { { time = 1, position = { 0, 0, 0 } },
                             { time = 5, position = { 1, 0, 0 } } } }
  local function covered(start, finish)
    looks.check_coverage(check.run(), { { subject = walker, start = start, finish = finish } })
  end
  covered(1, 5)
  covered(2, 3)
  check.fails("subjects[3].track: runs from 1 s to 5 s, but 'w' is looked at from 0 s to 3 s",
              covered,
              0, 3)
  check.fails("looked at from 2 s to 5.5 s", covered, 2, 5.5)
  looks.check_coverage(check.run(), { { subject = A, start = 0, finish = 99 } })
end

local function plan(request, duration)
  request.stretch, request.cuts = request.stretch or 1, request.cuts or {}
  request.vehicle = VEHICLE
  return subjects.plan(check.run(), request, duration)
end

function T.a_plan_pulls_the_target_to_its_subject()
  local walk = { { time = 0, position = { 0, 10, 0 } }, { time = 10, position = { 10, 10, 0 } } }
  local camera = plan({ subjects = { { name = "w", track = walk } }, keyframes = { k(0), k(10) } },
                      10)
  check.equal(#camera.spans, 1)
  local weight = 0
  for i, pull in ipairs(camera.pulls) do
    check.near(pull.value.x or pull.value[1], pull.time, 1e-9, "on the track")
    weight = weight + pull.weight
    if i > 1 then check.yes(pull.time > camera.pulls[i - 1].time, "in order") end
  end
  check.equal(#camera.pulls, 41, "four a second, both ends")
  check.near(weight, 10 * 41 / 40, 1e-9, "each for its share of the span")
  -- The camera flies beside the walker and looks straight north all the time.
  check.equal(#camera.guess.times, 41)
  for i = 1, 41 do
    check.near(camera.guess.yaws[i], math.pi / 2, 1e-9)
    check.near(camera.guess.pitches[i], 0, 1e-9)
  end
end

function T.nothing_is_pulled_within_a_cut()
  local camera = plan({ subjects = { { name = "a", position = { 0, 10, 0 } },
                                     { name = "b", position = { 20, 10, 0 } } },
                        keyframes = { k(0, "a"), k(10, "b") },
                        cuts = { { start = 4, finish = 6 } } }, 10)
  check.equal(#camera.spans, 2)
  for _, pull in ipairs(camera.pulls) do check.yes(pull.time < 4 or pull.time > 6, "outside") end
  check.equal(camera.cuts, { { start = 4, finish = 6 } })
  check.equal(plan({ subjects = {}, keyframes = { k(0), k(10) } }, 10), nil)
  check.fails("cuts: a cut needs a subject", plan,
              { subjects = {}, keyframes = { k(0) }, cuts = { { start = 1 } } }, 10)
  check.fails("no part of the subject is in the image", plan,
              { subjects = { { position = { 0, 10, 0 } } }, keyframes = { k(0) },
                cuts = { { start = 0, finish = 10 } } }, 10)
end

-- Between two looks the target goes straight from one to the other, and times are stretched.
function T.from_one_look_to_the_next_the_target_goes_straight()
  local camera = plan({ subjects = { { name = "a", position = { 0, 10, 0 } },
                                     { name = "b", position = { 20, 10, 0 } } }, stretch = 2,
                        keyframes = { k(0, "a"), k(5, "b") } }, 10)
  check.near({ camera.spans[1].finish, camera.spans[2].start }, { 3.5, 6.5 }, 1e-12)
  for i, time in ipairs(camera.guess.times) do
    local at_x = math.max(0, math.min(20, (time - 3.5) / 3 * 20))
    local target = camera.guess.targets[i]
    check.near({ target.x or target[1], target.y or target[2] }, { at_x, 10 }, 1e-9, "at " .. time)
  end
  -- A point is pulled to once, at its keyframe, with the weight of a second.
  camera = plan({ subjects = {}, keyframes = { k(0, nil, { 1, 2, 3 }), k(8, nil, { 4, 5, 6 }) } },
                8)
  check.equal(camera.pulls, { { time = 0, value = { 1, 2, 3 }, weight = 1 },
                              { time = 8, value = { 4, 5, 6 }, weight = 1 } })
  check.equal(camera.spans, {})
end

function T.what_the_gimbal_cannot_show_is_said()
  local function hidden(height)
    local tower = { name = "tower", position = { 0, 10, height } }
    local stands = { { time = 0, position = { 0, 0, 0 } } }
    return subjects.hidden(plan({ subjects = { tower }, keyframes = stands }, 1), VEHICLE)
  end
  check.equal(hidden(0), nil)
  check.equal(hidden(10 * math.tan(0.79)), nil, "0.5 rad and 0.3 rad of image")
  local said = hidden(10 * math.tan(0.81))
  check.yes(said and said:find("gimbal_pitch of 46.4 deg towards 'tower' at 0 s", 1, true), said)
end

return check.all(T)
