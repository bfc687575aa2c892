-- SPDX-License-Identifier: Apache-2.0
-- A district of nine blocks, as `downtown`, `district` and `town` have them: towers of glass and
-- stone around a square, with setbacks, bridges between them, roof machines and a street grid.
local colors = require "scene.colors"
local furniture = require "scene.street_furniture"
local houses = require "scene.houses"
local nature = require "scene.nature"
local roofs = require "scene.roofs"
local walls = require "scene.walls"

-- A side of a glass tower: floors of glass between bands, with fins that stand out.
local function curtain(scene, width, height, spec)
  local storey = 3.8
  local floors = math.max(1, math.floor(height / storey))
  colors.use(scene, spec.glass or "glass")
  scene:quad({0, 0, 0}, {width, 0, 0}, {width, 0, height}, {0, 0, height})
  colors.use(scene, spec.band)
  for i = 1, floors do
    local z = height * i / floors
    scene:box({0, -0.25, z - 0.9}, {width, 0, z})
  end
  colors.use(scene, spec.fin)
  local fins = math.max(2, math.floor(width / spec.every))
  for i = 0, fins do
    local x = width * i / fins
    scene:box({x - 0.12, -spec.deep, 0}, {x + 0.12, 0, height})
  end
end

local function four_sides(scene, w, d, make)
  for _, side in ipairs {{0, 0, 0, w}, {w, 0, math.pi / 2, d}, {w, d, math.pi, w},
                         {0, d, -math.pi / 2, d}} do
    scene:push({side[1], side[2], 0}, side[3])
    make(side[4])
    scene:pop()
  end
end

-- A tower in stages, each smaller than the one below; open halls of columns at its foot.
local function glass_tower(scene, size, height)
  local spec = {
    band = colors.pick(scene, {"concrete", "dark", "white", "metal"}),
    fin = colors.pick(scene, {"metal", "white", "dark", "concrete"}),
    every = scene:uniform(1.6, 3.2), deep = scene:uniform(0.35, 0.8),
  }
  local hall = 7
  colors.use(scene, "stone")
  local columns = 6
  for i = 0, columns do
    for k = 0, columns do
      if i == 0 or k == 0 or i == columns or k == columns then
        local x, y = 0.6 + (size - 1.2) * i / columns, 0.6 + (size - 1.2) * k / columns
        scene:box({x - 0.5, y - 0.5, 0}, {x + 0.5, y + 0.5, hall})
      end
    end
  end
  scene:push({4, 4, 0})
  four_sides(scene, size - 8, size - 8, function(w)
    curtain(scene, w, hall, {band = "dark", fin = "dark", every = 3, deep = 0.2})
  end)
  scene:pop()
  colors.use(scene, "concrete")
  scene:box({0, 0, hall}, {size, size, hall + 0.8})
  local z, inset, stages = hall + 0.8, 0, scene:integer(1, 3)
  for i = 1, stages do
    local rise = height - z
    if i < stages then rise = rise * scene:uniform(0.3, 0.5) end
    local w = size - 2 * inset
    scene:push({inset, inset, z})
    four_sides(scene, w, w, function(side) curtain(scene, side, rise, spec) end)
    scene:push({0, 0, rise})
    roofs.flat(scene, w, w, 0, {wall = spec.band, machines = i == stages and 6 or 2})
    scene:pop()
    scene:pop()
    z, inset = z + rise, math.min(inset + scene:uniform(2, 4), (size - 0.8) / 2)
  end
  colors.use(scene, "metal")
  scene:tube({size / 2, size / 2, z}, {size / 2, size / 2, z + 14}, 0.35, 0.08, 8)
end

