-- SPDX-License-Identifier: Apache-2.0
-- The strategy path_first: the fastest timing along a fixed path. A film at default times gives the
-- path. It is then flown as fast as the limits of the vehicle allow, with the times of keyframes as
-- wishes, and slower until the vehicle keeps the tolerance.
local attempts = require "mission.film_attempt"
local film_times = require "mission.film_times"
local requests = require "mission.film_request"
local paths = require "mission.paths"
local times = require "mission.keyframe_times"

local M = {}

local SPACING = 0.05    -- m, of the path that is timed
local ROUNDING = 0.4    -- m, of the corners that stages make of a smooth path
local PLACES = 0.2      -- s, between the places that draw the flight to the path
local PULL = 2e4        -- weight of all those places together, per m^2
local SHORTEST = 0.05   -- s, of a leg
M.SECOND = 10           -- times weights.time: cost of a second in a problem of film and times
local SLOWER, SLOWEST = 0.93, 0.25  -- share of what the vehicle can do, when it cannot follow

local function wishes(k) return k.time_weight or k.earliest or k.latest end

-- What keyframes wish makes sense together, and with the option `timing`.
function M.check(run, film)
  for i, k in ipairs(film.keyframes) do
    local what = "keyframes[" .. i .. "]"
    if wishes(k) and run.options.timing ~= "path_first" and run.options.timing ~= "free" then
      run:fail(what, "time_weight, earliest and latest need timing = \"path_first\" or \"free\"")
    end
    if k.time_weight and not k.time then run:fail(what .. ".time_weight", "needs a time") end
    if k.time and (k.earliest or k.latest) then
      run:fail(what .. ".time", "give a time, or earliest and latest")
    end
    if (k.earliest or 0) > (k.latest or math.huge) then
      run:fail(what .. ".latest", "comes before earliest")
    end
  end
end

