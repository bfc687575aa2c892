-- SPDX-License-Identifier: Apache-2.0
-- Roofs over a rectangle of `width` (x) by `depth` (y) whose walls end at height z. Metres.
local colors = require "scene.colors"

local roofs = {}

-- A profile in the plane of y and z, moved along x from x0 to x1.
function roofs.extrude(scene, profile, x0, x1)
  local left, right = {}, {}
  for i, p in ipairs(profile) do
    right[i] = {x1, p[1], p[2]}
    left[#profile + 1 - i] = {x0, p[1], p[2]}
  end
  scene:face(left)
  scene:face(right)
  for i, p in ipairs(profile) do
    local q = profile[i % #profile + 1]
    scene:quad({x0, p[1], p[2]}, {x0, q[1], q[2]}, {x1, q[1], q[2]}, {x1, p[1], p[2]})
  end
end

-- Two slopes over a ridge along x, `rise` high, with eaves. The gable ends are `wall` coloured.
function roofs.gable(scene, width, depth, z, rise, spec)
  spec = spec or {}
  local eaves, thick = spec.eaves or 0.6, 0.22
  local slope = rise / (depth / 2)
  local low, half = z - eaves * slope, depth / 2
  colors.use(scene, spec.wall or "plaster")
  for _, end_wall in ipairs {{0, true}, {width, false}} do
    local x, left = end_wall[1], end_wall[2]
    local corners = {{x, 0, z}, {x, depth, z}, {x, half, z + rise}}
    if left then corners[2], corners[3] = corners[3], corners[2] end
    scene:face(corners)
  end
  colors.use(scene, spec.color or "tiles")
  roofs.extrude(scene, {
    {-eaves, low}, {half, z + rise}, {depth + eaves, low},
    {depth + eaves, low + thick}, {half, z + rise + thick}, {-eaves, low + thick},
  }, -(spec.verge or 0.3), width + (spec.verge or 0.3))
end

-- Four slopes; the ridge along x is shorter by the depth.
function roofs.hip(scene, width, depth, z, rise, spec)
  spec = spec or {}
  local e = spec.eaves or 0.6
  local half = depth / 2
  local a, b, c, d = {-e, -e, z}, {width + e, -e, z}, {width + e, depth + e, z}, {-e, depth + e, z}
  local ridge = math.max(0.1, width / 2 - half)
  local p = {width / 2 - ridge, half, z + rise}
  local q = {width / 2 + ridge, half, z + rise}
  colors.use(scene, spec.color or "tiles")
  scene:face({a, b, q, p})
  scene:face({c, d, p, q})
  scene:face({b, c, q})
  scene:face({d, a, p})
  scene:face({a, d, c, b})
end

-- A flat roof behind a parapet, with what stands on such roofs.
function roofs.flat(scene, width, depth, z, spec)
  spec = spec or {}
  local rim, thick = spec.parapet or 0.9, 0.3
  colors.use(scene, spec.color or "tar")
  scene:quad({0, 0, z}, {width, 0, z}, {width, depth, z}, {0, depth, z})
  colors.use(scene, spec.wall or "concrete")
  scene:box({0, 0, z}, {width, thick, z + rim})
  scene:box({0, depth - thick, z}, {width, depth, z + rim})
  scene:box({0, thick, z}, {thick, depth - thick, z + rim})
  scene:box({width - thick, thick, z}, {width, depth - thick, z + rim})
  for _ = 1, spec.machines or 3 do
    local sx, sy, sz = scene:uniform(1, 2.6), scene:uniform(1, 2.2), scene:uniform(0.8, 1.8)
    if width > sx + 3 and depth > sy + 3 then
      local x, y = scene:uniform(1, width - sx - 1), scene:uniform(1, depth - sy - 1)
      colors.use(scene, "metal")
      scene:box({x, y, z + 0.2}, {x + sx, y + sy, z + 0.2 + sz})
      scene:tube({x + sx / 2, y + sy / 2, z + sz}, {x + sx / 2, y + sy / 2, z + sz + 0.5}, 0.35)
    end
  end
end

-- A chimney whose foot may be inside the roof.
function roofs.chimney(scene, x, y, z, height)
  colors.use(scene, "brick")
  scene:box({x - 0.4, y - 0.4, z}, {x + 0.4, y + 0.4, z + height})
  colors.use(scene, "stone")
  scene:box({x - 0.5, y - 0.5, z + height}, {x + 0.5, y + 0.5, z + height + 0.15})
  colors.use(scene, "tiles")
  scene:tube({x, y, z + height + 0.15}, {x, y, z + height + 0.7}, 0.18, 0.14)
end

-- A dormer on the slope that rises from y = 0: its front stands at y, its window sill at z.
function roofs.dormer(scene, x, y, z, depth, color)
  local w, h = 1.7, 1.5
  colors.use(scene, color or "white")
  scene:box({x - w / 2, y, z - 0.6}, {x + w / 2, y + depth, z + h})
  colors.use(scene, "glass")
  scene:box({x - 0.5, y - 0.03, z}, {x + 0.5, y, z + 1.15})
  colors.use(scene, "slate")
  scene:push({x + w / 2 + 0.15, y - 0.25, z + h}, math.pi / 2)
  roofs.extrude(scene, {{0, 0}, {w / 2 + 0.15, 0.75}, {w + 0.3, 0},
                        {w + 0.3, 0.12}, {w / 2 + 0.15, 0.87}, {0, 0.12}}, 0, depth + 0.3)
  scene:pop()
end

return roofs
