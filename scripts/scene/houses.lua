-- SPDX-License-Identifier: Apache-2.0
-- Whole buildings of four walls and a roof. A house stands in its frame from the origin to
-- {width, depth}, its front towards -y. Metres.
local colors = require "scene.colors"
local roofs = require "scene.roofs"
local walls = require "scene.walls"

local houses = {}

-- Four facades around a rectangle: front, right, back, left. `spec.front` and its kin lay their
-- entries over those that all sides share; `false` leaves a side out (a party wall).
function houses.shell(scene, width, depth, height, spec)
  local sides = {
    {"front", {0, 0, 0}, 0, width}, {"right", {width, 0, 0}, math.pi / 2, depth},
    {"back", {width, depth, 0}, math.pi, width}, {"left", {0, depth, 0}, -math.pi / 2, depth},
  }
  for _, side in ipairs(sides) do
    local own = spec[side[1]]
    if own ~= false then
      local facade = {}
      for key, value in pairs(spec) do facade[key] = value end
      for key, value in pairs(own or {}) do facade[key] = value end
      facade.width, facade.height = side[4], height
      scene:push(side[2], side[3])
      if facade.blind then
        colors.use(scene, facade.color)
        walls.panel(scene, 0, 0, facade.width, height)
      else
        walls.facade(scene, facade)
      end
      scene:pop()
    end
  end
end

-- A town house of a row: shops or a door below, windows above, a tiled roof with dormers.
--   storeys, color, roof = "gable" | "flat" | "mansard", arcade = depth of a covered walk in front
function houses.town(scene, width, depth, spec)
  local storey, ground = spec.storey or 3.1, spec.ground or 4.2
  local height = ground + (spec.storeys - 1) * storey + 0.5
  local color = spec.color or colors.pick(scene, colors.town)
  local arcade = spec.arcade
  local shell = {
    color = color, storey = storey, ground = ground, bands = true,
    recess = spec.recess or 0.4, left = spec.left or {blind = true},
    right = spec.right or {blind = true},
    front = {shops = spec.shops, door = spec.door or 1, balconies = spec.balconies},
    back = {door = 1, balconies = spec.back_balconies, ground = ground},
  }
  if arcade then
    -- The ground floor of the front stands back behind arches.
    houses.arcade(scene, width, arcade, ground, color)
    scene:push({0, arcade, 0})
    walls.facade(scene, {width = width, height = ground, color = color, storey = ground,
                         ground = ground, shops = true, door = 1})
    scene:pop()
    scene:push({0, 0, ground})
    walls.facade(scene, {width = width, height = height - ground, color = color, storey = storey,
                         bands = true, balconies = spec.balconies, recess = spec.recess or 0.4})
    scene:pop()
    shell.front, shell.left, shell.right = false, false, false
    houses.sides_over_arcade(scene, width, depth, height, arcade, ground, color)
  end
  houses.shell(scene, width, depth, height, shell)
  houses.cornice(scene, width, depth, height)
  houses.town_roof(scene, width, depth, height, spec, color)
  return height
end

-- The party walls of a house whose arcade can be walked through.
function houses.sides_over_arcade(scene, width, depth, height, arcade, ground, color)
  colors.use(scene, color)
  for _, x in ipairs {0, width} do
    local corners = {{x, arcade, 0}, {x, depth, 0}, {x, depth, height}, {x, 0, height},
                     {x, 0, ground}, {x, arcade, ground}}
    if x == 0 then
      local turned = {}
      for i = #corners, 1, -1 do turned[#turned + 1] = corners[i] end
      corners = turned
    end
    scene:face(corners)
  end
end

function houses.cornice(scene, width, depth, z)
  colors.use(scene, "stone")
  scene:box({0, -0.45, z - 0.35}, {width, 0, z})
  scene:box({0, depth, z - 0.35}, {width, depth + 0.45, z})
end

function houses.town_roof(scene, width, depth, z, spec, color)
  if spec.roof == "flat" then
    roofs.flat(scene, width, depth, z, {wall = color})
    return
  end
  local rise = spec.rise or depth * 0.38
  local tiles = colors.pick(scene, {"tiles", "tiles", "slate"})
  roofs.gable(scene, width, depth, z, rise, {color = tiles, wall = color, verge = 0.02})
  local count = math.max(1, math.floor(width / 4))
  for i = 1, count do
    local x = width * (i - 0.5) / count
    local y = depth * 0.12
    roofs.dormer(scene, x, y, z + rise * 0.24 + 0.5, depth * 0.28, color)
    scene:push({width, depth, 0}, math.pi)
    roofs.dormer(scene, x, y, z + rise * 0.24 + 0.5, depth * 0.28, color)
    scene:pop()
  end
  roofs.chimney(scene, width * 0.25, depth * 0.42, z + rise * 0.6, rise * 0.6)
end

-- Round arches on pillars before a covered walk of `deep` metres, its ceiling at `high`.
function houses.arcade(scene, width, deep, high, color)
  local bays = math.max(2, math.floor(width / 3.2))
  local bay = width / bays
  colors.use(scene, color)
  for i = 1, bays do
    scene:push({(i - 1) * bay, 0, 0})
    walls.archway(scene, bay, high, 0.55, 0.35, bay - 0.35, high - 0.5 - (bay - 0.7) / 2)
    scene:pop()
  end
  colors.use(scene, "plaster")
  scene:quad({0, 0.55, high}, {0, deep, high}, {width, deep, high}, {width, 0.55, high})
  for i = 0, bays do
    local x = math.min(math.max(i * bay, 0.15), width - 0.15)
    scene:box({x - 0.15, 0.55, high - 0.35}, {x + 0.15, deep, high})
  end
  colors.use(scene, "stone")
  scene:box({0, 0, 0}, {width, deep, 0.12})
end

-- A house of its own, with a gable or a hip, a porch, a chimney and perhaps a garage.
function houses.detached(scene, width, depth, spec)
  local storeys = spec.storeys or 2
  local height = 2.9 * storeys + 0.3
  local color = spec.color or colors.pick(scene, {"white", "cream", "brick", "sky", "ochre"})
  houses.shell(scene, width, depth, height, {
    color = color, storey = 2.9, front = {door = spec.door or 2}, back = {door = 1},
    window = {width = 1.4, height = 1.4, sill = 0.9},
  })
  local tiles = colors.pick(scene, {"tiles", "slate", "tar"})
  if spec.hip then
    roofs.hip(scene, width, depth, height, depth * 0.36, {color = tiles})
  else
    roofs.gable(scene, width, depth, height, depth * 0.42, {color = tiles, wall = color})
  end
  roofs.chimney(scene, width * 0.7, depth * 0.42, height + 0.6, depth * 0.42 + 0.4)
  -- A porch with a roof of its own on four posts.
  local px = width * 0.22
  colors.use(scene, "wood")
  scene:box({px, -2.2, 0}, {px + 3.4, 0, 0.18})
  colors.use(scene, "white")
  for _, x in ipairs {px + 0.1, px + 3.2} do
    scene:box({x, -2.1, 0.18}, {x + 0.14, -1.96, 2.5})
  end
  colors.use(scene, tiles)
  scene:push({px - 0.2, -2.4, 2.5})
  roofs.extrude(scene, {{0, 0}, {2.5, 0.8}, {2.5, 0.95}, {0, 0.15}}, 0, 3.8)
  scene:pop()
  return height
end

return houses
