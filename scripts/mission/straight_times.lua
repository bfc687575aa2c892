-- SPDX-License-Identifier: Apache-2.0
-- The film at times of straight flight from stop to stop: what is left to timing = "free" where the
-- solver finds no times at which the film is certified. The legs are stretched, as the wishes
-- allow, until the film holds. If none does, a note says how much later it would.
local attempts = require "mission.film_attempt"
local failure = require "mission.film_failure"
local film_times = require "mission.film_times"
local requests = require "mission.film_request"
local times = require "mission.keyframe_times"

local M = {}

local STRETCHES = { 1, 1.25, 1.6, 2, 3, 4 }

-- Whether wishes ask for a keyframe no later than some time, which may be too early.
local function hurried(wishes)
  for i, wish in ipairs(wishes) do
    if i > 1 and (wish.latest or wish.time and not wish.time_weight) then return true end
  end
  return false
end

-- The times with legs stretched by the number of `memory`; nil where there is no such number, and
-- where the wishes or the battery do not allow them. The first ones are those of its guess, where
-- the wishes allow no others.
local function listed(run, request, memory)
  local stretch, legs = STRETCHES[memory.straight], {}
  if not stretch then return nil end
  for i = 2, #request.keyframes do
    legs[i - 1] = stretch * times.of_leg(request.keyframes[i - 1].position,
                                         request.keyframes[i].position, request.vehicle)
  end
  local list = run:keyframe_times { wishes = request.wishes, legs = legs }
  if memory.straight == 1 then return list or memory.guess end
  return list and list[#list] <= times.battery(run, request.vehicle) and list or nil
end

-- The first request. `memory`: {guess, share}, times that meet the wishes, and the share of the
-- thrust with which better ones may be sought later; `why`: a sentence on why there are none yet.
function M.first(run, request, memory, why)
  local mine = { guess = memory.guess, share = memory.share, straight = 1, why = why }
  local list = listed(run, request, mine)
  times.check_battery(run, request.vehicle, list[#list])
  return film_times.set(request, list, { memory = mine })
end

-- By how much all times of a film that fails would have to be multiplied, and a sentence on it; nil
-- where more time mends nothing, or was not asked to be short.
local function late_enough(run, outcome)
  local request = outcome.request
  if not hurried(request.wishes) or run:cancelled() or failure.blocked(outcome)
     or failure.out_of_sight(outcome) then return nil end
  local most
  for k = 2, #STRETCHES do
    local list = {}
    for i, keyframe in ipairs(request.keyframes) do list[i] = STRETCHES[k] * keyframe.time end
    if list[#list] > times.battery(run, request.vehicle) or run:cancelled() then break end
    most = STRETCHES[k]
    local film = attempts.attempt(run, film_times.set(request, list,
                                                      { legs = outcome.legs, may_fail = true }))
    if film.holds then
      return most, string.format("certified if all times are multiplied by %.3g", most)
    end
  end
  return nil, most and string.format("not certified either with all times multiplied by %.3g", most)
end

-- The next request after an outcome at times of straight flight; and what is told.
function M.next(run, outcome)
  local request, memory = outcome.request, outcome.request.memory
  local stretch = STRETCHES[memory.straight]
  local told = {
    figures = { duration = request.duration, stretch_of_legs = stretch },
    notes = { string.format("%s; flown at the times of straight flight from stop to stop, "
                            .. "stretched by %.3g", memory.why, stretch) },
    notes_if_better = { memory.why .. "; the times were found from a film at those of straight "
                        .. "flight from stop to stop" } }
  if outcome.holds or run:cancelled() then return nil, told end
  local again = { guess = memory.guess, share = memory.share, straight = memory.straight + 1,
                  why = memory.why }
  local list = listed(run, request, again)
  if list then
    return film_times.set(request, list, { legs = outcome.legs, memory = again }), told
  end
  told.notes[2] = attempts.complaint(outcome)
  told.certified, told.notes[3] = late_enough(run, outcome)
  return nil, told
end

return M
