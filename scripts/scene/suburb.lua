-- SPDX-License-Identifier: Apache-2.0
-- Houses in their gardens along two lanes on gentle hills: trees, hedges, sheds, fences, cars, and
-- power lines on poles (after thesis 5.4.5, the suburban scene).
local colors = require "scene.colors"
local furniture = require "scene.street_furniture"
local houses = require "scene.houses"
local nature = require "scene.nature"

local lots, lot_width, lot_depth = 5, 21, 26  -- a side of a lane; m
local lane = 6                                -- m wide

local function fence(scene, from, to, height)
  local dx, dy = to[1] - from[1], to[2] - from[2]
  local length = math.sqrt(dx * dx + dy * dy)
  scene:push({from[1], from[2], from[3] or 0}, math.atan(dy, dx))
  colors.use(scene, "wood")
  local posts = math.max(1, math.floor(length / 2))
  for i = 0, posts do
    local x = length * i / posts
    scene:box({x - 0.05, -0.05, -0.6}, {x + 0.05, 0.05, height})
  end
  for _, z in ipairs {0.35, height - 0.2} do scene:box({0, 0.05, z}, {length, 0.09, z + 0.09}) end
  for i = 0, math.floor(length / 0.33) do
    scene:box({i * 0.33, 0.09, 0.05}, {math.min(i * 0.33 + 0.2, length), 0.11, height - 0.05})
  end
  scene:pop()
end

local function shed(scene, at, yaw)
  scene:push(at, yaw)
  colors.use(scene, "wood")
  scene:box({0, 0, -0.5}, {3, 2.4, 2.1})
  colors.use(scene, "dark_wood")
  scene:box({1, -0.04, 0}, {1.9, 0, 1.9})
  colors.use(scene, "tar")
  scene:box({-0.2, -0.4, 2.1}, {3.2, 2.7, 2.25})
  scene:pop()
end

-- A swing, a trampoline or a pool: what gardens hold.
local function plaything(scene, at)
  scene:push(at)
  local what = scene:integer(1, 3)
  if what == 1 then
    colors.use(scene, "red")
    for _, x in ipairs {0, 2.6} do
      scene:tube({x, -0.8, -0.3}, {x, 0, 2.2}, 0.05)
      scene:tube({x, 0.8, -0.3}, {x, 0, 2.2}, 0.05)
    end
    scene:tube({0, 0, 2.2}, {2.6, 0, 2.2}, 0.05)
    for _, x in ipairs {1, 1.5} do scene:tube({x, 0, 2.2}, {x, 0, 0.5}, 0.015, 0.015, 4) end
    scene:box({0.95, -0.12, 0.46}, {1.55, 0.12, 0.5})
  elseif what == 2 then
    colors.use(scene, "dark")
    scene:tube({0, 0, 0.85}, {0, 0, 0.9}, 1.8, 1.8, 20)
    colors.use(scene, "blue")
    for i = 0, 7 do
      local a = 2 * math.pi * i / 8
      scene:tube({1.8 * math.cos(a), 1.8 * math.sin(a), -0.3},
                 {1.8 * math.cos(a), 1.8 * math.sin(a), 2.4}, 0.05)
    end
  else
    colors.use(scene, "blue")
    scene:tube({0, 0, -0.3}, {0, 0, 0.9}, 2, 2, 24)
  end
  scene:pop()
end

