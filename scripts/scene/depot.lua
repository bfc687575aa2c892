-- SPDX-License-Identifier: Apache-2.0
-- Depots: storeys of parked cars with ramps, halls of tall racks, stairs, and bays between walls
-- of a sheet's thickness, some of them doubled, some without a roof. Every seed is another one.
-- For training indoors.
local colors = require "scene.colors"
local furniture = require "scene.street_furniture"
local market = require "scene.market"

-- A wall of sheets from a to b, upright from z0 to z1, without thickness; `gap` m between its two
-- sheets, one sheet where it is 0.
local function sheet(scene, a, b, z0, z1, gap)
  local length = math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2)
  local n = {-(b[2] - a[2]) / length, (b[1] - a[1]) / length}
  for _, side in ipairs(gap > 0 and {-gap / 2, gap / 2} or {0}) do
    local x, y = n[1] * side, n[2] * side
    scene:quad({a[1] + x, a[2] + y, z0}, {b[1] + x, b[2] + y, z0},
               {b[1] + x, b[2] + y, z1}, {a[1] + x, a[2] + y, z1})
  end
end

-- Along a wall of `length` from `a` in a direction: sheets with doorways between them.
local function partition(scene, a, along, length, z0, z1, gap)
  local from, door = 0, scene:uniform(1, 3)
  while from < length do
    local to = math.min(length, from + scene:uniform(3, 9))
    colors.use(scene, colors.pick(scene, colors.town))
    sheet(scene, {a[1] + along[1] * from, a[2] + along[2] * from},
          {a[1] + along[1] * to, a[2] + along[2] * to}, z0, z1, gap)
    from = to + door
    if from < length and scene:uniform(0, 1) < 0.6 then  -- what is above the doorway
      sheet(scene, {a[1] + along[1] * to, a[2] + along[2] * to},
            {a[1] + along[1] * from, a[2] + along[2] * from}, z0 + 0.75 * (z1 - z0), z1, gap)
    end
  end
end

local function stairs(scene, at, yaw, rise)
  local steps = math.max(4, math.floor(rise / 0.18))
  scene:push(at, yaw)
  colors.use(scene, "concrete")
  for i = 0, steps - 1 do
    local z = rise * i / steps
    scene:box({0.28 * i, 0, z}, {0.28 * (i + 1), 1.6, z + rise / steps})
  end
  scene:pop()
end

local function racks(scene, w, d, z, high)
  local y = 2
  while y < d - 2.5 do
    local x = 2
    while x < w - 4 do
      local long = scene:uniform(2.5, 6)
      if scene:uniform(0, 1) < 0.8 then
        scene:push({x, y, z})
        market.rack(scene, math.min(long, w - 2 - x), 0.9, high * scene:uniform(0.5, 0.95))
        scene:pop()
      end
      x = x + long + (scene:uniform(0, 1) < 0.3 and 2 or 0.1)
    end
    y = y + scene:uniform(2.8, 4)
  end
end

local function parked(scene, w, d, z)
  for k = 0, math.floor((d - 6) / 8) do
    for i = 0, math.floor((w - 4) / 2.8) do
      if scene:uniform(0, 1) < 0.35 then
        furniture.car(scene, {2 + 2.8 * i, 4 + 8 * k, z}, math.pi / 2)
      end
    end
  end
end

-- Pipes with hangers and sprinklers under a ceiling at z.
local function pipes(scene, w, d, z)
  for k = 1, math.floor(d / 3.5) do
    local y, r = 3.5 * k - 1.2, scene:uniform(0.04, 0.15)
    colors.use(scene, colors.pick(scene, {"red", "metal", "white"}))
    local from, to = scene:uniform(0.2, 3), w - scene:uniform(0.2, 3)
    scene:tube({from, y, z - 0.35}, {to, y, z - 0.35}, r, r, 10)
    for i = 0, math.floor((to - from) / 1.5) do
      local x = from + 1.5 * i
      scene:tube({x, y, z - 0.35}, {x, y, z}, 0.012, 0.012, 5)
      scene:tube({x, y, z - 0.5}, {x, y, z - 0.35}, 0.03, 0.01, 6)
    end
  end
end

-- A pallet of slats with boxes on it, and now and then a barrel beside it.
local function pallet(scene, at, yaw)
  scene:push(at, yaw)
  colors.use(scene, "wood")
  for i = 0, 6 do scene:box({0.18 * i, 0, 0.1}, {0.18 * i + 0.1, 0.8, 0.13}) end
  for _, y in ipairs {0, 0.36, 0.72} do scene:box({0, y, 0}, {1.18, y + 0.08, 0.1}) end
  for layer = 0, scene:integer(0, 3) do
    for i = 0, 2 do
      for k = 0, 1 do
        if layer < 2 or scene:uniform(0, 1) < 0.6 then
          colors.use(scene, colors.pick(scene, {"ochre", "paper", "dark_wood", "wood"}))
          scene:box({0.4 * i, 0.4 * k, 0.13 + 0.35 * layer},
                    {0.4 * i + 0.37, 0.4 * k + 0.37, 0.46 + 0.35 * layer})
        end
      end
    end
  end
  if scene:uniform(0, 1) < 0.4 then
    colors.use(scene, colors.pick(scene, {"blue", "red", "metal"}))
    scene:tube({1.6, 0.4, 0}, {1.6, 0.4, 0.9}, 0.29, 0.29, 16)
  end
  scene:pop()
