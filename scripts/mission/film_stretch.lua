-- SPDX-License-Identifier: Apache-2.0
-- A strategy for a film that exceeds the limits of the vehicle: it finds the smallest certified
-- stretch, to 1 %. The search first solves the flight without the camera, in doubling steps and
-- then by bisection. It stretches further only if the camera needs more time.
local requests = require "mission.film_request"

local M = {}

M.LARGEST = 64                  -- times the stretch of the film that failed
local FIRST = 0.05              -- first step, as a share; each one is twice the one before
local ACCURACY = 1.01           -- of the smallest stretch
local CAMERA = 1.05             -- steps beyond what the flight alone needs

-- The bracket: no flight is possible at `low` or below, one is at `good` (nil: none was found
-- yet); `more` is the share by which the next try is longer than `low`, `most` is not passed.
local function next_flight(request, bracket)
  local low, good = bracket.low, bracket.good
  local stretch, scope = nil, "flight"
  if not good then
    stretch = low * (1 + bracket.more)
    if stretch >= bracket.most then return nil end
  elseif good / low > ACCURACY then
    stretch = math.sqrt(low * good)
  else
    stretch, scope = good, "film"
  end
  return requests.with(request, { stretch = stretch, scope = scope, memory = bracket })
end

-- The first request where the film of `request` came to nothing. Below a stretch of `least` no
-- flight is possible.
function M.first(request, least)
  local stretch = request.stretch
  return next_flight(request, { low = math.max(stretch, least), more = FIRST,
                                most = stretch * M.LARGEST })
end

-- The next request after an outcome; nil where the film holds, or the largest stretch is reached.
function M.next(_, outcome)
  local request, bracket = outcome.request, outcome.request.memory
  local again = requests.with(request, { legs = outcome.legs })
  if request.scope == "film" then
    local stretch = request.stretch * CAMERA
    if outcome.holds or stretch >= bracket.most then return nil end
    return requests.with(again, { stretch = stretch })
  end
  local low, good, more = bracket.low, bracket.good, bracket.more
  if outcome.holds then
    good = request.stretch
  else
    low = request.stretch
    more = good and more or 2 * more
  end
  return next_flight(again, { low = low, good = good, more = more, most = bracket.most })
end

-- What a search that found nothing tried, in words: from the request `first` to the outcome `last`.
-- Where nothing was tried, a stretch of more than `least` is needed.
function M.in_vain(request, least, first, last)
  if not first then
    return string.format("it needs a stretch above %.4g; the largest that is tried is %.4g",
                         least, M.LARGEST * request.stretch)
  end
  local from, to = first.stretch, last and last.request.stretch or first.stretch
  if to <= from then return string.format("a stretch of %.3g is not certified either", from) end
  return string.format("no stretch from %.3g to %.3g is certified",
                       from, to)
end

return M
