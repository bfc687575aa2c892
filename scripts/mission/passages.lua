-- Global before local (thesis 2.1, 6.1): where solvers begin, straight from keyframe to keyframe
-- and round what stands between; and, where a passage comes to nothing, the next one.
--
-- shot.legs[i] is the leg from keyframe i to i + 1: the `way` through it (nil where none was
-- found), `why` there is none, and the ways that have `failed`. shot.passages lists what was tried.
local M = {}

-- m, that a planned way keeps beside the margin; less where an end leaves no more room.
local MORE = { 0.3, 0.1, 0 }
local TRIES = 20   -- of the planner, to find another passage

local function distance(a, b)
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
end

local function length_of(way)
  local length = 0
  for i = 2, #way do length = length + distance(way[i - 1], way[i]) end
  return length
end

-- The places between two keyframes on the planned way, at even speed.
local function between(way, from, to)
  local length, places, passed = length_of(way), {}, 0
  for i = 2, #way - 1 do
    passed = passed + distance(way[i - 1], way[i])
    places[#places + 1] = { time = from + (to - from) * passed / length, position = way[i] }
  end
  return places
end

local function obstructed(environment)
  local count = 0
  for _, form in ipairs { "spheres", "boxes", "zones", "meshes", "maps", "flight_zones" } do
    count = count + #environment[form]
  end
  for _, subject in ipairs(environment.subjects or {}) do  -- bystanders that stand still
    if subject.filmed == false and #subject.track == 1 then count = count + 1 end
  end
  return count > 0
end

-- The regions of all legs, or nil where one has none.
local function corridor_of(p, shot, times)
  local regions = {}
  for i, leg in ipairs(shot.legs) do
    if not leg.way then return nil end
    leg.corridor = leg.corridor or p:grow_corridor { way = leg.way }
    if #leg.corridor == 0 then return nil end
    local from, span = times[i], times[i + 1] - times[i]
    for _, box in ipairs(leg.corridor) do
      regions[#regions + 1] = { start = from + span * box.from, finish = from + span * box.to,
                                lower = box.lower, size = box.size }
    end
  end
  return regions
end

-- {{time, position}, ...} through the keyframes; legs for which no way is found stay straight. And,
-- where shot.in_corridor asks for it, the corridor about it.
function M.path(p, shot, keyframes, environment, planner)
  local times, positions = keyframes.times, keyframes.positions
  local blocked = obstructed(environment)
  shot.obstructed, shot.legs = blocked, shot.legs or {}
  local path = { { time = times[1], position = positions[1] } }
  for i = 1, #times - 1 do
    local leg = shot.legs[i] or { failed = {} }
    shot.legs[i] = leg
    if blocked and not leg.way and not leg.why then
      for _, more in ipairs(MORE) do
        leg.way, leg.why = p:plan_way { from = positions[i], to = positions[i + 1], more = more,
                                        planner = planner, excluded = leg.failed, tries = TRIES }
        if not string.find(leg.why or "", "_blocked") then break end
      end
    end
    for _, place in ipairs(leg.way and between(leg.way, times[i], times[i + 1]) or {}) do
      path[#path + 1] = place
    end
    path[#path + 1] = { time = times[i + 1], position = positions[i + 1] }
  end
  return path, shot.in_corridor and blocked and corridor_of(p, shot, times) or nil
end

-- Whether any leg goes round something.
function M.matter(shot)
  for _, leg in ipairs(shot.legs or {}) do
    if leg.why or leg.way and #leg.way > 2 then return true end
  end
  return false
end

-- Why an attempt is no flight, and when.
local function reason(tried)
  local worst = tried.solution.violations[1]
  if tried.solution.status == "infeasible" then
    return tried.solution.message, worst and worst.time or 0
  end
  for _, check in ipairs(tried.verdict.checks) do
    if not check.pass and not check.skipped and check.required then
      return tried.verdict.failures[1], check.at
    end
  end
  return tried.solution.message, worst and worst.time or 0
end

local function note_of(entry)
  return string.format("passage %d of leg %d%s, %.3g m long: %s", entry.number, entry.leg,
                       entry.corridor and " in a corridor" or "", entry.length, entry.why)
end

-- Tries passage after passage until one `holds`, in the open and, if that fails, within a corridor;
-- `first` is what came of the first. Gives what held or else the first, and sentences on what
-- failed.
function M.search(run, shot, first, attempt, holds)
  local stretch, notes, tried = first.stretch, {}, first
  shot.passages = {}
  local number = {}
  for _ = 1, run.options.passages do
    local why, at = reason(tried)
    local leg = 1
    while leg < #shot.legs and shot.keyframes[leg + 1].time * stretch < at do leg = leg + 1 end
    number[leg] = (number[leg] or 0) + 1
    local way = shot.legs[leg].way
    local function record(sentence, corridor, certified)
      local entry = { leg = leg, number = number[leg], length = way and length_of(way) or 0,
                      corridor = corridor, certified = certified, why = sentence }
      shot.passages[#shot.passages + 1] = entry
      if not certified then notes[#notes + 1] = note_of(entry) end
    end
    if not way then why = why .. "; no way was planned, " .. (shot.legs[leg].why or "") end
    record(why, false, false)
    if run:cancelled() or not way then break end
    shot.in_corridor = true
    local fine, within = pcall(attempt, run, shot, stretch)
    shot.in_corridor = nil
    if fine and holds(within) then
      record("certified", true, true)
      return within, notes
    end
    record(fine and reason(within) or tostring(within), true, false)
    -- Another passage for this leg.
    local failed = shot.legs[leg].failed
    failed[#failed + 1] = way
    shot.legs[leg] = { failed = failed }
    if run:cancelled() then break end
    tried = attempt(run, shot, stretch)
    if not shot.legs[leg].way then
      notes[#notes + 1] = string.format("leg %d: %s", leg, shot.legs[leg].why)
      break
    end
    if holds(tried) then
      number[leg] = number[leg] + 1
      way = shot.legs[leg].way
      record("certified", false, true)
      return tried, notes
    end
  end
  return first, notes
end

return M
