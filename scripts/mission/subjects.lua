-- What a film looks at, and when: subjects and their tracks, looks, cuts, and a first guess of
-- where the camera points.
local tracks = require "mission.tracks"

local subjects = {}

local GRID = 0.25        -- s, between the points that the target is drawn to
local TRANSITION = 3     -- s, from one subject to the next, where the leg is long enough
local LEAST_CUT = 0.2    -- s

-- ---- looks --------------------------------------------------------------------------------------

-- What each keyframe looks at: {time, subject} or {time, point}; nil where nothing is asked for.
local function looks_of(run, keyframes, list, by_name)
  local looks, last, any = {}, nil, false
  for i, k in ipairs(keyframes) do
    local what = "keyframes[" .. i .. "]"
    if k.subject and k.look_at then
      run:fail(what .. ".look_at", "give a subject or a point, not both")
    end
    if k.subject and not by_name[k.subject] then
      run:fail(what .. ".look_at", "there is no subject named '" .. k.subject .. "'")
    end
    if k.subject then
      looks[i] = { time = k.time, subject = by_name[k.subject] }
    elseif k.look_at then
      looks[i] = { time = k.time, point = k.look_at }
    end
    any = any or looks[i] ~= nil
  end
  if not any then
    if #list == 0 then return nil end
    if #list > 1 then
      run:fail("subjects", string.format("with several, keyframes say which: look_at = \"%s\"",
                                         list[1].name))
    end
    for i, k in ipairs(keyframes) do looks[i] = { time = k.time, subject = list[1] } end
    return looks
  end
  local filled = {}
  for i, k in ipairs(keyframes) do  -- as the one before looks, or else the first that does
    last = looks[i] or last
    filled[i] = last and { time = k.time, subject = last.subject, point = last.point } or false
  end
  for i = #keyframes, 1, -1 do
    if not filled[i] then
      filled[i] = { time = keyframes[i].time, subject = filled[i + 1].subject,
                    point = filled[i + 1].point }
    end
  end
  return filled
end

-- Spans in which one subject is looked at, and the points looked at on the way.
local function schedule_of(looks, duration)
  local spans, points = {}, {}
  local function span(subject, start, finish)
    local last = spans[#spans]
    if last and last.subject == subject and start <= last.finish + 1e-9 then
      last.finish = finish
    elseif finish > start then
      spans[#spans + 1] = { subject = subject, start = start, finish = finish }
    end
  end
  for i, look in ipairs(looks) do
    local before, after = looks[i - 1], looks[i + 1]
    if look.point then points[#points + 1] = { time = look.time, position = look.point } end
    if look.subject then
      local start, finish = before and look.time or 0, after and look.time or duration
      if before and before.subject ~= look.subject then
        local leg = look.time - before.time
        start = look.time - math.max(0, (leg - TRANSITION) / 2)
      end
      if after then
        local leg = after.time - look.time
        finish = after.subject == look.subject and after.time
          or look.time + math.max(0, (leg - TRANSITION) / 2)
      end
      span(look.subject, start, finish)
    end
  end
  return spans, points
end

-- ---- the whole ----------------------------------------------------------------------------------

local function inside(spans, time)
  for _, s in ipairs(spans) do
    if time > s.start - 1e-9 and time < s.finish + 1e-9 then return s end
  end
end

-- A cut without an end lasts as long as the gimbal and the yaw need for the turn across it.
local function cuts_of(run, given, stretch, duration, vehicle, path, target)
  local cuts = {}
  for i, cut in ipairs(given) do
    local what = "cuts[" .. i .. "]"
    local start = cut.start * stretch
    local finish = cut.finish and cut.finish * stretch
    if not finish then
      local later, turn = start, 0
      for _ = 1, 8 do  -- the turn depends on where the cut ends
        local yaw, pitch = tracks.angles(tracks.at(path, start), target(start - GRID / 2), nil)
        local yaw2, pitch2 = tracks.angles(tracks.at(path, later), target(later + GRID / 2), yaw)
        local rate = vehicle.yaw_rate + vehicle.gimbal.yaw_rate
        turn = math.max(math.abs(yaw2 - yaw) / rate,
                        math.abs(pitch2 - pitch) / vehicle.gimbal.pitch_rate)
        later = start + math.max(LEAST_CUT, turn)
      end
      finish = later
    end
    if finish <= start then run:fail(what .. ".finish", "a cut ends after it starts") end
    if finish > duration + 1e-9 then
      run:fail(what, string.format("ends at %.3g s, after the film's %.3g s", finish, duration))
    end
    if cuts[i - 1] and start <= cuts[i - 1].finish then
      run:fail(what .. ".start", "cuts stand in order and apart from each other")
    end
    cuts[i] = { start = start, finish = math.min(finish, duration) }
  end
  return cuts
end

-- A track must say where a subject is whenever it is looked at.
local function check_coverage(run, spans)
  for _, s in ipairs(spans) do
    local track = s.subject.track
    local first, last = track[1].time, track[#track].time
    if not s.subject.still and (first > s.start + 1e-6 or last < s.finish - 1e-6) then
      run:fail(s.subject.option .. ".track", string.format(
        "runs from %.4g s to %.4g s, but '%s' is looked at from %.4g s to %.4g s", first, last,
        s.subject.name, s.start, s.finish))
    end
  end
end

-- All that the camera is asked for, with times multiplied by `stretch`; nil when nothing is.
--   list      subjects {name, track, height, width, ...}
--   spans     {subject, start, finish}       when a subject is to be in the image
--   cuts      {start, finish}
--   pulls     {time, position, weight}       where the target is drawn to
--   guess     {times, yaws, pitches, targets}
function subjects.plan(run, shot, stretch, duration, vehicle)
  local list, by_name = tracks.checked(run, shot.subjects, stretch)
  local keyframes = {}
  for i, k in ipairs(shot.keyframes) do
    keyframes[i] = { time = k.time * stretch, position = k.position, look_at = k.look_at,
                     subject = k.subject }
  end
  local looks = looks_of(run, keyframes, list, by_name)
  if not looks then
    if #shot.cuts > 0 then run:fail("cuts", "there is nothing to cut between: no subject") end
    return nil
  end
  local spans, points = schedule_of(looks, duration)
  check_coverage(run, spans)

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
  local cuts = cuts_of(run, shot.cuts, stretch, duration, vehicle, keyframes, target)

  local pulls = {}
  for _, s in ipairs(spans) do
    local count = math.max(1, math.ceil((s.finish - s.start) / GRID))
    for i = 0, count do
      local time = s.start + (s.finish - s.start) * i / count
      if not inside(cuts, time) then
        pulls[#pulls + 1] = { time = time, value = tracks.at(s.subject.track, time),
                              weight = (s.finish - s.start) / count }
      end
    end
  end
  for _, p in ipairs(points) do
    pulls[#pulls + 1] = { time = p.time, value = p.position, weight = 1 }
  end
  table.sort(pulls, function(a, b) return a.time < b.time end)

  local guess = { times = {}, yaws = {}, pitches = {}, targets = {} }
  local yaw, pitch
  local count = math.max(2, math.ceil(duration / GRID))
  for i = 0, count do
    local time = duration * i / count
    local at = target(time)
    yaw, pitch = tracks.angles(tracks.at(keyframes, time), at, yaw)
    guess.times[i + 1], guess.yaws[i + 1], guess.pitches[i + 1] = time, yaw, pitch
    guess.targets[i + 1] = at
  end
  return { list = list, spans = spans, cuts = cuts, pulls = pulls, guess = guess }
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
