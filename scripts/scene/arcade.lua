-- SPDX-License-Identifier: Apache-2.0
-- Covered markets: halls, shops, stores and passages under ceilings of 2.6 to 5 m, with doorways
-- and arches between them, columns, shelves, stalls, counters and crates; now and then a court that
-- is open to the sky. Every seed is another plan. For training indoors.
local colors = require "scene.colors"
local furniture = require "scene.street_furniture"
local market = require "scene.market"
local nature = require "scene.nature"

local THICK = 0.2               -- m, of walls
local WAY, LEAST = 1.1, 2.4     -- m: of doorways at least, edge of the smallest room

-- A wall along +x of the frame from 0 to `length`, with openings {from, to, height}, sorted.
local function wall(scene, length, high, openings)
  colors.use(scene, colors.pick(scene, colors.town))
  local from = 0
  for _, o in ipairs(openings) do
    if o[1] - from > 1e-3 then scene:box({from, -THICK / 2, 0}, {o[1], THICK / 2, high}) end
    if high - o[3] > 1e-3 then scene:box({o[1], -THICK / 2, o[3]}, {o[2], THICK / 2, high}) end
    if o.sill then scene:box({o[1], -THICK / 2, 0}, {o[2], THICK / 2, o.sill}) end
    from = o[2]
  end
  if length - from > 1e-3 then scene:box({from, -THICK / 2, 0}, {length, THICK / 2, high}) end
end

