-- SPDX-License-Identifier: Apache-2.0
-- Colours of materials, 0 to 255.
local colors = {
  asphalt = {92, 92, 96},    pavement = {168, 164, 156}, cobbles = {140, 132, 122},
  grass = {112, 138, 72},    gravel = {176, 166, 146},   earth = {134, 112, 84},
  tiles = {164, 82, 58},     slate = {84, 90, 100},      tar = {104, 102, 100},
  brick = {158, 92, 72},     sandstone = {206, 186, 148}, stone = {178, 172, 162},
  plaster = {222, 214, 196}, white = {236, 234, 228},    concrete = {172, 172, 168},
  glass = {92, 118, 138},    frame = {232, 230, 224},    wood = {122, 88, 58},
  dark_wood = {88, 62, 44},  metal = {118, 122, 126},    dark = {62, 64, 68},
  bark = {98, 78, 60},       leaf = {84, 122, 58},       dark_leaf = {58, 96, 52},
  hedge = {72, 108, 50},     rubber = {42, 42, 44},      carpet = {124, 132, 148},
  screen = {30, 34, 40},     paper = {228, 222, 204},    blue = {66, 96, 150},
  red = {168, 58, 48},       ochre = {212, 176, 106},    rose = {212, 160, 140},
  mint = {172, 196, 172},    sky = {168, 190, 206},      cream = {234, 220, 184},
}

-- Walls of town houses, to choose from.
colors.town = {"plaster", "ochre", "rose", "mint", "sky", "cream", "sandstone", "brick"}

-- Sets the colour of what follows.
function colors.use(scene, name)
  local c = colors[name]
  if not c then lapwing.fail("there is no colour '" .. tostring(name) .. "'") end
  scene:color(c[1], c[2], c[3])
end

-- One of the names, by the scene's random numbers.
function colors.pick(scene, names)
  return names[scene:integer(1, #names)]
end

return colors
