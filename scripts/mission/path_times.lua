-- When the keyframes along a path are passed: the cheapest times that grant what each asks for.
local M = {}

local GRID = 0.05       -- s, between the times that are weighed
local MOST_TIMES = 20000

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
    local wish = keyframes[k]
    if not (wish.time or wish.time_weight or wish.earliest or wish.latest) then
      chosen[k] = math.min(chosen[k], chosen[k - 1] + legs[k - 1])
    end
  end
  return chosen
end

local function distance(a, b, i, j)
  return math.sqrt((a[i] - b[j]) ^ 2 + (a[i + 1] - b[j + 1]) ^ 2 + (a[i + 2] - b[j + 2]) ^ 2)
end

-- The place on the timed path nearest to each keyframe, in order: its number.
function M.stops(keyframes, timed)
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

return M
