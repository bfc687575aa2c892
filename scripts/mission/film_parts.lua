-- SPDX-License-Identifier: Apache-2.0
-- Parts of a film in time: what of the lists of a film lies in a part.
--
-- A part is {begin, finish, first, last}: times in s, and whether it is the beginning and the end
-- of the film. Entries have a `time`, spans a `start` and a `finish`.
local M = {}

local ROUNDING = 1e-9  -- s

function M.whole(duration)
  return { begin = 0, finish = duration, first = true, last = true }
end

local function complete(part)
  return part.first and part.last
end

-- How many of `count` times, which rise, are at or before `limit`.
local function until_time(count, time_of, limit)
  local low, high = 0, count + 1  -- low: at or before; high: after
  while high - low > 1 do
    local middle = (low + high) // 2
    if time_of(middle) <= limit then low = middle else high = middle end
  end
  return low
end

-- The entries of a list, in order of time, whose time is in the part.
function M.entries(part, list)
  if complete(part) then return list end
  local function time_of(i) return list[i].time end
  local first = until_time(#list, time_of, part.begin - ROUNDING) + 1
  local last = until_time(#list, time_of, part.finish + ROUNDING)
  return table.move(list, first, last, 1, {})
end

-- The spans of a list that reach into the part, cut off at its ends.
function M.spans(part, list)
  if complete(part) then return list end
  local found = {}
  for _, span in ipairs(list) do
    local start, finish = math.max(span.start, part.begin), math.min(span.finish, part.finish)
    if finish > start + ROUNDING then
      local cut = {}
      for name, value in pairs(span) do cut[name] = value end
      cut.start, cut.finish = start, finish
      found[#found + 1] = cut
    end
  end
  return found
end

-- The numbers of the entries of a list in the part, and of the nearest one on either side of it.
local function range(part, count, time_of)
  return math.max(1, until_time(count, time_of, part.begin)),
         math.min(count, until_time(count, time_of, part.finish) + 1)
end

-- The entries of a list in the part, and the nearest one on either side of it: all that a line
-- through them needs within the part.
function M.line(part, list)
  if complete(part) then return list end
  local first, last = range(part, #list, function(i) return list[i].time end)
  return table.move(list, first, last, 1, {})
end

-- The same of a first guess: lists of the same length, one of which is `times`.
local function guess(part, given)
  local first, last = range(part, #given.times, function(i) return given.times[i] end)
  local found = {}
  for name, list in pairs(given) do found[name] = table.move(list, first, last, 1, {}) end
  return found
end

-- The camera of a film (subjects.plan) in a part.
function M.camera(part, camera)
  if complete(part) or not camera then return camera end
  return { list = camera.list, spans = M.spans(part, camera.spans),
           cuts = M.spans(part, camera.cuts), pulls = M.entries(part, camera.pulls),
           points = M.entries(part, camera.points),
           guess = guess(part, camera.guess) }
end

return M