-- A garden with its house; the frame's origin is the middle of its edge on the lane, the lot
-- reaches along +y.
local function lot(scene, height_at)
  local w, d = scene:uniform(9.5, 12), scene:uniform(8, 9.5)
  local x0, y0 = -w / 2 + scene:uniform(-1.5, 1), scene:uniform(6.5, 8)
  local base = height_at(0, y0 + d / 2) + 0.35
  scene:push({x0, y0, base})
  colors.use(scene, "concrete")
  scene:box({-0.1, -0.1, -1.6}, {w + 0.1, d + 0.1, 0})
  houses.detached(scene, w, d, {storeys = scene:integer(1, 2), hip = scene:uniform(0, 1) < 0.35})
  scene:pop()
  if scene:uniform(0, 1) < 0.6 then  -- a garage
    scene:push({x0 + w + 0.8, y0 + 1.5, height_at(x0 + w + 2, y0 + 4) + 0.2})
    colors.use(scene, "white")
    scene:box({0, 0, -1.5}, {3.4, 6, 2.6})
    colors.use(scene, "metal")
    scene:box({0.4, -0.05, 0}, {3, 0, 2.2})
    colors.use(scene, "tar")
    scene:box({-0.2, -0.3, 2.6}, {3.6, 6.2, 2.8})
    scene:pop()
    if scene:uniform(0, 1) < 0.7 then
      furniture.car(scene, {x0 + w + 2.4, y0 - 2.8, height_at(x0 + w + 2.4, y0 - 2.8) + 0.05},
                    math.pi / 2)
    end
  end
  local function at(x, y) return {x, y, height_at(x, y)} end
  local half = lot_width / 2 - 0.3
  if scene:uniform(0, 1) < 0.5 then
    nature.hedge(scene, at(-half, 1.5), at(-1.5, 1.5), 1.1)
    nature.hedge(scene, at(4.5, 1.5), at(half, 1.5), 1.1)
  else
    fence(scene, at(-half, 1.5), at(-1.5, 1.5), 1.0)
    fence(scene, at(4.5, 1.5), at(half, 1.5), 1.0)
  end
  fence(scene, at(half, 1.5), at(half, lot_depth), 1.7)
  fence(scene, at(-half, lot_depth - 0.3), at(half, lot_depth - 0.3), 1.7)
  for _ = 1, scene:integer(2, 4) do
    local p = at(scene:uniform(-half + 2, half - 2), scene:uniform(y0 + d + 2.5, lot_depth - 2))
    if scene:uniform(0, 1) < 0.6 then nature.tree(scene, p, scene:uniform(5, 9))
    else nature.fir(scene, p, scene:uniform(6, 11)) end
  end
  nature.tree(scene, at(-half + 2.2, 4), scene:uniform(4.5, 7))
  for _ = 1, 4 do
    nature.bush(scene, at(scene:uniform(-half + 1, half - 1), scene:uniform(2.5, 4.5)),
                scene:uniform(0.5, 0.9))
  end
  shed(scene, at(-half + 1, lot_depth - 4), 0)
  plaything(scene, at(half - 4, lot_depth - 5))
end

return function(options)
  local scene = lapwing.scene { name = "suburb", seed = options.seed or 1 }
  local hills = nature.hills(scene, 2.2)
  colors.use(scene, "grass")
  nature.ground(scene, 220, 3, hills)
  local long = lots * lot_width
  local rows = {-1, 1}
  for _, row in ipairs(rows) do
    local middle = row * (lot_depth + lane / 2)
    colors.use(scene, "asphalt")
    local step = 3
    for x = -102, 99, step do
      scene:quad({x, middle - lane / 2, hills(x, middle - lane / 2) + 0.12},
                 {x + step, middle - lane / 2, hills(x + step, middle - lane / 2) + 0.12},
                 {x + step, middle + lane / 2, hills(x + step, middle + lane / 2) + 0.12},
                 {x, middle + lane / 2, hills(x, middle + lane / 2) + 0.12})
    end
    for i = 1, lots do
      local x = -long / 2 + (i - 0.5) * lot_width
      for _, side in ipairs {-1, 1} do
        local y = middle + side * lane / 2
        scene:push({x, y, 0}, side < 0 and math.pi or 0)
        lot(scene, function(u, v) return hills(x + side * u, y + side * v) end)
        scene:pop()
      end
    end
    -- A line of poles on the lane's edge, and wires to every second house.
    local poles = {}
    for i = 0, 6 do
      local x = -long / 2 - 12 + i * (long + 24) / 6
      local y = middle + row * (lane / 2 + 0.8)
      poles[#poles + 1] = {x, y, hills(x, y)}
    end
    furniture.power_line(scene, poles, 9)
    for i = 1, 5 do
      local x = -long / 2 + i * long / 6
      local y = middle - row * (lane / 2 + 0.6)
      furniture.lamp(scene, {x, y, hills(x, y)}, row > 0 and 0 or math.pi)
    end
  end
  scene:region({-long / 2, -2 * lot_depth - lane, -3}, {long / 2, 2 * lot_depth + lane, 14})
  return scene
end
