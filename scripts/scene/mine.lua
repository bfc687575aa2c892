-- SPDX-License-Identifier: Apache-2.0
-- Mines: galleries of rough rock on a bent grid, 3 to 6 m wide and 2.5 to 6 m high, with chambers,
-- dead ends and pillars. Every seed is another mine; half of them have no roof. For training.
local colors = require "scene.colors"

local SLICES = 7  -- faces of a wall of one cell, along and up

-- Which cells of a grid are galleries: ways between nodes `pitch` cells apart, and chambers.
local function dig(scene, columns, rows, pitch)
  local open = {}
  for i = 1, columns do open[i] = {} end
  local function carve(i, k)
    if i > 1 and k > 1 and i < columns and k < rows then open[i][k] = true end
  end
  local across, up = (columns - 2) // pitch, (rows - 2) // pitch
  local function node(a, b) return 2 + a * pitch, 2 + b * pitch end
  local function way(a, b, c, d)
    local i, k = node(a, b)
    local last_i, last_k = node(c, d)
    local wide = scene:uniform(0, 1) < 0.25
    while true do
      carve(i, k)
      if wide then carve(i + (b ~= d and 1 or 0), k + (a ~= c and 1 or 0)) end
      if i == last_i and k == last_k then return end
      i = i + (last_i > i and 1 or last_i < i and -1 or 0)
      k = k + (last_k > k and 1 or last_k < k and -1 or 0)
    end
  end
  -- A tree over all nodes, so that every gallery is reached, then some loops.
  local reached, border = {}, {{across // 2, up // 2}}
  reached[(across // 2) * 1000 + up // 2] = true
  while #border > 0 do
    local at = scene:integer(math.max(1, #border - 3), #border)
    local from = border[at]
    local free = {}
    for _, s in ipairs {{1, 0}, {-1, 0}, {0, 1}, {0, -1}} do
      local a, b = from[1] + s[1], from[2] + s[2]
      local inside = a >= 0 and b >= 0 and a < across and b < up
      if inside and not reached[a * 1000 + b] then free[#free + 1] = {a, b} end
    end
    if #free == 0 then
      table.remove(border, at)
    else
      local to = free[scene:integer(1, #free)]
      reached[to[1] * 1000 + to[2]] = true
      way(from[1], from[2], to[1], to[2])
      border[#border + 1] = to
    end
  end
  for _ = 1, across * up // 4 do
    local a, b = scene:integer(0, across - 2), scene:integer(0, up - 2)
    if scene:uniform(0, 1) < 0.5 then way(a, b, a + 1, b) else way(a, b, a, b + 1) end
  end
  for _ = 1, scene:integer(1, 3) do
    local i, k = node(scene:integer(0, across - 1), scene:integer(0, up - 1))
    local w, d = scene:integer(2, 4), scene:integer(2, 4)
    for x = i, i + w do for y = k, k + d do carve(x, y) end end
  end
  return open
end

return function(options)
  local scene = lapwing.scene { name = "mine", seed = options.seed or 1 }
  local edge = scene:uniform(2.8, 4.2)
  local columns, rows = scene:integer(16, 24), scene:integer(16, 24)
  local open = dig(scene, columns, rows, scene:integer(3, 5))
  local high, rough = scene:uniform(2.6, 6), scene:uniform(0.05, 0.45)
  local roof = scene:uniform(0, 1) < 0.5
  local bend = {scene:uniform(-0.02, 0.02), scene:uniform(-0.02, 0.02), scene:uniform(0, 6)}
  local function is_open(i, k) return open[i] and open[i][k] or false end

  -- Corners are drawn once, so that neighbouring faces meet.
  local drawn = {}
  local function corner(x, y, z)
    local key = ("%.3f %.3f %.3f"):format(x, y, z)
    if not drawn[key] then
      local b = edge * math.sin(bend[3] + x / 14) * 0.6
      local p = {x * (1 + bend[1]) + bend[2] * y, y + b, z}
      for axis = 1, 3 do p[axis] = p[axis] + scene:uniform(-rough, rough) end
      drawn[key] = p
    end
    return drawn[key]
  end
  -- From a corner along two edges, in slices.
  local function rock(from, along, up)
    local function at(i, k)
      return corner(from[1] + (along[1] * i + up[1] * k) / SLICES,
                    from[2] + (along[2] * i + up[2] * k) / SLICES,
                    from[3] + (along[3] * i + up[3] * k) / SLICES)
    end
    for i = 0, SLICES - 1 do
      for k = 0, SLICES - 1 do
        scene:face {at(i, k), at(i + 1, k), at(i + 1, k + 1)}
        scene:face {at(i, k), at(i + 1, k + 1), at(i, k + 1)}
      end
    end
  end

  for i = 1, columns do
    for k = 1, rows do
      if is_open(i, k) then
        local x, y = (i - 1) * edge, (k - 1) * edge
        colors.use(scene, "cobbles")
        rock({x, y, 0}, {edge, 0, 0}, {0, edge, 0})
        colors.use(scene, "stone")
        if roof then rock({x, y, high}, {0, edge, 0}, {edge, 0, 0}) end
        if not is_open(i - 1, k) then rock({x, y, 0}, {0, edge, 0}, {0, 0, high}) end
        if not is_open(i + 1, k) then rock({x + edge, y + edge, 0}, {0, -edge, 0}, {0, 0, high}) end
        if not is_open(i, k - 1) then rock({x + edge, y, 0}, {-edge, 0, 0}, {0, 0, high}) end
        if not is_open(i, k + 1) then rock({x, y + edge, 0}, {edge, 0, 0}, {0, 0, high}) end
        if scene:uniform(0, 1) < 0.04 then  -- a prop
          local cx, cy = x + edge / 2, y + edge / 2
          local b = edge * math.sin(bend[3] + cx / 14) * 0.6
          scene:tube({cx * (1 + bend[1]) + bend[2] * cy, cy + b, -0.2},
                     {cx * (1 + bend[1]) + bend[2] * cy, cy + b, high}, 0.15, 0.15, 6)
        end
      end
    end
  end
  scene:region({0, -edge, 0}, {(columns + 1) * edge, (rows + 1) * edge, high})
  scene:moves { step = 0.9, body = 0.6, clear = 2, speed = 0.8 }
  return scene
end
