-- SPDX-License-Identifier: Apache-2.0
-- A block of houses around three inner courts, reached through archways (after thesis 4.5.1,
-- "Courtyard": the inner facades are shielded by the opposite buildings).
local colors = require "scene.colors"
local furniture = require "scene.street_furniture"
local houses = require "scene.houses"
local nature = require "scene.nature"
local roofs = require "scene.roofs"
local walls = require "scene.walls"

local width, length, depth = 68, 60, 11    -- of the block and of its wings, m
local wing, court_width = 8, 10            -- across the two middle wings and the courts, m
local floor_height, ground = 3.2, 4.6

-- A gallery along the back of a wing, from which the flats on its court are entered: a slab on
-- posts with a railing.
local function gallery(scene, long, deep, z)
  local reach = 1.7
  colors.use(scene, "concrete")
  scene:box({0, deep, z - 0.1}, {long, deep + reach, z + 0.1})
  colors.use(scene, "metal")
  scene:box({0, deep + reach - 0.08, z + 1.05}, {long, deep + reach, z + 1.13})
  for i = 0, math.floor(long / 0.6) do
    local x = math.min(i * 0.6, long - 0.04)
    scene:box({x, deep + reach - 0.06, z + 0.1}, {x + 0.04, deep + reach - 0.02, z + 1.05})
  end
  colors.use(scene, "white")
  for i = 0, math.floor(long / 4) do
    local x = math.min(i * 4, long - 0.2)
    scene:box({x, deep + reach - 0.25, z + 0.1}, {x + 0.2, deep + reach - 0.05, z + floor_height})
  end
end

-- A wing along +x of the frame, its outer front towards -y, its court side back; a passage leads
-- through it where `gate` says (metres from its left end).
local function block_wing(scene, long, deep, spec)
  local height = ground + floor_height * spec.storeys + 0.4
  local color = spec.color
  local passage = 3.6
  local pieces = spec.gate and {{0, spec.gate - 3}, {spec.gate + 3, long}} or {{0, long}}
  for _, piece in ipairs(pieces) do
    local x0, x1 = piece[1], piece[2]
    scene:push({x0, 0, 0})
    houses.shell(scene, x1 - x0, deep, ground, {
      color = color, ground = ground, recess = 0.45, left = {blind = true}, right = {blind = true},
      front = {door = 2, window = {width = 1.5, height = 2.4, sill = 1}},
      back = spec.cloister and {blind = true} or {door = 2},
    })
    scene:pop()
  end
  if spec.gate then
    scene:push({spec.gate - 3, 0, 0})
    colors.use(scene, "sandstone")
    walls.archway(scene, 6, ground, deep, 3 - passage / 2, 3 + passage / 2, 2.2)
    scene:pop()
  end
  scene:push({0, 0, ground})
  houses.shell(scene, long, deep, height - ground, {
    color = color, storey = floor_height, bands = true, recess = 0.4,
    left = {blind = true}, right = {blind = true},
    front = {balconies = 0.15},
  })
  for floor = 0, spec.storeys - 1 do
    gallery(scene, long, deep, floor * floor_height)
    if spec.inside then
      scene:push({long, deep, 0}, math.pi)
      gallery(scene, long, deep, floor * floor_height)
      scene:pop()
    end
  end
  scene:pop()
  houses.cornice(scene, long, deep, height)
  roofs.gable(scene, long, deep, height, deep * 0.42, {wall = color, verge = 0.02,
                                                       color = spec.tiles})
  local dormers = math.floor(long / 5)
  for i = 1, dormers do
    for _, turned in ipairs {false, true} do
      scene:push(turned and {long, deep, 0} or {0, 0, 0}, turned and math.pi or 0)
      roofs.dormer(scene, long * (i - 0.5) / dormers, deep * 0.12, height + deep * 0.1 + 0.6,
                   deep * 0.28, color)
      scene:pop()
    end
  end
  for i = 1, 3 do
    roofs.chimney(scene, long * (i - 0.5) / 3 + 1.5, deep * 0.4, height + deep * 0.2, deep * 0.3)
  end
end

-- A covered walk along the inside of a wing, its pillars towards -y, with a terrace on top.
local function cloister(scene, long, deep)
  houses.arcade(scene, long, deep, 4.2, "sandstone")
  colors.use(scene, "stone")
  scene:box({0, 0, 4.2}, {long, deep, 4.5})
  colors.use(scene, "metal")
  for i = 0, math.floor(long / 0.5) do
    scene:box({i * 0.5, 0.1, 4.5}, {i * 0.5 + 0.05, 0.15, 5.5})
  end
  scene:box({0, 0.08, 5.45}, {long, 0.17, 5.55})
end

