-- SPDX-License-Identifier: Apache-2.0
-- A renaissance church on a square: nave and aisles, transept with a dome, a tower, a porch with
-- columns before a portal of nested arches (after thesis 4.5.5: "geometric concavities such as the
-- portal").
local colors = require "scene.colors"
local furniture = require "scene.street_furniture"
local nature = require "scene.nature"
local parts = require "scene.church_parts"
local roofs = require "scene.roofs"
local walls = require "scene.walls"

local nave_width, nave_length, nave_height = 14, 44, 17
local aisle_width, aisle_height = 5.5, 9

-- The west front: a portal of arches that step inwards, a porch before it, a round window above.
local function front(scene)
  local w, steps = nave_width, 6
  for i = 0, steps - 1 do
    local half, deep = 3.2 - 0.32 * i, 0.42
    colors.use(scene, i % 2 == 0 and "sandstone" or "stone")
    scene:push({0, deep * i, 0})
    walls.archway(scene, w, 10, deep, w / 2 - half, w / 2 + half, 4.4 - 0.1 * i)
    scene:pop()
  end
  colors.use(scene, "dark_wood")
  scene:quad({w / 2 - 2, 2.5, 0}, {w / 2 + 2, 2.5, 0}, {w / 2 + 2, 2.5, 7}, {w / 2 - 2, 2.5, 7})
  for i = 0, 5 do
    scene:box({w / 2 - 1.5 + 0.5 * i, 2.42, 0.2}, {w / 2 - 1.15 + 0.5 * i, 2.5, 4})
  end
  -- Above: a wall with a round window, spokes in it.
  colors.use(scene, "sandstone")
  walls.panel(scene, 0, 10, w, nave_height)
  colors.use(scene, "stone")
  local cx, cz, r = w / 2, 13.4, 2.2
  for i = 0, 23 do
    local a, b = 2 * math.pi * i / 24, 2 * math.pi * (i + 1) / 24
    scene:tube({cx + r * math.cos(a), -0.05, cz + r * math.sin(a)},
               {cx + r * math.cos(b), -0.05, cz + r * math.sin(b)}, 0.28, 0.28, 8)
    if i % 2 == 0 then
      scene:tube({cx, -0.05, cz}, {cx + r * math.cos(a), -0.05, cz + r * math.sin(a)}, 0.08,
                 0.08, 6)
    end
  end
  colors.use(scene, "glass")
  scene:tube({cx, -0.12, cz}, {cx, 0.02, cz}, r, r, 24)
  -- The porch: a deep hall on columns under a pediment.
  local deep, high = 6, 8.2
  for i = 0, 5 do
    local x = 0.8 + (w - 1.6) * i / 5
    parts.column(scene, x, -deep + 0.6, high, 0.42)
    if i == 0 or i == 5 then parts.column(scene, x, -deep / 2, high, 0.42) end
  end
  colors.use(scene, "sandstone")
  scene:box({-0.3, -deep, high}, {w + 0.3, 0, high + 1.2})
  scene:push({w + 0.6, -deep - 0.3, high + 1.2}, math.pi / 2)
  roofs.extrude(scene, {{0, 0}, {w + 1.2, 0}, {w / 2 + 0.6, 3}}, 0, deep + 0.3)
  scene:pop()
  colors.use(scene, "stone")
  for i = 0, 5 do
    scene:box({-1.2 - 0.3 * i, -deep - 1.4 - 0.38 * i, 0},
              {w + 1.2 + 0.3 * i, -deep - 1 - 0.38 * i, 0.18 * (6 - i) / 2})
  end
  scene:box({-1, -deep - 1, 0}, {w + 1, 0, 0.25})
end

local function tower(scene, at)
  scene:push(at)
  local side, height = 7.5, 30
  for i = 0, 3 do
    local corner = ({{0, 0}, {side, 0}, {side, side}, {0, side}})[i + 1]
    scene:push({corner[1], corner[2], 0}, math.pi / 2 * i)
    walls.facade(scene, {width = side, height = 20, color = "sandstone", storey = 6.5, columns = 1,
                         window = {width = 1, height = 2.4, sill = 2.8}, recess = 0.6})
    colors.use(scene, "sandstone")
    scene:push({0, 0, 20})
    walls.archway(scene, side, 9, 0.7, 1.6, side - 1.6, 4)
    scene:pop()
    colors.use(scene, "stone")
    for _, z in ipairs {6.4, 12.9, 19.7, 28.6} do
      scene:box({-0.3, -0.3, z}, {side + 0.3, 0, z + 0.5})
    end
    scene:pop()
  end
  colors.use(scene, "stone")
  scene:box({0.7, 0.7, 19.6}, {side - 0.7, side - 0.7, 20})
  colors.use(scene, "metal")
  scene:tube({side / 2, side / 2, 24.2}, {side / 2, side / 2, 25.6}, 1.1, 0.4, 16)
  scene:box({side / 2 - 0.1, 0.5, 25.6}, {side / 2 + 0.1, side - 0.5, 25.9})
  colors.use(scene, "slate")
  scene:tube({side / 2, side / 2, height - 1}, {side / 2, side / 2, height + 12}, side * 0.72, 0, 8)
  colors.use(scene, "metal")
  scene:tube({side / 2, side / 2, height + 11.8}, {side / 2, side / 2, height + 14}, 0.08, 0.08, 6)
  scene:box({side / 2 - 0.6, side / 2 - 0.07, height + 13},
            {side / 2 + 0.6, side / 2 + 0.07, height + 13.15})
  scene:pop()
end

local function dome(scene, x, y, z)
  colors.use(scene, "sandstone")
  local sides, r, drum = 16, 6, 5
  for i = 0, sides - 1 do
    local a = 2 * math.pi * i / sides
    scene:push({x, y, z}, a)
    local w = 2 * r * math.tan(math.pi / sides)
    scene:push({-w / 2, -r, 0})
    parts.wall(scene, w, drum, 0.8, 3.4, 1, false)
    scene:pop()
    colors.use(scene, "stone")
    scene:box({-w / 2 - 0.15, -r - 0.35, 0}, {-w / 2 + 0.15, -r + 0.1, drum})
    scene:pop()
  end
  colors.use(scene, "slate")
  scene:ball({x, y, z + drum - 0.3}, {r + 0.3, r + 0.3, r + 0.5}, 4)
  colors.use(scene, "stone")
  scene:tube({x, y, z + drum + r - 0.1}, {x, y, z + drum + r + 2.6}, 1.1, 1.0, 12)
  colors.use(scene, "slate")
  scene:tube({x, y, z + drum + r + 2.6}, {x, y, z + drum + r + 4.6}, 1.4, 0, 12)
end

-- The body, the front towards -y of the frame at y = 0.
local function body(scene)
  local w, l = nave_width, nave_length
  for _, side in ipairs {{w, 2.5, math.pi / 2, l - 2.5}, {0, l, -math.pi / 2, l - 2.5}} do
    scene:push({side[1], side[2], aisle_height}, side[3])
    parts.wall(scene, side[4], nave_height - aisle_height, 1.2, 5.2, 8, false)
    scene:pop()
  end
  -- Aisles with lean-to roofs; flying ribs over them.
  for _, mirrored in ipairs {false, true} do
    scene:push(mirrored and {w / 2, l / 2, 0} or {0, 0, 0}, mirrored and math.pi or 0)
    if mirrored then scene:push({-w / 2, -l / 2, 0}) end
    local x, start, long = w + aisle_width, mirrored and 0 or 5, l - 5
    scene:push({x, start, 0}, math.pi / 2)
    parts.wall(scene, long, aisle_height - 1.8, 1.8, 4.4, 7, true)
    scene:pop()
    colors.use(scene, "sandstone")
    scene:box({w - 0.3, start, 0}, {x - 0.75, start + 0.6, aisle_height - 1.8})
    scene:box({w - 0.3, start + long - 0.6, 0}, {x - 0.75, start + long, aisle_height - 1.8})
    scene:push({x + 0.5, start, 0}, math.pi / 2)
    colors.use(scene, "tiles")
    roofs.extrude(scene, {{0, aisle_height - 2}, {aisle_width + 0.6, aisle_height + 0.4},
                          {aisle_width + 0.6, aisle_height + 0.65}, {0, aisle_height - 1.75}},
                  0, long)
    scene:pop()
    colors.use(scene, "stone")
    for i = 1, 6 do
      scene:tube({x - 0.5, start + long * i / 7, aisle_height - 1},
                 {w - 0.1, start + long * i / 7, nave_height - 3.5}, 0.3, 0.3, 8)
    end
    if mirrored then scene:pop() end
    scene:pop()
  end
  -- The apse: half a drum behind.
  for i = 0, 7 do
    local a = math.pi * (i + 0.5) / 8
    local r = w / 2
    local wide = 2 * r * math.tan(math.pi / 16)
    scene:push({w / 2, l, 0}, a + math.pi / 2)
    scene:push({-wide / 2, -r, 0})
    parts.wall(scene, wide, 12, 3, 6.5, 1, true)
    scene:pop()
    scene:pop()
  end
  colors.use(scene, "tiles")
  scene:tube({w / 2, l, 12}, {w / 2, l, 16.5}, w / 2 + 0.6, 0, 32)
  colors.use(scene, "sandstone")
  scene:push({w, l, 12}, math.pi)
  walls.panel(scene, 0, 0, w, nave_height - 12)
  scene:pop()
  scene:push({w, 0, 0}, math.pi / 2)
  roofs.gable(scene, l, w, nave_height, 6, {wall = "sandstone", verge = 0.2, eaves = 0.5})
  scene:pop()
end

return function(options)
  local scene = lapwing.scene { name = "church", seed = options.seed or 1 }
  colors.use(scene, "cobbles")
  nature.ground(scene, 180, 6, nature.hills(scene, 0.04))
  scene:push({-nave_width / 2, -nave_length / 2, 0})
  front(scene)
  body(scene)
  tower(scene, {-8.2, -1.5, 0})
  dome(scene, nave_width / 2, nave_length - 9, nave_height + 1.5)
  scene:pop()
  -- The square: trees, benches, lamps, a low wall.
  for i = 0, 7 do
    local y = -34 + 9 * i
    for _, x in ipairs {-27, 27} do
      nature.tree(scene, {x + scene:uniform(-1, 1), y, 0}, scene:uniform(8, 12))
      if i % 2 == 0 then furniture.lamp(scene, {x * 0.8, y + 4, 0}, x > 0 and math.pi / 2 or 0) end
    end
    if i < 4 then furniture.bench(scene, {-12 + 8 * i, -39, 0}, math.pi) end
  end
  colors.use(scene, "stone")
  for i = 0, 11 do
    local x = -33 + 5.5 * i
    scene:box({x, 36, 0}, {x + 5.2, 36.5, 1.1 + 0.04 * (i % 3)})
  end
  scene:region({-20, -33, -0.3}, {20, 31, 46})
  return scene
end