-- Openings of a wall that no other wall's end (`ends`, m along it) stands in: one that leads
-- through at least; doorways, gateways, now and then a hatch above a counter.
local function openings_of(scene, length, ends, high)
  local openings = {}
  for try = 1, 40 do
    if #openings >= math.max(1, length / 9) then break end
    local wide = scene:uniform(0, 1) < 0.6 and scene:uniform(WAY, 1.6) or scene:uniform(1.8, 4)
    if try > 20 then wide = WAY end
    if length > wide + 0.6 then
      local x = scene:uniform(0.3, length - wide - 0.3)
      local free = true
      for _, e in ipairs(ends) do free = free and (e < x - 0.3 or e > x + wide + 0.3) end
      for _, o in ipairs(openings) do
        free = free and (o[2] < x - 0.3 or o[1] > x + wide + 0.3)
      end
      if free then
        local o = {x, x + wide, math.min(high - 0.2, scene:uniform(2.1, 3.2))}
        if #openings > 0 and scene:uniform(0, 1) < 0.3 then o.sill = scene:uniform(0.8, 1.2) end
        openings[#openings + 1] = o
      end
    end
  end
  table.sort(openings, function(a, b) return a[1] < b[1] end)
  return openings
end

-- Divides a floor {x0, y0, x1, y1} into rooms with walls between them. `plan` collects the rooms
-- and the middles of ways; returned are the walls that end at the floor's edges, as {axis, at}.
local function divide(scene, plan, floor, largest)
  local size = {floor[3] - floor[1], floor[4] - floor[2]}
  local axis = size[1] >= size[2] and 1 or 2
  local room = size[axis] < 2 * LEAST + THICK or
      (size[1] < largest and size[2] < largest * 0.8) or
      (size[1] * size[2] < largest * largest and scene:uniform(0, 1) < 0.2)
  if room then
    plan.rooms[#plan.rooms + 1] = floor
    return {}
  end
  local other = 3 - axis
  local cut = size[axis] * scene:uniform(0.32, 0.68)
  if size[axis] > 8 and scene:uniform(0, 1) < 0.3 then cut = scene:uniform(LEAST, 3) end  -- passage
  cut = floor[axis] + math.min(math.max(cut, LEAST), size[axis] - LEAST)
  local one, two = {table.unpack(floor)}, {table.unpack(floor)}
  one[axis + 2], two[axis] = cut, cut
  local found, ends = {}, {}
  for _, part in ipairs {one, two} do
    for _, w in ipairs(divide(scene, plan, part, largest)) do
      if w[1] == other then ends[#ends + 1] = w[2] - floor[other]
      else found[#found + 1] = w end
    end
  end
  found[#found + 1] = {axis, cut}
  local openings = openings_of(scene, size[other], ends, plan.high)
  if axis == 1 then scene:push({cut, floor[2], 0}, math.pi / 2)
  else scene:push({floor[1], cut, 0}) end
  wall(scene, size[other], plan.high, openings)
  scene:pop()
  for _, o in ipairs(openings) do
    local p = {cut, cut}
    p[other] = floor[other] + (o[1] + o[2]) / 2
    plan.ways[#plan.ways + 1] = p
  end
  return found
end

local function clear_of_ways(plan, x, y)
  for _, p in ipairs(plan.ways) do
    if (p[1] - x) ^ 2 + (p[2] - y) ^ 2 < 2.6 then return false end
  end
  return true
end

-- Things on a grid in a room, by its kind, none where a way leads in.
local function furnish(scene, plan, room, kind, high)
  local pitch = ({hall = 3, stalls = 2.5, store = 1.9, work = 1.7, bare = 2.2})[kind]
  local margin = ({hall = 1.2, stalls = 1.5, store = 0.9, work = 0.8, bare = 1})[kind]
  local w, d = room[3] - room[1] - 2 * margin, room[4] - room[2] - 2 * margin
  local columns, rows = math.floor(w / pitch), math.floor(d / pitch)
  for i = 0, columns do
    for k = 0, rows do
      local x = room[1] + margin + (columns > 0 and w * i / columns or w / 2)
      local y = room[2] + margin + (rows > 0 and d * k / rows or d / 2)
      local free = w > 0 and d > 0 and clear_of_ways(plan, x, y)
      local drawn = scene:uniform(0, 1)
      if free and (kind == "hall" or drawn < 0.8) then
        scene:push({x, y, 0}, math.pi / 2 * scene:integer(0, 3))
        if kind == "hall" then
          if (i + k) % 2 == 0 then market.column(scene, high)
          else furniture.bench(scene, {0, 0, 0}) end
        elseif kind == "stalls" and drawn < 0.45 and high > 3 then
          furniture.awning(scene, {-0.9, -0.8, 0}, 0, 1.8, 1.6)
          market.counter(scene)
        elseif kind == "stalls" then market.counter(scene)
        elseif kind == "store" then
          scene:push({-0.7, -0.2, 0})
          market.rack(scene, 1.4, 0.4, math.min(high - 0.4, scene:uniform(1.1, 2.4)))
          scene:pop()
        elseif kind == "work" and drawn < 0.45 then furniture.table(scene, {0, 0, 0})
        elseif kind == "work" or drawn < 0.4 then market.crates(scene) end
        scene:pop()
      end
    end
  end
end

-- Racks along the four walls, none where a way leads in.
local function line_walls(scene, plan, room, high)
  local w, d = room[3] - room[1], room[4] - room[2]
  for _, s in ipairs {{room[1], room[2], 0, w}, {room[3], room[2], math.pi / 2, d},
                      {room[3], room[4], math.pi, w}, {room[1], room[4], -math.pi / 2, d}} do
    local c, n, at = math.cos(s[3]), math.sin(s[3]), 0.7
    while at + 1.6 < s[4] do
      if scene:uniform(0, 1) < 0.6 and
          clear_of_ways(plan, s[1] + c * (at + 0.6), s[2] + n * (at + 0.6)) then
        scene:push({s[1] + c * at - n * THICK / 2, s[2] + n * at + c * THICK / 2, 0}, s[3])
        market.rack(scene, 1.2, 0.35, math.min(high - 0.3, scene:uniform(1, 2.3)))
        scene:pop()
      end
      at = at + scene:uniform(1.25, 2)
    end
  end
end

local function ceiling(scene, plan, room, high)
  colors.use(scene, "white")
  scene:box({room[1], room[2], high}, {room[3], room[4], plan.high + 0.2})
  for i = 0, math.floor((room[3] - room[1]) / 3) do  -- lamps
    local x, y = room[1] + 0.9 + 3 * i, (room[2] + room[4]) / 2 + scene:uniform(-0.5, 0.5)
    if x < room[3] - 0.5 then
      scene:box({x - 0.3, y - 0.3, high - 0.5}, {x + 0.3, y + 0.3, high - 0.42})
      scene:tube({x, y, high - 0.42}, {x, y, high}, 0.015, 0.015, 4)
    end
  end
  colors.use(scene, "dark")
  if high < 3.4 then return end
  for i = 1, math.floor((room[3] - room[1]) / 2.5) do  -- beams
    local x = room[1] + 2.5 * i - 1.2
    scene:box({x, room[2], high - 0.3}, {x + 0.25, room[4], high})
  end
end

return function(options)
  local scene = lapwing.scene { name = "arcade", seed = options.seed or 1 }
  local long, wide = scene:uniform(34, 50), scene:uniform(18, 28)
  local plan = {rooms = {}, ways = {}, high = 5}
  colors.use(scene, "cobbles")
  scene:box({-THICK, -THICK, -0.3}, {long + THICK, wide + THICK, 0})
  divide(scene, plan, {0, 0, long, wide}, scene:uniform(7, 15))
  for _, s in ipairs {{{0, 0, 0}, 0, long}, {{long, 0, 0}, math.pi / 2, wide},
                      {{long, wide, 0}, math.pi, long}, {{0, wide, 0}, -math.pi / 2, wide}} do
    scene:push(s[1], s[2])
    wall(scene, s[3], plan.high, {})
    scene:pop()
  end
  local courts = scene:uniform(0, 1) < 0.25
  for _, room in ipairs(plan.rooms) do
    local w, d = room[3] - room[1], room[4] - room[2]
    local least = math.min(w, d)
    local high = least > 5.5 and scene:uniform(3, plan.high) or scene:uniform(2.6, 3.6)
    local kind = colors.pick(scene, least > 6 and {"hall", "stalls", "store", "work", "bare"} or
                             {"store", "work", "work", "bare"})
    if courts and least > 5.5 then
      courts = false
      nature.tree(scene, {room[1] + w / 2, room[2] + d / 2, 0}, 4.5)
    else
      ceiling(scene, plan, room, high)
      furnish(scene, plan, room, kind, high)
      if kind ~= "hall" and kind ~= "bare" then line_walls(scene, plan, room, high) end
      if high > 4.4 and kind ~= "hall" then market.gallery(scene, room) end
    end
  end
  scene:region({0, 0, 0}, {long, wide, plan.high})
  scene:moves { step = 0.7, body = 0.6, clear = 2, speed = 0.7 }
  return scene
end
