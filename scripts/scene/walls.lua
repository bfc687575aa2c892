-- SPDX-License-Identifier: Apache-2.0
-- Walls with what is in them. A wall stands in the frame's plane y = 0, x to the right and z up as
-- seen from outside, which is towards -y. Metres.
local colors = require "scene.colors"

local walls = {}

-- A rectangle of the wall.
function walls.panel(scene, x0, z0, x1, z1)
  if x1 - x0 > 1e-6 and z1 - z0 > 1e-6 then
    scene:quad({x0, 0, z0}, {x1, 0, z0}, {x1, 0, z1}, {x0, 0, z1})
  end
end

-- The four sides of a hole of `depth`, and its end unless `open`.
function walls.recess(scene, x0, z0, x1, z1, depth, open)
  scene:quad({x0, 0, z0}, {x0, depth, z0}, {x1, depth, z0}, {x1, 0, z0})
  scene:quad({x0, 0, z1}, {x1, 0, z1}, {x1, depth, z1}, {x0, depth, z1})
  scene:quad({x0, 0, z0}, {x0, 0, z1}, {x0, depth, z1}, {x0, depth, z0})
  scene:quad({x1, 0, z0}, {x1, depth, z0}, {x1, depth, z1}, {x1, 0, z1})
  if not open then
    scene:quad({x0, depth, z0}, {x1, depth, z0}, {x1, depth, z1}, {x0, depth, z1})
  end
end

-- A window in a hole of the wall: reveal, glass, frame with a cross, sill.
function walls.window(scene, x0, z0, x1, z1, style)
  local depth = style.recess or 0.35
  colors.use(scene, style.reveal or style.color)
  walls.recess(scene, x0, z0, x1, z1, depth, true)
  colors.use(scene, "glass")
  scene:quad({x0, depth, z0}, {x1, depth, z0}, {x1, depth, z1}, {x0, depth, z1})
  colors.use(scene, style.frame or "frame")
  local bar, front, back = 0.07, depth - 0.08, depth + 0.03
  local middle = (x0 + x1) / 2
  scene:box({middle - bar / 2, front, z0}, {middle + bar / 2, back, z1})
  if z1 - z0 > 1.2 then
    local cross = z0 + 0.68 * (z1 - z0)
    scene:box({x0, front, cross - bar / 2}, {x1, back, cross + bar / 2})
  end
  if style.sill ~= false then
    colors.use(scene, style.trim or "stone")
    scene:box({x0 - 0.12, -0.16, z0 - 0.12}, {x1 + 0.12, 0.05, z0})
  end
end

-- A door, deep in the wall, with two steps before it.
function walls.door(scene, x0, x1, height, style)
  colors.use(scene, style.reveal or style.color)
  walls.recess(scene, x0, 0, x1, height, 0.5, true)
  colors.use(scene, style.door_color or "dark_wood")
  scene:quad({x0, 0.5, 0}, {x1, 0.5, 0}, {x1, 0.5, height}, {x0, 0.5, height})
  colors.use(scene, "stone")
  scene:box({x0 - 0.3, -0.7, 0}, {x1 + 0.3, 0, 0.15})
end

-- A slab with a railing, as wide as x0 to x1, its floor at z.
function walls.balcony(scene, x0, x1, z, reach)
  reach = reach or 1.3
  colors.use(scene, "concrete")
  scene:box({x0, -reach, z - 0.2}, {x1, 0, z})
  colors.use(scene, "metal")
  local top = z + 1.05
  scene:box({x0, -reach, top - 0.06}, {x1, -reach + 0.06, top})
  for _, x in ipairs {x0, x1 - 0.06} do
    scene:box({x, -reach, top - 0.06}, {x + 0.06, 0, top})
  end
  local posts = math.max(2, math.floor((x1 - x0) / 0.45))
  for i = 0, posts do
    local x = x0 + (x1 - x0 - 0.04) * i / posts
    scene:box({x, -reach, z}, {x + 0.04, -reach + 0.04, top})
  end
end

