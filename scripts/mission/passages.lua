-- SPDX-License-Identifier: Apache-2.0
-- A strategy for a film that fails beside obstacles (thesis 6.1). The passage of the failing leg is
-- tried again within a corridor of free boxes. If that fails too, another passage is planned for
-- the leg.
local attempts = require "mission.film_attempt"
local paths = require "mission.paths"
local requests = require "mission.film_request"
local ways = require "mission.ways"

local M = {}

-- Why an attempt is no flight, and when.
local function reason(outcome)
  if outcome.fault then return outcome.fault, 0 end
  local worst = outcome.solution.violations[1]
  if outcome.solution.status == "infeasible" then
    return outcome.solution.message, worst and worst.time or 0
  end
  local _, check = attempts.failed_checks(outcome)
  if check then return outcome.verdict.failures[1], check.at end
  return outcome.solution.message, worst and worst.time or 0
end

-- The leg that is flown at a time, s.
local function leg_at(outcome, time)
  local request, leg = outcome.request, 1
  while leg < #outcome.legs and request.keyframes[leg + 1].time * request.stretch < time do
    leg = leg + 1
  end
  return leg
end

-- What is remembered: `count` of the passages that were tried in the open, `number` of them for
-- each leg, `leg` that fails, and `entries` on what was tried.
local NOTHING = { count = 0, number = {}, entries = {}, notes = {} }

-- The memory with one more entry on what was tried, and a sentence where it failed.
local function with_entry(memory, outcome, leg, number, why)
  local way = outcome.legs[leg].way
  local entry = { leg = leg, number = number, length = way and paths.length(way) or 0, why = why,
                  corridor = outcome.request.corridor, certified = outcome.holds }
  local entries = table.move(memory.entries, 1, #memory.entries, 1, {})
  local notes = table.move(memory.notes, 1, #memory.notes, 1, {})
  entries[#entries + 1] = entry
  if not entry.certified then
    notes[#notes + 1] = string.format("passage %d of leg %d%s, %.3g m long: %s", number, leg,
                                      entry.corridor and " in a corridor" or "", entry.length, why)
  end
  local numbers = table.move(memory.number, 1, #outcome.legs, 1, {})
  numbers[leg] = number
  return { count = memory.count, number = numbers, leg = leg, entries = entries, notes = notes }
end

local function open_passage(run, outcome, memory)
  if outcome.holds then
    return nil, with_entry(memory, outcome, memory.leg, memory.number[memory.leg] + 1, "certified")
  end
  -- The planner found no other passage for the leg that failed.
  local before = memory.leg and outcome.legs[memory.leg]
  if before and not before.way then
    local notes = table.move(memory.notes, 1, #memory.notes, 1, {})
    notes[#notes + 1] = string.format("leg %d: %s", memory.leg, before.why)
    return nil, { entries = memory.entries, notes = notes }
  end
  if memory.count == run.options.passages then return nil, memory end
  local why, time = reason(outcome)
  local leg = leg_at(outcome, time)
  local found = outcome.legs[leg]
  if not found.way then why = why .. "; no path was planned, " .. (found.why or "") end
  local told = with_entry(memory, outcome, leg, (memory.number[leg] or 0) + 1, why)
  told.count = memory.count + 1
  if not found.way then return nil, told end
  return requests.with(outcome.request, { corridor = true, legs = outcome.legs, memory = told }),
         told
end

-- The next request after an outcome; nil where one holds, or no passage is left. Told are
-- {entries, notes} on what was tried.
function M.next(run, outcome)
  local memory = outcome.request.memory or NOTHING
  if not outcome.request.corridor then return open_passage(run, outcome, memory) end
  local leg = memory.leg
  if outcome.holds then
    return nil, with_entry(memory, outcome, leg, memory.number[leg], "certified")
  end
  local told = with_entry(memory, outcome, leg, memory.number[leg], (reason(outcome)))
  told.count = memory.count
  return requests.with(outcome.request, { corridor = false, memory = told,
                                          legs = ways.without_way(outcome.legs, leg) }), told
end

return M
