-- SPDX-License-Identifier: Apache-2.0
-- A film solved in parts that overlap (thesis 3.6: a receding horizon), in place of one problem for
-- all of it. Each part continues the flight of the part before: its first stages are held, so that
-- differences across the seam count like all others. A part looks further ahead than is kept of it;
-- the next part begins where that ends.
local live = require "mission.film_live"
local problem = require "mission.film_problem"

local M = {}

-- Stages that a part holds: the flight before the seam that differences of up to the fourth order
-- reach back to.
local HELD = 4

-- Keyframes that a part knows of beyond what is kept of it.
local AHEAD = 2

-- The last stage that is kept of a part from stage `seam`, `reach` stages on; and the last stage of
-- that part: as far ahead again, or further for the next keyframes, or the end of the film where
-- little is left.
local function ends_of_part(seam, reach, count, keyframes, step)
  local kept, to, known = seam + reach - 1, seam + 2 * reach, 0
  for _, time in ipairs(keyframes.times) do
    local stage = math.ceil(time / step - 1e-6)
    if stage > kept and known < AHEAD then
      known = known + 1
      to = math.max(to, stage)
    end
  end
  if to + reach >= count - 1 then to = count - 1 end
  return to == count - 1 and to or kept, to
end

-- Whether a request is solved in parts.
function M.wanted(run, request)
  return request.scope == "film" and (run.options.horizon or live.films(request)) and true or false
end

-- The solution of the film that was stated by problem.state, whose stages are those of its parts;
-- nil where the user cancels. Each part is kept for the seconds of `horizon`. With a live subject a
-- part looks that far ahead, and is kept until the next update.
function M.solve(run, request, stated)
  local film, p, o = stated.film, stated.problem, run.options
  local live_subject = live.films(request)
  local count = math.ceil(film.duration / film.step - 1e-9) + 1
  local step = film.duration / (count - 1)
  local horizon = live_subject and live.horizon(o) or o.horizon
  local reach = math.max(2 * HELD, math.ceil(horizon / step - 1e-9))
  local update = math.max(1, math.floor(o.update / step + 0.5))
  local joined, seam, before, first_before = {}, 0, nil, 0
  repeat
    local from = math.max(0, seam - HELD + 1)
    local kept, to
    if live_subject then
      to = math.min(count - 1, seam + reach)
      kept = math.min(count, seam + update) - 1
      if kept == count - 2 then kept = count - 1 end  -- a part has two stages
    else
      kept, to = ends_of_part(seam, reach, count, film.keyframes, step)
    end
    local part = { begin = from * step, finish = to * step, first = from == 0,
                   last = to == count - 1 }
    local stated_part = problem.part(run, request, film, part, before and
      { solution = before, stage = from - first_before, held = seam - from + 1 }, seam * step)
    local solution = run:solve(stated_part, run.options.solver)
    joined[#joined + 1] = { solution = solution, first = seam - from, last = kept - from }
    seam, before, first_before = kept + 1, solution, from
  until seam >= count or run:cancelled()
  if seam < count then return nil end
  return run:join(p, joined)
end

return M
