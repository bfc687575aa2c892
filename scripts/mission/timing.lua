-- Free timing: the times of keyframes as wishes, and the fastest feasible timing along a path that
-- is kept (path_first). Where times are kept, the path gives: every other film.
local times = require "mission.keyframe_times"

local M = {}

local GRID = 0.05       -- s, between the times that are weighed
local MOST_TIMES = 20000
local SPACING = 0.05    -- m, of the path that is timed
local ROUNDING = 0.4    -- m, of the corners that stages make of a smooth path
local PLACES = 0.2      -- s, between the places that draw the flight to the path
local PULL = 2e4        -- weight of all those places together, per m^2
local SLOWER, SLOWEST = 0.93, 0.25  -- share of what the vehicle can do, when it cannot follow

local function wishes(k) return k.time_weight or k.earliest or k.latest end

-- What keyframes wish makes sense together, and with the option `timing`.
function M.check(run, shot)
  for i, k in ipairs(shot.keyframes) do
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

-- What it costs to pass keyframe k at `time`; math.huge: it may not.
local function price(k, time, is_last)
  local cost = is_last and time or 0
  if k.time_weight then return cost + k.time_weight * (time - k.time) ^ 2 end
  if k.time and math.abs(time - k.time) > 1e-9 then return math.huge end
  if time < (k.earliest or 0) - 1e-9 or time > (k.latest or math.huge) + 1e-9 then
    return math.huge
  end
  return cost
end

