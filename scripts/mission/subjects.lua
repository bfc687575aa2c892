-- SPDX-License-Identifier: Apache-2.0
-- The subjects of a film over time: tracks, looks, cuts, and the initial guess of the target of the
-- camera.
local looks = require "mission.looks"
local tracks = require "mission.tracks"

local subjects = {}

local GRID = 0.25        -- s, between the points that the target is drawn to

local function inside(spans, time)
  for _, s in ipairs(spans) do
    if time > s.start - 1e-9 and time < s.finish + 1e-9 then return s end
  end
end

-- Numbers 0 to `count` that divide the time from `start` to `finish`, in a loop: those in a part
-- and one beyond on either side.
local function numbers_in(part, count, start, finish)
  local first, last = 0, count
  if part then
    local per = count / (finish - start)
    first = math.max(0, math.floor((part.begin - start) * per))
    last = math.min(count, math.ceil((part.finish - start) * per))
  end
  local i = first - 1
  return function()
    i = i + 1
    if i <= last then return i end
  end
end

-- All that the camera is asked for by a request, over `duration` s; nil when nothing is. Of a
-- `part` {begin, finish} pulls and guess are only those in it; nil: all.
--   list      subjects {name, track, height, width, ...}
--   spans     {subject, start, finish}       when a subject is to be in the image
--   cuts      {start, finish}
--   pulls     {time, value, weight}          where the target is drawn to
--   points    the same, of looks at points alone
--   guess     {times, yaws, pitches, targets}
function subjects.plan(run, request, duration, part)
  local stretch = request.stretch
  local list, by_name = tracks.checked(run, request.subjects, stretch)
  local keyframes = {}
  for i, k in ipairs(request.keyframes) do
    keyframes[i] = { time = k.time * stretch, position = k.position, look_at = k.look_at,
                     subject = k.subject }
  end
  local order = looks.of(run, keyframes, list, by_name)
  if not order then
    if #request.cuts > 0 then run:fail("cuts", "a cut needs a subject, and there is none") end
    return nil
  end
  local cuts = looks.cuts(run, request.cuts, stretch, duration, request.vehicle, keyframes, order)
  local spans, points = looks.schedule(order, duration, cuts)
  looks.check_coverage(run, spans)

  -- The target follows its subject, and goes straight from one look to the next.
  local knots = {}
  for _, s in ipairs(spans) do
    knots[#knots + 1] = { time = s.start, position = tracks.at(s.subject.track, s.start) }
    knots[#knots + 1] = { time = s.finish, position = tracks.at(s.subject.track, s.finish) }
  end
  for _, p in ipairs(points) do knots[#knots + 1] = p end
  table.sort(knots, function(a, b) return a.time < b.time end)
  local function target(time)
    local s = inside(spans, time)
    return s and tracks.at(s.subject.track, time) or tracks.at(knots, time)
  end

  local pulls = {}
  for _, s in ipairs(spans) do
    local count = math.max(1, math.ceil((s.finish - s.start) / GRID))
    for i in numbers_in(part, count, s.start, s.finish) do
      local time = s.start + (s.finish - s.start) * i / count
      if not inside(cuts, time) then
        pulls[#pulls + 1] = { time = time, value = tracks.at(s.subject.track, time),
                              weight = (s.finish - s.start) / count }
      end
    end
  end
  local at_points = {}
  for i, p in ipairs(points) do
    at_points[i] = { time = p.time, value = p.position, weight = 1 }
    pulls[#pulls + 1] = at_points[i]
  end
  table.sort(pulls, function(a, b) return a.time < b.time end)
  if #pulls == 0 then run:fail("cuts", "no part of the subject is in the image") end

  local guess = { times = {}, yaws = {}, pitches = {}, targets = {} }
  local yaw, pitch
  local count = math.max(2, math.ceil(duration / GRID))
  for i in numbers_in(part, count, 0, duration) do
    local time, k = duration * i / count, #guess.times + 1
    local at = target(time)
    yaw, pitch = tracks.angles(tracks.at(keyframes, time), at, yaw)
    guess.times[k], guess.yaws[k], guess.pitches[k], guess.targets[k] = time, yaw, pitch, at
  end
  return { list = list, spans = spans, cuts = cuts, pulls = pulls, points = at_points,
           guess = guess }
end

-- Where the straight way between keyframes sees a subject so high or low that the gimbal cannot
-- bring it into the image: a sentence, or nil.
function subjects.hidden(camera, vehicle)
  local gimbal, view = vehicle.gimbal, vehicle.half_view.up
  local worst, sentence = 0, nil
  for i, time in ipairs(camera.guess.times) do
    local span, pitch = inside(camera.spans, time), camera.guess.pitches[i]
    local limit = pitch > gimbal.pitch_max and gimbal.pitch_max or gimbal.pitch_min
    local beyond = math.max(pitch - gimbal.pitch_max, gimbal.pitch_min - pitch) - view
    if span and beyond > worst then
      worst = beyond
      sentence = string.format(
        "gimbal_pitch of %.3g deg towards '%s' at %.4g s is beyond %.3g deg and half the image",
        math.deg(pitch), span.subject.name, time, math.deg(limit))
    end
  end
  return sentence
end

return subjects
