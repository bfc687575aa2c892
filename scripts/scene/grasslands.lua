-- SPDX-License-Identifier: Apache-2.0
-- A walled keep with a round tower on open, rolling grass, with rocks and groups of trees (after
-- thesis 4.5.1, the scene "Grass lands": geometry that is mostly seen from places that are easy to
-- reach). The region of interest is the keep with its wall and the trees around it; missions that
-- look at the keep alone set a smaller one.
local colors = require "scene.colors"
local houses = require "scene.houses"
local nature = require "scene.nature"
local roofs = require "scene.roofs"
local walls = require "scene.walls"

local keep_width, keep_depth, keep_height = 14, 10, 9.5  -- m
local wall_radius, wall_height = 19, 3.6                 -- m, of the ring around the keep
local half, top = 32, 22                                 -- m, of the region

-- Flat where the keep stands, rolling beyond.
local function land(scene)
  local hills = nature.hills(scene, 6)
  return function(x, y)
    local r = math.sqrt(x * x + y * y)
    local share = math.min(1, math.max(0, (r - 14) / 30))
    return share * share * (3 - 2 * share) * hills(x, y)
  end
end

-- Merlons along a straight edge of `length` metres, at height z.
local function merlons(scene, length, z)
  for i = 0, math.floor((length - 0.8) / 1.6) do
    scene:box({1.6 * i, 0, z}, {1.6 * i + 0.9, 0.5, z + 0.9})
  end
end

local function round_tower(scene, x, y)
  local r, high, sides = 3, 15, 20
  colors.use(scene, "sandstone")
  scene:tube({x, y, -1}, {x, y, high}, r, r, sides)
  colors.use(scene, "stone")
  for _, z in ipairs {4.6, 9.4} do
    scene:tube({x, y, z}, {x, y, z + 0.4}, r + 0.2, r + 0.2, sides)
  end
  scene:tube({x, y, high - 1}, {x, y, high}, r, r + 0.6, sides)
  for i = 0, 9 do
    scene:push({x, y, high}, 2 * math.pi * i / 10)
    scene:box({r + 0.1, -0.5, 0}, {r + 0.6, 0.5, 1})
    scene:pop()
  end
  colors.use(scene, "dark")
  for i = 0, 5 do
    scene:push({x, y, 2.2 + 2 * (i % 3)}, 2 * math.pi * i / 6 + 0.3)
    scene:box({r - 0.05, -0.15, 0}, {r + 0.04, 0.15, 1.1})
    scene:pop()
  end
end

local function keep(scene)
  local w, d, h = keep_width, keep_depth, keep_height
  scene:push({-w / 2, -d / 2, 0})
  colors.use(scene, "stone")
  scene:box({-0.5, -0.5, -1}, {w + 0.5, d + 0.5, 0.3})
  houses.shell(scene, w, d, h, {
    color = "sandstone", storey = 3.1, recess = 0.45, front = {door = 2}, back = {door = 1},
    window = {width = 0.9, height = 1.5, sill = 1.1} })
  roofs.gable(scene, w, d, h, 4.6, {color = "slate", wall = "sandstone"})
  roofs.chimney(scene, w * 0.3, d * 0.4, h + 2.5, 3.2)
  roofs.dormer(scene, w * 0.6, d * 0.12, h + 1.6, 2.6, "sandstone")
  -- A porch: a vaulted passage before the door, open on three sides.
  scene:push({w * 0.32, -3.2, 0})
  colors.use(scene, "stone")
  walls.archway(scene, 5, 4.2, 0.5, 0.9, 4.1, 2)
  for _, x in ipairs {0, 4.5} do scene:box({x, 2.6, -0.5}, {x + 0.5, 3.1, 4.2}) end
  scene:box({-0.2, -0.2, 4.2}, {5.2, 3.2, 4.5})
  scene:pop()
  scene:pop()
  round_tower(scene, w / 2 + 1, d / 2)
end

-- The ring wall: straight pieces with a gate to the south and a breach to the north-east.
local function ring(scene, height_at)
  local pieces = 18
  for i = 0, pieces - 1 do
    local a = 2 * math.pi * i / pieces - math.pi / 2
    local b = a + 2 * math.pi / pieces
    local x0, y0 = wall_radius * math.cos(a), wall_radius * math.sin(a)
    local x1, y1 = wall_radius * math.cos(b), wall_radius * math.sin(b)
    local length = math.sqrt((x1 - x0) ^ 2 + (y1 - y0) ^ 2)
    local foot = math.min(height_at(x0, y0), height_at(x1, y1))
    scene:push({x0, y0, foot}, math.atan(y1 - y0, x1 - x0))
    colors.use(scene, "stone")
    if i == 0 then
      walls.archway(scene, length, wall_height + 1.6, 0.9, length / 2 - 1.6, length / 2 + 1.6, 2.4)
    elseif i == 11 then
      for k = 0, 5 do
        local z = scene:uniform(0.3, 1.4)
        scene:box({length * k / 6, 0, -1}, {length * (k + 1) / 6, 0.8, z})
      end
    else
      scene:box({0, 0, -1.5}, {length, 0.8, wall_height})
      merlons(scene, length, wall_height)
    end
    scene:pop()
  end
end

local function rock(scene, x, y, z, size)
  colors.use(scene, "stone")
  scene:ball({x, y, z + 0.25 * size},
             {size, size * scene:uniform(0.7, 1), size * scene:uniform(0.5, 0.8)}, 3, 0.3)
end

return function(options)
  local scene = lapwing.scene { name = "grasslands", seed = options.seed or 1 }
  local height_at = land(scene)
  colors.use(scene, "grass")
  nature.ground(scene, 260, 2.5, height_at)
  keep(scene)
  ring(scene, height_at)
  -- Three groups of trees outside the wall, two trees in the yard, and rocks.
  for group = 1, 3 do
    local a = 2 * math.pi * group / 3 + scene:uniform(-0.4, 0.4)
    for _ = 1, 5 do
      local r = scene:uniform(wall_radius + 5, half - 3)
      local b = a + scene:uniform(-0.35, 0.35)
      local x, y = r * math.cos(b), r * math.sin(b)
      local at = {x, y, height_at(x, y)}
      if scene:uniform(0, 1) < 0.6 then nature.tree(scene, at, scene:uniform(6, 10))
      else nature.fir(scene, at, scene:uniform(7, 12)) end
    end
  end
  nature.tree(scene, {-11.5, 8, height_at(-11.5, 8)}, 6.5)
  nature.tree(scene, {-12, -7, height_at(-12, -7)}, 5.5)
  for _ = 1, 14 do
    local a, r = scene:uniform(0, 2 * math.pi), scene:uniform(wall_radius + 3, half + 8)
    local x, y = r * math.cos(a), r * math.sin(a)
    rock(scene, x, y, height_at(x, y), scene:uniform(0.6, 2.2))
  end
  for _ = 1, 12 do
    local a, r = scene:uniform(0, 2 * math.pi), scene:uniform(half + 10, 100)
    local x, y = r * math.cos(a), r * math.sin(a)
    nature.tree(scene, {x, y, height_at(x, y)}, scene:uniform(6, 11))
  end
  scene:region({-half, -half, -5}, {half, half, top})
  return scene
end
