-- SPDX-License-Identifier: Apache-2.0
-- A floor of offices, indoors: a corridor with rooms on both sides, an open-plan hall, a kitchen,
-- desks, chairs, screens, shelves, lamps under the ceiling (after thesis 5.5.6, indoor scenes).
local colors = require "scene.colors"
local furniture = require "scene.street_furniture"
local walls = require "scene.walls"

local long, corridor, room_depth, high = 48, 2.6, 6.2, 3.1  -- m
local bay = 4                                               -- m, width of a room

-- A wall of 12 cm along +x with a doorway; the leaf stands open by `swing` (rad; nil: no leaf).
local function wall_with_door(scene, length, door, swing, glazed)
  colors.use(scene, "plaster")
  walls.archway(scene, length, high, 0.12, door, door + 0.95, 2.0)
  colors.use(scene, "frame")
  scene:box({door - 0.06, -0.03, 0}, {door, 0.15, 2.1})
  scene:box({door + 0.95, -0.03, 0}, {door + 1.01, 0.15, 2.1})
  if swing then
    colors.use(scene, "wood")
    scene:push({door + 0.04, 0.1, 0}, swing)
    scene:box({0, -0.02, 0.01}, {0.88, 0.02, 1.99})
    colors.use(scene, "metal")
    scene:tube({0.8, -0.06, 1.02}, {0.68, -0.06, 1.02}, 0.012, 0.012, 6)
    scene:pop()
  end
  if glazed and length - door > 2.2 then
    colors.use(scene, "glass")
    scene:box({door + 1.25, -0.03, 0.9}, {length - 0.25, 0.15, 2.1})
  end
end

local function outer_wall(scene, length)
  walls.facade(scene, {width = length, height = high, storey = high, color = "white", sill = true,
                       columns = math.floor(length / 2 + 0.5), recess = 0.25,
                       window = {width = 1.5, height = 1.6, sill = 0.9}})
end

local function chair(scene, at, yaw)
  scene:push(at, yaw)
  colors.use(scene, "dark")
  for i = 0, 4 do
    local a = 2 * math.pi * i / 5
    scene:tube({0, 0, 0.08}, {0.28 * math.cos(a), 0.28 * math.sin(a), 0.05}, 0.025, 0.02, 5)
    scene:ball({0.28 * math.cos(a), 0.28 * math.sin(a), 0.035}, {0.03, 0.03, 0.03}, 0)
  end
  scene:tube({0, 0, 0.08}, {0, 0, 0.45}, 0.03, 0.03, 8)
  colors.use(scene, "blue")
  scene:box({-0.24, -0.24, 0.45}, {0.24, 0.24, 0.52})
  scene:box({-0.22, -0.28, 0.58}, {0.22, -0.23, 1.05})
  scene:pop()
end

local function desk(scene, at, yaw)
  scene:push(at, yaw)
  colors.use(scene, "wood")
  scene:box({-0.8, 0, 0.72}, {0.8, 0.8, 0.75})
  colors.use(scene, "metal")
  for _, x in ipairs {-0.74, 0.7} do
    for _, y in ipairs {0.06, 0.7} do scene:box({x, y, 0}, {x + 0.04, y + 0.04, 0.72}) end
  end
  scene:box({0.35, 0.1, 0.12}, {0.7, 0.65, 0.62})
  colors.use(scene, "screen")
  local x = scene:uniform(-0.35, 0.1)
  scene:box({x - 0.28, 0.52, 0.88}, {x + 0.28, 0.55, 1.22})
  scene:box({x - 0.03, 0.55, 0.75}, {x + 0.03, 0.58, 1.1})
  scene:box({x - 0.12, 0.48, 0.75}, {x + 0.12, 0.66, 0.765})
  scene:box({x - 0.22, 0.14, 0.75}, {x + 0.22, 0.3, 0.77})
  colors.use(scene, "paper")
  for _ = 1, scene:integer(0, 3) do
    local px, py = scene:uniform(-0.75, 0.5), scene:uniform(0.05, 0.45)
    scene:box({px, py, 0.75}, {px + 0.21, py + 0.3, 0.75 + scene:uniform(0.01, 0.06)})
  end
  colors.use(scene, "white")
  scene:tube({0.6, 0.2, 0.75}, {0.6, 0.2, 0.85}, 0.04, 0.045, 10)
  chair(scene, {scene:uniform(-0.3, 0.2), -0.35, 0}, scene:uniform(-0.5, 0.5))
  scene:pop()
end

local function shelf(scene, at, yaw)
  scene:push(at, yaw)
  colors.use(scene, "wood")
  scene:box({0, 0.3, 0}, {1.2, 0.32, 2})
  for _, x in ipairs {0, 1.18} do scene:box({x, 0, 0}, {x + 0.02, 0.3, 2}) end
  for i = 0, 5 do scene:box({0.02, 0, 0.38 * i + 0.04}, {1.18, 0.3, 0.38 * i + 0.06}) end
  for i = 0, 4 do
    local x = 0.05
    while x < 1.0 do
      local w = scene:uniform(0.03, 0.08)
      if scene:uniform(0, 1) < 0.85 then
        colors.use(scene, colors.pick(scene, {"red", "blue", "paper", "dark", "ochre", "mint"}))
        scene:box({x, 0.04, 0.38 * i + 0.06},
                  {x + w, scene:uniform(0.2, 0.28), 0.38 * i + scene:uniform(0.26, 0.36)})
      end
      x = x + w + 0.004
    end
  end
  scene:pop()