-- A wall full of windows.
--   width, height    of the wall
--   storey           height of one (3.2); `ground`: that of the lowest (storey)
--   columns          windows side by side (one every 2.6 m)
--   window           {width = 1.2, height = 1.7, sill = 0.9}
--   door             the column that holds a door instead; `shops`: wide windows below
--   balconies        share of windows, from the first storey up, that have a balcony
--   color, trim, recess, frame
function walls.facade(scene, spec)
  local storey = spec.storey or 3.2
  local ground = spec.ground or storey
  local columns = spec.columns or math.max(1, math.floor(spec.width / 2.6))
  local window = spec.window or {}
  local pitch = spec.width / columns
  local floors = math.max(1, math.floor((spec.height - ground) / storey + 1e-6) + 1)
  local function fill(x0, z0, x1, z1)
    colors.use(scene, spec.color)
    walls.panel(scene, x0, z0, x1, z1)
  end
  local z = 0
  for floor = 1, floors do
    local tall = floor == 1 and ground or storey
    local wide, high = window.width or 1.2, window.height or 1.7
    local sill = window.sill or 0.9
    if floor == 1 and spec.shops then wide, high, sill = pitch * 0.8, ground - 1.0, 0.4 end
    high = math.min(high, tall - sill - 0.3)
    local from = 0
    for column = 1, columns do
      local middle = (column - 0.5) * pitch
      local x0, x1 = middle - wide / 2, middle + wide / 2
      local z0, z1 = z + sill, z + sill + high
      local door = floor == 1 and column == spec.door
      if door then x0, x1, z0, z1 = middle - 0.65, middle + 0.65, 0, math.min(2.4, tall - 0.4) end
      fill(from, z, x0, z + tall)
      fill(x0, z, x1, z0)
      fill(x0, z1, x1, z + tall)
      if door then walls.door(scene, x0, x1, z1, spec)
      else walls.window(scene, x0, z0, x1, z1, spec) end
      if floor > 1 and spec.balconies and scene:uniform(0, 1) < spec.balconies then
        walls.balcony(scene, middle - pitch * 0.45, middle + pitch * 0.45, z + 0.2)
      end
      from = x1
    end
    fill(from, z, spec.width, z + tall)
    z = z + tall
    if spec.bands and floor < floors then
      colors.use(scene, spec.trim or "stone")
      scene:box({0, -0.1, z - 0.15}, {spec.width, 0, z + 0.1})
    end
  end
  fill(0, z, spec.width, spec.height)
end

-- The outline of an arch that stands on z = 0 between x0 and x1, from the right foot over the top
-- to the left foot: straight up to `spring`, then round (or pointed).
function walls.arch_outline(x0, x1, spring, pointed)
  local middle, radius, line = (x0 + x1) / 2, (x1 - x0) / 2, {{x1, 0}}
  local steps = 12
  for i = 0, steps do
    local x, z
    if pointed then
      -- Two arcs of twice the radius, each about the other's foot.
      local right = i <= steps / 2
      local a = math.pi / 3 * (right and i / (steps / 2) or 2 - i / (steps / 2))
      x = right and x0 + 2 * radius * math.cos(a) or x1 - 2 * radius * math.cos(a)
      z = spring + 2 * radius * math.sin(a)
    else
      local a = math.pi * i / steps
      x, z = middle + radius * math.cos(a), spring + radius * math.sin(a)
    end
    line[#line + 1] = {x, z}
  end
  line[#line + 1] = {x0, 0}
  return line
end

-- A wall `width` by `height`, thick, with an open archway in it that stands on the ground.
function walls.archway(scene, width, height, thickness, x0, x1, spring, pointed)
  local outline = walls.arch_outline(x0, x1, spring, pointed)
  local function side(y, outwards)
    local corners = {{0, y, 0}}
    for i = #outline, 1, -1 do corners[#corners + 1] = {outline[i][1], y, outline[i][2]} end
    corners[#corners + 1] = {width, y, 0}
    corners[#corners + 1] = {width, y, height}
    corners[#corners + 1] = {0, y, height}
    if not outwards then
      local back = {}
      for i = #corners, 1, -1 do back[#back + 1] = corners[i] end
      corners = back
    end
    scene:face(corners)
  end
  side(0, true)
  side(thickness, false)
  for i = 2, #outline do
    local a, b = outline[i - 1], outline[i]
    scene:quad({a[1], 0, a[2]}, {a[1], thickness, a[2]}, {b[1], thickness, b[2]},
               {b[1], 0, b[2]})
  end
  scene:quad({0, 0, height}, {width, 0, height}, {width, thickness, height}, {0, thickness, height})
  scene:quad({0, thickness, 0}, {0, 0, 0}, {0, 0, height}, {0, thickness, height})
  scene:quad({width, 0, 0}, {width, thickness, 0}, {width, thickness, height}, {width, 0, height})
end

return walls