-- What each keyframe asks of its time, the film's duration being the last one's. An error where the
-- times of `way`, which starts in the first keyframe at 0 s, cannot be found.
function M.wishes(run, film, way)
  local list = {}
  if run.options.stretch ~= 1 then run:fail("stretch", way .. " finds the times itself") end
  if #film.keyframes < 2 then run:fail("keyframes", way .. " needs at least two") end
  for i, k in ipairs(film.keyframes) do
    list[i] = { time = k.time, time_weight = k.time_weight, earliest = k.earliest,
                latest = k.latest }
  end
  if (list[1].time or list[1].earliest or 0) > 0 then
    run:fail("keyframes[1]", way .. " starts at the first keyframe, at 0 s")
  end
  local last = list[#list]
  if film.duration and not (last.time or wishes(last)) then last.time = film.duration end
  return list
end

-- Places and times of the path, each leg as much slower than the fastest as its keyframes ask for.
local function places_of(timed, stops, chosen)
  local places, leg, next_time = {}, 1, 0
  for j, t in ipairs(timed.times) do
    while leg < #stops - 1 and j > stops[leg + 1] do leg = leg + 1 end
    local from, to = timed.times[stops[leg]], timed.times[stops[leg + 1]]
    local share = to > from and (t - from) / (to - from) or 0
    local time = chosen[leg] + share * (chosen[leg + 1] - chosen[leg])
    time = math.min(time, chosen[#chosen])
    if time >= next_time or j == #timed.times then
      places[#places + 1] = { time = time,
                              value = paths.point(timed.points, j) }
      next_time = time + PLACES
    end
  end
  if #places > 1 and places[#places].time - places[#places - 1].time < 1e-3 then
    table.remove(places, #places - 1)
  end
  return places
end

-- The points of the path from keyframe to keyframe, each as a flat list.
local function legs_of(timed, stops)
  local legs = {}
  for i = 1, #stops - 1 do
    local first, last = stops[i], math.max(stops[i + 1], stops[i] + 1)
    legs[i] = table.move(timed.points, 3 * first - 2, 3 * last, 1, {})
  end
  return legs
end

local function track_of(places, legs)
  return { places = places, weight = PULL / #places, legs = legs }
end

-- The film along the path of `memory` with its share of what the vehicle can do; nil where no times
-- at that pace grant all wishes, but did at a faster one.
local function at_share(run, request, memory)
  local timed = run:time_path { points = memory.path, spacing = SPACING, rounding = ROUNDING,
                                vehicle = request.vehicle, share = memory.share,
                                speed = run.options.speed_limit }
  local positions = {}
  for i, k in ipairs(request.keyframes) do positions[i] = k.position end
  local stops = run:keyframe_stops { points = timed.points, keyframes = paths.flat(positions) }
  local legs = {}
  for i = 1, #stops - 1 do
    legs[i] = math.max(SHORTEST, timed.times[stops[i + 1]] - timed.times[stops[i]])
  end
  local chosen, refused = run:keyframe_times { wishes = request.wishes, legs = legs }
  if not chosen then
    if memory.share < 1 then return nil end
    local least = 0
    for i = 1, refused - 1 do least = least + legs[i] end
    run:fail("keyframes[" .. refused .. "]", string.format(
      "cannot be passed at its time: from the keyframe before, the path takes at least %.3g s, "
      .. "from the start %.3g s", legs[refused - 1] or 0, least))
  end
  times.check_battery(run, request.vehicle, chosen[#chosen])
  return film_times.set(request, chosen, { memory = memory, track = track_of(
    places_of(timed, stops, chosen), legs_of(timed, stops)) })
end

-- The film at its own pace, which gives the path.
function M.first(run, film)
  local asked = M.wishes(run, film, "path_first")
  local untimed = {}
  for i, k in ipairs(film.keyframes) do
    untimed[i] = { position = k.position, yaw_deg = k.yaw_deg, look_at = k.look_at,
                   subject = k.subject }
  end
  local keyframes = times.with_yaw((times.filled(untimed, nil, film.vehicle)))
  return requests.first { vehicle = film.vehicle, subjects = film.subjects, cuts = film.cuts,
                          terms = film.terms, origin = film.origin, keyframes = keyframes,
                          duration = keyframes[#keyframes].time, wishes = asked, memory = {} }
end

-- Whether an outcome holds and keeps the path; its largest distance from it goes to `figures`.
function M.keeps_path(run, outcome, figures)
  figures.path_error = run:path_distance { points = outcome.solution.path,
                                           path = outcome.request.memory.path }
  return outcome.holds and figures.path_error <= run.options.path_tolerance
end

-- The track of a film along the same path at the times of a solution with free `legs`.
function M.retimed(request, solution, legs)
  return track_of(film_times.places(solution, legs, PLACES), request.track.legs)
end

-- The next request after an outcome; told are {notes, figures}.
function M.next(run, outcome)
  local request, memory = outcome.request, outcome.request.memory
  if not memory.path then
    if not outcome.holds then
      return nil, { notes = { "the path at its fastest times is not certified: "
                              .. attempts.complaint(outcome) } }
    end
    local timed = { path = outcome.solution.path, share = 1 }
    local told = { notes = { "cancelled before the path was timed" } }
    if run:cancelled() then return nil, told end
    return at_share(run, requests.with(request, { legs = outcome.legs }), timed), told
  end
  local figures = { duration = request.duration, share = memory.share }
  if M.keeps_path(run, outcome, figures) then return nil, { notes = {}, figures = figures } end
  local share = memory.share * SLOWER
  local told = { figures = figures, notes = { string.format(
    "no timing down to %.2g of the limits of the vehicle keeps the path within %.3g m", share,
    run.options.path_tolerance) } }
  if share <= SLOWEST or run:cancelled() then return nil, told end
  local slower = { path = memory.path, share = share }
  return at_share(run, requests.with(request, { legs = outcome.legs }), slower), told
end

return M