end

-- Upright bars with a rail from a to b.
local function railing(scene, a, b, z)
  local length = math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2)
  local u = {(b[1] - a[1]) / length, (b[2] - a[2]) / length}
  colors.use(scene, "metal")
  for i = 0, math.floor(length / 0.16) do
    local x, y = a[1] + u[1] * 0.16 * i, a[2] + u[2] * 0.16 * i
    scene:tube({x, y, z}, {x, y, z + 1}, 0.01, 0.01, 4)
  end
  scene:tube({a[1], a[2], z + 1}, {b[1], b[2], z + 1}, 0.025, 0.025, 8)
end

local function bays(scene, w, d, z, high)
  local gap = scene:uniform(0, 1) < 0.5 and 0 or scene:uniform(0.02, 0.3)
  local x = scene:uniform(5, 9)
  while x < w - 4 do
    partition(scene, {x, 0}, {0, 1}, d, z, z + high, gap)
    x = x + scene:uniform(4.5, 10)
  end
  if d > 14 then partition(scene, {0, d / 2}, {1, 0}, w, z, z + high, gap) end
  for _ = 1, scene:integer(5, 25) do
    scene:push({scene:uniform(1, w - 1), scene:uniform(1, d - 1), z}, scene:uniform(0, 3))
    if scene:uniform(0, 1) < 0.5 then market.crates(scene) else market.counter(scene) end
    scene:pop()
  end
end

return function(options)
  local scene = lapwing.scene { name = "depot", seed = options.seed or 1 }
  local w, d = scene:uniform(26, 46), scene:uniform(16, 30)
  local kind = colors.pick(scene, {"garage", "racks", "bays", "mixed"})
  local storeys = kind == "garage" and scene:integer(1, 3) or scene:integer(1, 2)
  local high = kind == "racks" and scene:uniform(4, 8) or scene:uniform(2.6, 4)
  local parapet = kind == "garage" and scene:uniform(0, 1) < 0.6  -- in place of outer walls
  local roof = scene:uniform(0, 1) < 0.7
  local thin = scene:uniform(0, 1) < 0.5
  local slab = thin and 0.02 or 0.25
  local sides = {{{0, 0}, {w, 0}}, {{w, 0}, {w, d}}, {{w, d}, {0, d}}, {{0, d}, {0, 0}}}
  local well = {w - scene:uniform(7, 10), scene:uniform(4, 6)}  -- the ramp or stairs

  for storey = 0, storeys do
    local z = storey * high
    colors.use(scene, "concrete")
    if storey == 0 or storey < storeys or roof then
      if storey == 0 or storey == storeys then
        scene:box({0, 0, z - slab}, {w, d, z})
      else  -- a hole above the ramp
        scene:box({0, 0, z - slab}, {well[1], d, z})
        scene:box({well[1], well[2], z - slab}, {w, d, z})
      end
    end
    if storey < storeys then
      local content = kind == "mixed" and colors.pick(scene, {"garage", "racks", "bays"}) or kind
      if content == "garage" then parked(scene, w, d, z)
      elseif content == "racks" then racks(scene, w, d, z, high)
      else bays(scene, w, d, z, high) end
      if storey + 1 < storeys then
        if content == "garage" then
          colors.use(scene, "asphalt")
          scene:quad({well[1] - 8, 0.3, z}, {w, 0.3, z + high}, {w, well[2], z + high},
                     {well[1] - 8, well[2], z})
        else stairs(scene, {w - 0.28 * math.floor(high / 0.18) - 1, 0.5, z}, 0, high) end
      end
      local top = parapet and z + 1.1 or z + high
      for _, s in ipairs(sides) do
        colors.use(scene, "concrete")
        sheet(scene, s[1], s[2], z, top, thin and 0 or 0.2)
      end
      if parapet then
        for _, s in ipairs(sides) do railing(scene, s[1], s[2], z + 1.1) end
      end
      if roof or storey + 1 < storeys then pipes(scene, w, d, z + high - slab) end
      for _ = 1, scene:integer(20, 60) do
        pallet(scene, {scene:uniform(1, w - 3), scene:uniform(1, d - 2), z}, scene:uniform(0, 6))
      end
      if storey > 0 then railing(scene, {well[1], 0.2}, {well[1], well[2]}, z) end
      for i = 0, math.floor(w / 6.5) do
        for k = 0, math.floor(d / 6.5) do
          if kind ~= "bays" then
            scene:box({6.5 * i, 6.5 * k, z}, {6.5 * i + 0.4, 6.5 * k + 0.4, z + high})
          end
        end
      end
    end
  end
  scene:region({0, 0, 0}, {w, d, storeys * high})
  scene:moves { step = 0.8, body = 0.6, clear = 2, speed = 0.8 }
  return scene
end
