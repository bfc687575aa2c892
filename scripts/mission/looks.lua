-- SPDX-License-Identifier: Apache-2.0
-- The sequence of looks: the subject of each keyframe, the cuts between looks, and the spans in
-- which each subject must be in the image.
local tracks = require "mission.tracks"

local looks = {}

local TRANSITION = 3   -- s, from one subject to the next, where the leg is long enough
local LEAST_CUT = 0.2  -- s

-- What each keyframe looks at: {time, subject} or {time, point}; nil where nothing is asked for.
function looks.of(run, keyframes, list, by_name)
  local found, last, any = {}, nil, false
  for i, k in ipairs(keyframes) do
    local what = "keyframes[" .. i .. "]"
    if k.subject and k.look_at then
      run:fail(what .. ".look_at", "give a subject or a point, not both")
    end
    if k.subject and not by_name[k.subject] then
      local names = {}
      for n, subject in ipairs(list) do names[n] = subject.name end
      run:fail(what .. ".look_at", string.format("no subject is named '%s'%s", k.subject,
        #names > 0 and "; subjects: " .. table.concat(names, ", ") or ""))
    end
    if k.subject then
      found[i] = { time = k.time, subject = by_name[k.subject] }
    elseif k.look_at then
      found[i] = { time = k.time, point = k.look_at }
    end
    any = any or found[i] ~= nil
  end
  if not any then
    if #list == 0 then return nil end
    if #list > 1 then
      run:fail("subjects", string.format("with several, keyframes select one: look_at = \"%s\"",
                                         list[1].name))
    end
    for i, k in ipairs(keyframes) do found[i] = { time = k.time, subject = list[1] } end
    return found
  end
  local filled = {}
  for i, k in ipairs(keyframes) do  -- as the one before looks, or else the first that does
    last = found[i] or last
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

-- Where a look is directed at a time.
local function seen(look, time)
  return look.point or tracks.at(look.subject.track, time)
end

-- The cut in which the camera leaves one look for the next, if there is one.
local function cut_within(cuts, from, to)
  for _, cut in ipairs(cuts) do
    if cut.start >= from - 1e-9 and cut.start < to then return cut end
  end
end

-- Spans in which one subject is looked at, and the points looked at on the way. From one look to
-- the next the camera goes in at most half of the leg, or in a cut.
function looks.schedule(list, duration, cuts)
  local spans, points = {}, {}
  local function span(subject, start, finish)
    local last = spans[#spans]
    if last and last.subject == subject and start <= last.finish + 1e-9 then
      last.finish = finish
    elseif finish > start then
      spans[#spans + 1] = { subject = subject, start = start, finish = finish }
    end
  end
  -- The times at which the change from one look to the next begins and ends.
  local function change(before, after)
    if before.subject and before.subject == after.subject then return after.time, before.time end
    local cut = cut_within(cuts, before.time, after.time)
    if cut then return cut.start, math.min(cut.finish, after.time) end
    local leg = after.time - before.time
    local still = (leg - math.min(TRANSITION, leg / 2)) / 2
    return before.time + still, after.time - still
  end
  for i, look in ipairs(list) do
    local start, finish = 0, duration
    if list[i - 1] then start = select(2, change(list[i - 1], look)) end
    if list[i + 1] then finish = change(look, list[i + 1]) end
    if look.point then points[#points + 1] = { time = look.time, position = look.point } end
    if look.subject then span(look.subject, start, finish) end
  end
  return spans, points
end

-- Cuts in order, inside the film. One without an end lasts as long as gimbal and yaw need for the
-- turn across it.
function looks.cuts(run, given, stretch, duration, vehicle, path, list)
  local cuts = {}
  for i, cut in ipairs(given) do
    local what = "cuts[" .. i .. "]"
    local start = cut.start * stretch
    local finish = cut.finish and cut.finish * stretch
    if not finish then
      local before, after = list[1], list[#list]
      for j, look in ipairs(list) do
        if look.time <= start then before, after = look, list[j + 1] or look end
      end
      finish = start
      for _ = 1, 8 do  -- the turn depends on where the cut ends
        local yaw, pitch = tracks.angles(tracks.at(path, start), seen(before, start), nil)
        local yaw2, pitch2 = tracks.angles(tracks.at(path, finish), seen(after, finish), yaw)
        local rate = vehicle.yaw_rate + vehicle.gimbal.yaw_rate
        finish = start + math.max(LEAST_CUT, math.abs(yaw2 - yaw) / rate,
                                  math.abs(pitch2 - pitch) / vehicle.gimbal.pitch_rate)
      end
    end
    if finish <= start then run:fail(what .. ".finish", "a cut ends after it starts") end
    if finish > duration + 1e-9 then
      run:fail(what, string.format("ends at %.3g s, after the film's %.3g s", finish, duration))
    end
    if cuts[i - 1] and start <= cuts[i - 1].finish then
      run:fail(what .. ".start", "cuts must be in order and must not overlap")
    end
    cuts[i] = { start = start, finish = math.min(finish, duration) }
  end
  return cuts
end

-- A track must say where a subject is whenever it is looked at.
function looks.check_coverage(run, spans)
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

return looks