local function fountain(scene, at)
  scene:push(at)
  colors.use(scene, "stone")
  for i = 0, 15 do
    scene:push({0, 0, 0}, 2 * math.pi * i / 16)
    scene:box({-0.62, 2.7, 0}, {0.62, 3.1, 0.65})
    scene:pop()
  end
  scene:tube({0, 0, 0}, {0, 0, 2.2}, 0.4, 0.25, 12)
  scene:tube({0, 0, 2.2}, {0, 0, 2.45}, 0.5, 1.3, 20)
  scene:ball({0, 0, 2.9}, {0.35, 0.35, 0.45}, 2)
  colors.use(scene, "sky")
  scene:tube({0, 0, 0.4}, {0, 0, 0.45}, 2.7, 2.7, 24)
  scene:pop()
end

local function court(scene, x0, y0, x1, y1, planted)
  colors.use(scene, planted and "grass" or "cobbles")
  scene:quad({x0, y0, 0.02}, {x1, y0, 0.02}, {x1, y1, 0.02}, {x0, y1, 0.02})
  local cx, cy = (x0 + x1) / 2, (y0 + y1) / 2
  for i = -1, 1, 2 do
    nature.tree(scene, {cx, cy + i * 0.2 * (y1 - y0), 0}, scene:uniform(8, 11))
    furniture.lamp(scene, {x0 + 1, cy + i * 4, 0}, -math.pi / 2)
    nature.bush(scene, {x1 - 1.2, cy + i * 9, 0}, 0.8)
  end
  if planted then
    nature.hedge(scene, {cx - 3.6, cy - 3.6}, {cx - 3.6, cy + 3.6}, 1.1)
    nature.hedge(scene, {cx + 4, cy - 3.6}, {cx + 4, cy + 3.6}, 1.1)
    fountain(scene, {cx, cy, 0})
  else
    for k = -2, 2 do
      furniture.table(scene, {cx - 1.6, cy + 2.6 * k, 0})
      furniture.table(scene, {cx + 1.6, cy + 2.6 * k + 1, 0})
    end
    furniture.awning(scene, {cx - 3.5, cy - 3.5, 0}, 0, 7, 4)
    furniture.bench(scene, {cx + 2, cy + 9, 0}, math.pi)
  end
end

return function(options)
  local scene = lapwing.scene { name = "courtyard", seed = options.seed or 1 }
  colors.use(scene, "pavement")
  nature.ground(scene, 240, 12, function() return -0.02 end)
  local function spec(more)
    local s = {storeys = 5, color = colors.pick(scene, colors.town),
               tiles = colors.pick(scene, {"tiles", "tiles", "slate"})}
    for key, value in pairs(more) do s[key] = value end
    return s
  end
  local x, y = -width / 2, -length / 2
  local inner = length - 2 * depth
  -- South, north, west, east; the west and east wings stand between the other two.
  scene:push({x, y, 0})
  block_wing(scene, width, depth, spec {gate = width * 0.28, cloister = true})
  scene:pop()
  scene:push({-x, -y, 0}, math.pi)
  block_wing(scene, width, depth, spec {gate = width * 0.25})
  scene:pop()
  scene:push({x, y + depth + inner, 0}, -math.pi / 2)
  block_wing(scene, inner, depth, spec {})
  scene:pop()
  scene:push({-x, y + depth, 0}, math.pi / 2)
  block_wing(scene, inner, depth, spec {})
  scene:pop()
  -- Two middle wings divide the inside into three courts, with passages between them.
  for i = 1, 2 do
    local left = x + depth + i * court_width + (i - 1) * wing
    scene:push({left + wing, y + depth, 0}, math.pi / 2)
    block_wing(scene, inner, wing, spec {storeys = 5, gate = inner / 2, inside = true})
    scene:pop()
  end
  for i = 0, 2 do
    local left = x + depth + i * (court_width + wing)
    local right = left + court_width
    scene:push({right, y + depth + 3, 0}, math.pi)
    cloister(scene, court_width, 3)
    scene:pop()
    scene:push({left, -y - depth - 3, 0})
    cloister(scene, court_width, 3)
    scene:pop()
    court(scene, left, y + depth, right, -y - depth, i == 1)
  end
  for i = 0, 8 do
    local place = x + width * (i + 0.5) / 9
    furniture.lamp(scene, {place, y - 3.5, 0}, 0)
    nature.tree(scene, {place + 3, -y + 4.5, 0}, scene:uniform(8, 11))
    if scene:uniform(0, 1) < 0.7 then furniture.car(scene, {place, y - 6, 0}, 0) end
  end
  scene:region({x - 1.5, y - 1.5, -0.5}, {-x + 1.5, -y + 1.5, 28})
  return scene
end
