-- SPDX-License-Identifier: Apache-2.0
-- Films of subjects whose tracks become known only as they happen (`live`). The flight is planned
-- again at every update, from what was seen until then. The track in the script is that of a
-- simulated subject: plans see the past of it, and the certificate judges by all of it.
local requests = require "mission.film_request"
local tracks = require "mission.tracks"

local M = {}

local LOOK_BACK = 0.5  -- s, over which the velocity of a subject is measured
local LOOK_AHEAD = 4   -- s, of each plan, unless `horizon` says otherwise

-- Whether a request films a live subject.
function M.films(request)
  for _, subject in ipairs(request.subjects) do
    if subject.live then return true end
  end
  return false
end

-- s that each plan looks ahead.
function M.horizon(options)
  return options.horizon or LOOK_AHEAD
end

-- What a film of a live subject cannot ask for.
function M.check(run, film)
  local o = run.options
  for i, subject in ipairs(film.subjects) do
    local what = "subjects[" .. i .. "]"
    if (subject.delay or 0) > 0 and not subject.live then
      run:fail(what .. ".delay", "only a live subject is seen late; give live = true")
    end
    if subject.live and subject.position then
      run:fail(what .. ".live", "a subject with a position stands still; give a track")
    end
  end
  if not M.films(film) then return end
  if o.timing ~= "given" then
    run:fail("timing", "a live subject does not wait for the film; remove it")
  end
  if o.stretch ~= 1 then
    run:fail("stretch", "a live subject does not wait for the film; remove it")
  end
  if run.start then
    run:fail("subjects", "a film of a live subject begins from no plan (--from)")
  end
end

-- Keyframes with positions in the world: those `beside` a subject are relative to its place at
-- their time. They keep what was stated as `offset`.
function M.placed(run, keyframes, subjects)
  local by_name
  local list = {}
  for i, k in ipairs(keyframes) do
    list[i] = k
    if k.beside then
      local what = "keyframes[" .. i .. "]."
      if not by_name then
        local _
        _, by_name = tracks.checked(run, subjects, 1)
      end
      local subject = by_name[k.beside]
      if not subject then run:fail(what .. "beside", "no subject is named '" .. k.beside .. "'") end
      if not k.time then
        run:fail(what .. "time", "a keyframe beside a subject needs a time")
      end
      local placed = {}
      for name, value in pairs(k) do placed[name] = value end
      placed.offset, placed.live = k.position, subject.live
      placed.position = lapwing.vector(k.position) + tracks.at(subject.track, k.time)
      list[i] = placed
    end
  end
  return list
end

-- The track of a subject as it is expected at `now`: where it was seen last, straight on with the
-- velocity that it had; and straight back, for what is over.
local function expected(track, now, delay)
  local seen = math.max(0, now - delay)
  local at, before = tracks.at(track, seen), tracks.at(track, math.max(0, seen - LOOK_BACK))
  local span = math.min(seen, LOOK_BACK)
  local velocity = span > 0 and (lapwing.vector(at) - before) / span or lapwing.vector { 0, 0, 0 }
  local FAR = 1e4  -- s
  return { { time = 0, position = lapwing.vector(at) - seen * velocity },
           { time = seen + FAR, position = lapwing.vector(at) + FAR * velocity } }
end

-- A request as it looks at the time `now`: its live subjects with the tracks that are expected, and
-- the keyframes beside them.
function M.seen(request, now)
  local subjects, by_name = {}, {}
  for i, subject in ipairs(request.subjects) do
    subjects[i] = subject
    if subject.live then
      local copy = {}
      for name, value in pairs(subject) do copy[name] = value end
      copy.track = expected(subject.track, now, subject.delay or 0)
      subjects[i] = copy
    end
    by_name[subject.name or (#request.subjects == 1 and "subject" or "subject " .. i)] = subjects[i]
  end
  local keyframes = {}
  for i, k in ipairs(request.keyframes) do
    keyframes[i] = k
    if k.live then
      local copy = {}
      for name, value in pairs(k) do copy[name] = value end
      copy.position = lapwing.vector(k.offset) + tracks.at(by_name[k.beside].track, k.time)
      keyframes[i] = copy
    end
  end
  return requests.with(request, { subjects = subjects, keyframes = keyframes })
end

return M
