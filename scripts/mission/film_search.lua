-- Solving a film: attempts, the search for a flight that holds, and what to say where there is
-- none.
local passages = require "mission.passages"
local problem = require "mission.film_problem"
local subjects = require "mission.subjects"
local times = require "mission.keyframe_times"
local timing = require "mission.timing"
local wished = require "mission.wished_times"

local M = {}

local HOVER = 10                -- s, of a single keyframe without a time
local LARGEST_STRETCH = 64
local MUCH_STRETCH = 4          -- at which a film holds that time alone mends
local CAMERA_STRETCH = 1.05     -- steps beyond what the flight alone needs
local STRETCH_ACCURACY = 1.01   -- the smallest certified stretch is found to 1 %

-- `only`: "unlimited", as if the vehicle could do anything; "flight", without the camera.
local function attempt(run, shot, stretch, only)
  run:phase(stretch == 1 and "film" or string.format("film %.4g times as long", stretch))
  local stated, task, camera = problem.state(run, shot, stretch, only)
  local cuts = camera and camera.cuts or {}
  local result = { stretch = stretch, task = task, camera = camera, cuts = cuts,
                   keyframes = shot.keyframes }
  result.solution = run:solve(stated, run.options.solver)
  result.verdict = run:certify(run:plan { solution = result.solution, task = task, cuts = cuts })
  return result
end

-- What more time would not mend: a way that obstacles close, a subject that the gimbal cannot see.
local function blocked(failing)
  return string.find(failing.verdict.failures[1] or "", "^clearance") ~= nil
end
local function out_of_sight(failing)
  return string.find(failing.verdict.failures[1] or "", "^framing") ~= nil
end

-- Which limit a film breaks, where and when: a leg that is too fast for it, or else what the film
-- would ask for if nothing held it.
local function broken_limit(run, shot, failing, leg)
  if leg then return leg end
  if out_of_sight(failing) then
    return subjects.hidden(failing.camera, shot.vehicle) or failing.verdict.failures[1]
  end
  local free = attempt(run, shot, failing.stretch, "unlimited")
  local limit = free.solution.status == "optimal" and free.verdict.failures[1]
  if limit then return "flown as if the vehicle had no limits: " .. limit end
  return failing.verdict.failures[1] or failing.solution.message
end

-- For a film that misses a keyframe: which option says how near is near enough. Else "".
local function tolerance(verdict, hard)
  for _, failure in ipairs(verdict.failures) do
    if failure:find("^keyframe_miss") then
      return string.format("; keyframes may be missed by %g m: hard = METRES %s",
                           hard or problem.MISS,
                           hard and "sets that" or "holds them within another distance")
    end
  end
  return ""
end