end

local function ceiling_lamp(scene, x, y)
  colors.use(scene, "white")
  scene:box({x - 0.6, y - 0.15, high - 0.22}, {x + 0.6, y + 0.15, high - 0.16})
  colors.use(scene, "metal")
  for _, dx in ipairs {-0.5, 0.5} do
    scene:tube({x + dx, y, high - 0.16}, {x + dx, y, high}, 0.01, 0.01, 4)
  end
end

-- A room from the corridor's wall (y = 0) to the windows (y = room_depth), `width` wide.
local function room(scene, width, kind)
  if kind == "meeting" then
    colors.use(scene, "wood")
    scene:box({width / 2 - 0.7, 1.6, 0.7}, {width / 2 + 0.7, 4.8, 0.75})
    for _, y in ipairs {2, 4.3} do
      scene:box({width / 2 - 0.1, y, 0}, {width / 2 + 0.1, y + 0.2, 0.7})
    end
    for i = 0, 3 do
      chair(scene, {width / 2 - 1.1, 2 + 0.8 * i, 0}, -math.pi / 2)
      chair(scene, {width / 2 + 1.1, 2 + 0.8 * i, 0}, math.pi / 2)
    end
    colors.use(scene, "screen")
    scene:box({0.14, 2.2, 1.1}, {0.2, 4, 2.1})
  else
    desk(scene, {1.2, 3.4, 0}, math.pi / 2)
    desk(scene, {width - 1.2, 4.6, 0}, -math.pi / 2)
    shelf(scene, {width - 0.14, 0.7, 0}, math.pi / 2)
    shelf(scene, {width - 0.14, 2.0, 0}, math.pi / 2)
    if scene:uniform(0, 1) < 0.5 then
      colors.use(scene, "tiles")
      scene:tube({0.6, 5.6, 0}, {0.6, 5.6, 0.4}, 0.16, 0.22, 12)
      colors.use(scene, "leaf")
      scene:ball({0.6, 5.6, 0.95}, {0.35, 0.35, 0.5}, 2, 0.35)
    end
  end
  ceiling_lamp(scene, width / 2, 2)
  ceiling_lamp(scene, width / 2, 4.4)
end

local function side_of_rooms(scene, length, from)
  local x = from
  while x < length - 0.1 do
    local width = math.min(scene:uniform(0, 1) < 0.3 and 1.5 * bay or bay, length - x)
    if length - x - width < bay * 0.8 then width = length - x end
    scene:push({x, 0, 0})
    wall_with_door(scene, width, 0.5, scene:uniform(0.8, 2), true)
    room(scene, width, width > 1.2 * bay and "meeting" or "cell")
    colors.use(scene, "plaster")
    if x > 0 then scene:box({-0.06, 0.12, 0}, {0.06, room_depth, high}) end
    scene:pop()
    x = x + width
  end
end

return function(options)
  local scene = lapwing.scene { name = "office", seed = options.seed or 1 }
  local half, deep = corridor / 2, corridor / 2 + room_depth
  colors.use(scene, "carpet")
  scene:box({0, -deep - 0.3, -0.3}, {long, deep + 0.3, 0})
  colors.use(scene, "white")
  scene:box({0, -deep - 0.3, high}, {long, deep + 0.3, high + 0.3})
  scene:push({0, half, 0})
  side_of_rooms(scene, long, 0)
  scene:pop()
  scene:push({long, -half, 0}, math.pi)
  side_of_rooms(scene, long - 16, 0)
  scene:pop()
  -- The hall: open to the corridor, desks in groups behind low screens, a kitchen at its end.
  for i = 0, 2 do
    local x = 3.2 + 4.6 * i
    for k = 0, 1 do
      local y = -deep + 1.9 + 2.7 * k
      desk(scene, {x, y, 0}, 0)
      desk(scene, {x + 1.7, y, 0}, 0)
      desk(scene, {x, y - 0.1, 0}, math.pi)
      desk(scene, {x + 1.7, y - 0.1, 0}, math.pi)
      colors.use(scene, "mint")
      scene:box({x - 0.8, y - 0.07, 0.5}, {x + 2.5, y - 0.03, 1.35})
      ceiling_lamp(scene, x + 0.8, y)
    end
  end
  colors.use(scene, "stone")
  for _, x in ipairs {5.6, 11} do scene:box({x - 0.2, -half - 0.4, 0}, {x + 0.2, -half, high}) end
  furniture.table(scene, {1.4, -half - 1.6, 0})
  for i = 0, math.floor(long / 4) - 1 do ceiling_lamp(scene, 2 + 4 * i, 0) end
  -- Outer walls: their outside is that of walls.lua.
  for _, side in ipairs {{{0, -deep, 0}, 0, long}, {{long, deep, 0}, math.pi, long},
                         {{long, -deep, 0}, math.pi / 2, 2 * deep},
                         {{0, deep, 0}, -math.pi / 2, 2 * deep}} do
    scene:push(side[1], side[2])
    outer_wall(scene, side[3])
    scene:pop()
  end
  scene:region({0, -deep, 0}, {long, deep, high})
  scene:moves { step = 0.7, body = 0.6, clear = 2, speed = 0.7 }  -- through doorways of 0.95 m
  return scene
end
