-- SPDX-License-Identifier: Apache-2.0
-- A street of town houses, about 100 m long, closed at both ends, with arcades, balconies, trees
-- and cars, and yards behind the houses (after thesis 4.5.1, "Street": many surfaces can be seen
-- from between the buildings only).
local colors = require "scene.colors"
local furniture = require "scene.street_furniture"
local houses = require "scene.houses"
local nature = require "scene.nature"
local roofs = require "scene.roofs"
local walls = require "scene.walls"

local half_length, half_width = 46, 5.2    -- of the street, m
local depth, yard = 11, 5                  -- of the houses and of the yards behind them, m

-- A row of houses along +x of the frame, their fronts towards -y: the length that they take.
local function row(scene, length)
  local x = 0
  while x < length - 0.1 do
    local width = scene:uniform(9, 14)
    if length - x - width < 8 then width = length - x end
    scene:push({x, 0, 0})
    houses.town(scene, width, depth, {
      storeys = scene:integer(5, 6), shops = true, door = 1,
      roof = scene:uniform(0, 1) < 0.2 and "flat" or "gable", rise = 3.6,
      arcade = 3.4, balconies = 0.45, back_balconies = 0.8,
    })
    scene:pop()
    x = x + width
  end
end

-- Behind a row: a yard with sheds, closed by a back house as long as the row.
local function backyard(scene, length)
  local y = depth + yard
  local x = 0
  while x < length - 0.1 do
    local width = math.min(scene:uniform(12, 18), length - x)
    if length - x - width < 8 then width = length - x end
    scene:push({x, y, 0})
    local height = 3.1 * scene:integer(5, 6) + 0.6
    houses.shell(scene, width, 8, height, {
      color = colors.pick(scene, colors.town), left = {blind = true}, right = {blind = true},
      front = {door = 1, balconies = 0.8}, back = {door = 1},
    })
    roofs.gable(scene, width, 8, height, 2.4, {verge = 0.02})
    scene:pop()
    -- Sheds and walls that divide the yard.
    colors.use(scene, "brick")
    scene:box({x + width - 0.3, depth, 0}, {x + width, y, 2.2})
    scene:box({x + 1, depth + yard - 2.4, 0}, {x + 4.2, y, 2.3})
    colors.use(scene, "tar")
    scene:box({x + 0.8, depth + yard - 2.8, 2.3}, {x + 4.5, y, 2.45})
    nature.bush(scene, {x + width * 0.6, depth + 2.2, 0}, 0.9)
    x = x + width
  end
end

-- A house across an end of the street, with an arch to pass through.
local function gatehouse(scene, width)
  local height, passage = 17.5, 4
  colors.use(scene, "sandstone")
  walls.archway(scene, width, 5.5, depth, width / 2 - passage / 2, width / 2 + passage / 2, 2.6)
  scene:push({0, 0, 5.5})
  houses.shell(scene, width, depth, height - 5.5, {
    color = "sandstone", left = {blind = true}, right = {blind = true}, bands = true,
    front = {balconies = 0.4},
  })
  scene:pop()
  houses.cornice(scene, width, depth, height)
  roofs.gable(scene, width, depth, height, 4, {wall = "sandstone", verge = 0.02})
end

local function pavement(scene)
  colors.use(scene, "earth")
  nature.ground(scene, 240, 12, function() return -0.02 end)
  colors.use(scene, "asphalt")
  scene:quad({-110, -3.2, 0}, {110, -3.2, 0}, {110, 3.2, 0}, {-110, 3.2, 0})
  colors.use(scene, "pavement")
  for _, side in ipairs {-1, 1} do
    local a, b = side * 3.2, side * half_width
    scene:box({-half_length, math.min(a, b), -0.1}, {half_length, math.max(a, b), 0.14})
  end
end

local function fill_street(scene)
  for x = -half_length + 4, half_length - 4, 11 do
    for _, side in ipairs {-1, 1} do
      furniture.lamp(scene, {x, side * 3.7, 0.14}, side > 0 and math.pi or 0)
      nature.tree(scene, {x + 5.5, side * 4.4, 0.14}, scene:uniform(8, 11))
      if scene:uniform(0, 1) < 0.8 then
        furniture.car(scene, {x + 2.2, side * 2.2, 0}, side > 0 and math.pi or 0)
      end
      if scene:uniform(0, 1) < 0.5 then
        furniture.bench(scene, {x + 3, side * 4.6, 0.14}, side > 0 and 0 or math.pi)
      end
    end
  end
end

return function(options)
  local scene = lapwing.scene { name = "street", seed = options.seed or 1 }
  pavement(scene)
  for _, side in ipairs {0, math.pi} do
    scene:push({0, 0, 0}, side)
    scene:push({-half_length, half_width, 0})
    row(scene, 2 * half_length)
    backyard(scene, 2 * half_length)
    scene:pop()
    -- The end on the right, seen from this side.
    scene:push({half_length, half_width + depth, 0}, -math.pi / 2)
    gatehouse(scene, 2 * (half_width + depth))
    scene:pop()
    scene:pop()
  end
  fill_street(scene)
  scene:region({-half_length - depth, -half_width - depth - yard, -0.5},
               {half_length + depth, half_width + depth + yard, 26})
  return scene
end