-- An older house of stone with windows and a flat roof with a water tank.
local function stone_block(scene, w, d, height)
  houses.shell(scene, w, d, height, {
    color = colors.pick(scene, {"brick", "sandstone", "stone", "rose"}), storey = 4, ground = 5.5,
    window = {width = 1.7, height = 2.2, sill = 1}, recess = 0.5, bands = true, columns = 7,
    front = {shops = true, door = 4}, right = {shops = true}, back = {door = 4},
  })
  houses.cornice(scene, w, d, height)
  roofs.flat(scene, w, d, height, {wall = "stone", machines = 4})
  scene:push({w * 0.3, d * 0.6, height})
  colors.use(scene, "wood")
  for i = 0, 3 do
    local a = math.pi / 2 * i
    scene:tube({1.2 * math.cos(a), 1.2 * math.sin(a), 0}, {math.cos(a), math.sin(a), 2.5}, 0.1)
  end
  scene:tube({0, 0, 2.5}, {0, 0, 5.2}, 1.7, 1.7, 16)
  scene:tube({0, 0, 5.2}, {0, 0, 6.4}, 1.8, 0, 16)
  scene:pop()
end

local function bridge(scene, from, to, z)
  scene:push({from[1], from[2], z}, math.atan(to[2] - from[2], to[1] - from[1]))
  local l = math.sqrt((to[1] - from[1]) ^ 2 + (to[2] - from[2]) ^ 2)
  colors.use(scene, "concrete")
  scene:box({0, -1.8, 0}, {l, 1.8, 0.4})
  scene:box({0, -1.8, 3.2}, {l, 1.8, 3.5})
  colors.use(scene, "glass")
  for _, y in ipairs {-1.7, 1.6} do scene:box({0, y, 0.4}, {l, y + 0.1, 3.2}) end
  scene:pop()
end

local function square(scene, block)
  colors.use(scene, "cobbles")
  scene:box({0, 0, 0}, {block, block, 0.15})
  local apart = block / 4
  for i = 0, 3 do
    for k = 0, 3 do
      if (i + k) % 2 == 0 or i == 0 or k == 3 then
        nature.tree(scene, {(i + 0.5) * apart, (k + 0.5) * apart, 0.15}, scene:uniform(8, 12))
      end
    end
  end
  for i = 0, 4 do furniture.bench(scene, {6 + 7 * i, 19, 0.15}) end
  furniture.awning(scene, {22, 24, 0.15}, 0, 8, 6)
  for i = 0, 2 do furniture.table(scene, {23.5 + 2.6 * i, 27, 0.15}) end
end

local M = {}

-- Round the origin of the frame. `block` and `street`: their widths, m; `low`: times that buildings
-- are high.
function M.district(scene, block, street, low)
  local pitch = block + street
  for row = -1, 1 do
    for column = -1, 1 do
      scene:push({column * pitch - block / 2, row * pitch - block / 2, 0})
      colors.use(scene, "pavement")
      scene:box({-2.5, -2.5, -0.2}, {block + 2.5, block + 2.5, 0.14})
      if row == 0 and column == 0 then
        square(scene, block)
      elseif (row + column) % 2 == 0 then
        scene:push({4, 4, 0.14})
        glass_tower(scene, block - 8, low * scene:uniform(70, 110))
        scene:pop()
      else
        scene:push({0, 0, 0.14})
        stone_block(scene, block, block * 0.42,
                    5.5 + 4 * math.max(1, math.floor(low * scene:integer(4, 8))) + 0.6)
        scene:pop()
        scene:push({block * 0.3, block * 0.55, 0.14})
        glass_tower(scene, block * 0.42, math.max(12, low * scene:uniform(35, 60)))
        scene:pop()
      end
      for i = 0, 3 do
        furniture.lamp(scene, {i * 12 + 2, -2, 0.14}, math.pi)
        furniture.car(scene, {i * 11 + scene:uniform(0, 4), -5, 0}, 0)
        furniture.car(scene, {-5, i * 11 + scene:uniform(0, 4), 0}, math.pi / 2)
      end
      scene:pop()
    end
  end
  bridge(scene, {-pitch + block / 2 - 4.5, pitch}, {-block / 2 + 0.5, pitch}, 12)
  bridge(scene, {pitch, -pitch + block / 2 - 4.5}, {pitch, -block / 2 + 0.5}, 16)
end

return M