-- The script's own constraints that a verdict breaks: sentences; and whether it breaks nothing
-- else.
local function broken_constraints(verdict)
  local list, alone = {}, true
  for _, sentence in ipairs(verdict.failures) do
    if string.find(sentence, '^constraint "') then list[#list + 1] = sentence
    else alone = false end
  end
  return list, alone
end

-- Whether the script's own constraints are what is in the way of a film, in words: the same film,
-- at the same times, flown without holding them.
local function in_the_way(run, shot, failing)
  if #run.options.constraints == 0 or run:cancelled() then return nil end
  local keyframes, legs = shot.keyframes, shot.legs
  shot.keyframes = failing.keyframes
  if shot.passages then shot.legs = nil end  -- the first passage again: it may have been right
  local free = attempt(run, shot, failing.stretch, "unconstrained")
  shot.keyframes, shot.legs = keyframes, legs
  local list, alone = broken_constraints(free.verdict)
  if not alone or free.solution.status == "infeasible" then
    local worst = failing.solution.violations[1]
    for _, entry in ipairs(run.options.constraints) do
      if worst and worst.amount > 1e-4 and worst.name == (entry.name or entry.type) then
        return string.format('constraint "%s" is in the way: missed by %.3g at %.4g s', worst.name,
                             worst.amount, worst.time)
      end
    end
    return nil
  end
  if #list > 0 then return "in the way, as the film shows without it: " .. list[1] end
  local names = {}
  for i, entry in ipairs(run.options.constraints) do
    names[i] = '"' .. (entry.name or entry.type) .. '"'
  end
  return "certified without the constraints of the script, " .. table.concat(names, ", ")
end

-- Sentences on a film that came to nothing, with the script's constraint that is in the way first.
local function with_constraint(run, shot, failing, notes)
  local constraint = in_the_way(run, shot, failing)
  if constraint then table.insert(notes, 1, constraint) end
  return notes
end

-- Certified, and not only because the least violation hides in the verifier's tolerance.
local function holds(tried)
  return tried.verdict.feasible and tried.solution.status ~= "infeasible"
end

-- The smallest stretch above a failing attempt at which the film is certified, to 1 %; or nil.
-- Below `least` no film is possible. The flight alone is what takes time, so that is looked for
-- first, and stretched further only where the camera needs more.
local function smallest_stretch(run, shot, failing, least)
  local low, good, more = math.max(failing.stretch, least), nil, 0.05
  local most = failing.stretch * LARGEST_STRETCH
  while not good and low * (1 + more) < most and not run:cancelled() do
    local tried = attempt(run, shot, low * (1 + more), "flight")
    if holds(tried) then good = tried else low, more = tried.stretch, 2 * more end
  end
  while good and good.stretch / low > STRETCH_ACCURACY and not run:cancelled() do
    local tried = attempt(run, shot, math.sqrt(low * good.stretch), "flight")
    if holds(tried) then good = tried else low = tried.stretch end
  end
  local stretch = good and good.stretch
  while stretch and stretch < most and not run:cancelled() do
    local tried = attempt(run, shot, stretch)
    if holds(tried) then return tried end
    stretch = stretch * CAMERA_STRETCH
  end
end

-- `details`: sentences on passages that failed, where another one held.
local function finished(run, shot, chosen, notes, certified, figures, details)
  figures = figures or {}
  figures.stretch, figures.certified_stretch = chosen.stretch, certified
  figures.passages = shot.passages
  return run:plan { solution = chosen.solution, task = chosen.task, cuts = chosen.cuts,
                    notes = notes, details = details or {}, geodetic_origin = shot.origin,
                    budget = run.options.battery, figures = figures }
end

-- Subjects and looks ask for a camera that turns by itself.
local function check_gimbal(run, shot)
  if shot.vehicle.gimbal then return end
  local message = "vehicle '" .. shot.vehicle.name .. "' has no gimbal to look at it with"
  if #shot.subjects > 0 then run:fail("subjects[1]", message) end
  for i, k in ipairs(shot.keyframes) do
    if k.look_at or k.subject then run:fail("keyframes[" .. i .. "].look_at", message) end
  end
  if #shot.cuts > 0 then run:fail("cuts", "there is nothing to cut between: no subject") end
end

-- The film at the times that its keyframes have.
local function at_given_times(run, shot)
  local o = run.options
  times.fill(shot, shot.vehicle, o)
  times.check(run, shot)
  times.unwrap_yaw(shot.keyframes)
  local last = shot.keyframes[#shot.keyframes].time
  shot.duration = shot.duration or (last > 0 and last or HOVER)
  local least, why = times.fastest_leg(shot.keyframes, shot.vehicle, o.hard or problem.MISS,
                                      o.hard and 0 or problem.LATE, o.speed_limit)
  local auto = o.stretch == "auto"
  times.check_battery(run, shot, auto and 1 or o.stretch)
  local first = attempt(run, shot, auto and 1 or o.stretch, auto and why and "flight" or nil)
  local status = first.solution.status
  local broken = not why and (status == "unsupported"
                              or status == "numerical_error" and not passages.matter(shot))
  if first.verdict.feasible or broken or run:cancelled() then
    return finished(run, shot, first, {}, first.verdict.feasible and first.stretch or nil)
  end
  local notes = {}
  if not why and o.passages > 0 and (blocked(first) or passages.matter(shot))
     and not out_of_sight(first) then
    first, notes = passages.search(run, shot, first, attempt, holds)
    if holds(first) then return finished(run, shot, first, {}, first.stretch, nil, notes) end
  end
  if not why and blocked(first) then
    return finished(run, shot, first, with_constraint(run, shot, first, notes))
  end
  local hopeless = not why and out_of_sight(first)
  local constraint = not why and in_the_way(run, shot, first)
  -- More time mends a constraint on speed, and none on places: one try tells.
  if constraint then
    hopeless = hopeless or not (o.hard or auto)
               or not holds(attempt(run, shot, first.stretch * MUCH_STRETCH))
  end
  why = constraint or broken_limit(run, shot, first, why)
  if hopeless or not o.hard and not auto then
    notes[#notes + 1] = why .. tolerance(first.verdict, o.hard)
    return finished(run, shot, first, notes)
  end
  local good = smallest_stretch(run, shot, first, least)
  local note = good and string.format("%s; certified from a stretch of %.2f", why, good.stretch)
    or string.format("%s; no stretch up to %g is certified", why, LARGEST_STRETCH)
  if run:cancelled() then note = why .. "; the search for a stretch was cancelled" end
  if auto and good then return finished(run, shot, good, { note }, good.stretch, nil, notes) end
  notes[#notes + 1] = note .. tolerance(first.verdict, o.hard)
  return finished(run, shot, first, notes, good and good.stretch or nil)
end

function M.fly(run, shot)
  local o = run.options
  shot.vehicle = run:vehicle(o.vehicle)
  shot.cuts, shot.subjects = o.cuts, shot.subjects or {}
  if #shot.keyframes == 0 then run:fail("keyframes", "expected at least one keyframe") end
  check_gimbal(run, shot)
  timing.check(run, shot)
  times.check_speed(run, shot)
  if o.timing == "given" or o.timing == "time_first" then return at_given_times(run, shot) end
  local way = o.timing == "free" and wished or timing
  local chosen, notes, figures = way.fly(run, shot, attempt, holds)
  if not holds(chosen) then notes = with_constraint(run, shot, chosen, notes) end
  return finished(run, shot, chosen, notes, holds(chosen) and 1 or nil, figures)
end

return M