-- All times that may be chosen: a grid, and every time that somebody named.
local function candidates(keyframes, fastest)
  local finish, list = fastest, {}
  for _, k in ipairs(keyframes) do
    for _, t in ipairs { k.time or 0, k.earliest or 0, k.latest or 0 } do
      finish = math.max(finish, t)
      list[#list + 1] = t
    end
  end
  local room = finish + fastest
  local step = math.max(GRID, room / MOST_TIMES)
  for i = 0, math.ceil(room / step) do list[#list + 1] = i * step end
  table.sort(list)
  return list
end

-- The cheapest times at which keyframes are passed, each leg lasting at least legs[i] seconds: from
-- keyframe to keyframe the least price of every time, by dynamic programming. Or nil and the
-- keyframe that cannot have its time.
function M.cheapest(keyframes, legs)
  local fastest = 0
  for _, leg in ipairs(legs) do fastest = fastest + leg end
  local list, count = candidates(keyframes, fastest), #keyframes
  local least, from = {}, {}
  for j, t in ipairs(list) do
    least[j] = t == 0 and price(keyframes[1], 0, count == 1) or math.huge
  end
  for k = 2, count do
    local before, best, place, i = least, math.huge, nil, 1
    least, from[k] = {}, {}
    local any = false
    for j, t in ipairs(list) do
      while i <= #list and list[i] <= t - legs[k - 1] + 1e-9 do
        if before[i] < best then best, place = before[i], i end
        i = i + 1
      end
      least[j] = best < math.huge and best + price(keyframes[k], t, k == count) or math.huge
      from[k][j] = place
      any = any or least[j] < math.huge
    end
    if not any then return nil, k end
  end
  local last = 1
  for j in ipairs(list) do if least[j] < least[last] then last = j end end
  if least[last] == math.huge then return nil, 1 end
  local chosen = {}
  for k = count, 1, -1 do
    chosen[k] = list[last]
    last = k > 1 and from[k][last] or last
  end
  for k = 2, count do  -- what nobody wished for need not wait for the grid
    if not keyframes[k].time and not wishes(keyframes[k]) then
      chosen[k] = math.min(chosen[k], chosen[k - 1] + legs[k - 1])
    end
  end
  return chosen
end

local function distance(a, b, i, j)
  return math.sqrt((a[i] - b[j]) ^ 2 + (a[i + 1] - b[j + 1]) ^ 2 + (a[i + 2] - b[j + 2]) ^ 2)
end

-- The place on the timed path nearest to each keyframe, in order: its number.
local function stops_of(keyframes, timed)
  local count, first, stops = #timed.times, 1, {}
  local around = math.max(1, count // #keyframes)
  for i, k in ipairs(keyframes) do
    local best, least = first, math.huge
    for j = first, math.min(count, first + (i > 1 and 3 * around or 0)) do
      local d = distance(timed.points, k.position, 3 * j - 2, 1)
      if d < least then best, least = j, d end
    end
    stops[i], first = best, best
  end
  stops[1], stops[#stops] = 1, count
  return stops
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
      places[#places + 1] = { time = time, value = { timed.points[3 * j - 2],
                              timed.points[3 * j - 1], timed.points[3 * j] } }
      next_time = time + PLACES
    end
  end
  if #places > 1 and places[#places].time - places[#places - 1].time < 1e-3 then
    table.remove(places, #places - 1)
  end
  return places
end

-- A film at its own pace gives the path; then faster, as the vehicle allows, until it follows
-- within the tolerance. Gives what came of it, sentences, and figures.
function M.fly(run, shot, attempt, holds)
  local o = run.options
  if o.stretch ~= 1 then run:fail("stretch", "path_first finds the times itself") end
  local wanted = shot.keyframes
  local own, last = {}, wanted[#wanted]
  if #wanted < 2 then run:fail("keyframes", "path_first needs two at least") end
  if (wanted[1].time or wanted[1].earliest or 0) > 0 then
    run:fail("keyframes[1]", "path_first starts in the first keyframe, at 0 s")
  end
  for i, k in ipairs(wanted) do
    own[i] = { position = k.position, yaw_deg = k.yaw_deg, look_at = k.look_at,
               subject = k.subject }
  end
  if shot.duration and not (last.time or wishes(last)) then last.time = shot.duration end
  shot.keyframes, shot.duration = own, nil
  times.fill(shot, shot.vehicle)
  times.unwrap_yaw(own)
  shot.duration = own[#own].time
  local base = attempt(run, shot, 1)
  if not holds(base) then
    return base, { "the path at its own pace is not certified: "
                   .. (base.verdict.failures[1] or base.solution.message) }
  end
  local path, share, tried = base.solution.path, 1, nil
  while share > SLOWEST and not run:cancelled() do
    local timed = run:time_path { points = path, spacing = SPACING, rounding = ROUNDING,
                                  vehicle = shot.vehicle, share = share,
                                  speed = run.options.speed_limit }
    local stops, legs = stops_of(own, timed), {}
    for i = 1, #stops - 1 do
      legs[i] = math.max(0.05, timed.times[stops[i + 1]] - timed.times[stops[i]])
    end
    local chosen, which = M.cheapest(wanted, legs)
    if not chosen then
      if tried then break end
      local least = 0
      for i = 1, which - 1 do least = least + legs[i] end
      run:fail("keyframes[" .. which .. "]", string.format(
        "cannot be passed when it asks to be: from the one before it the path takes %.3g s at "
        .. "least, from the start %.3g s", legs[which - 1] or 0, least))
    end
    for i, k in ipairs(own) do k.time = chosen[i] end
    shot.duration = chosen[#chosen]
    times.check_battery(run, shot, 1)
    shot.track = places_of(timed, stops, chosen)
    shot.track_weight = PULL / #shot.track
    tried = attempt(run, shot, 1)
    local figures = { duration = shot.duration, share = share,
                      path_error = run:path_distance { points = tried.solution.path, path = path } }
    if holds(tried) and figures.path_error <= o.path_tolerance then return tried, {}, figures end
    tried.figures = figures
    share = share * SLOWER
  end
  if not tried then return base, { "cancelled before the path was timed" } end
  return tried, { string.format("no timing down to %.2g of what the vehicle can do keeps the path "
                                .. "within %.3g m", share, o.path_tolerance) }, tried.figures
end

return M
