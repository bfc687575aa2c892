-- SPDX-License-Identifier: Apache-2.0
-- What stands in streets: lamps, cars, benches, poles with wires. Metres.
local colors = require "scene.colors"

local furniture = {}

-- A lamp post whose arm reaches along the frame's +y.
function furniture.lamp(scene, at, yaw)
  scene:push(at, yaw or 0)
  colors.use(scene, "dark")
  scene:tube({0, 0, 0}, {0, 0, 0.8}, 0.14, 0.1, 8)
  scene:tube({0, 0, 0.8}, {0, 0, 5.6}, 0.07, 0.05, 8)
  scene:tube({0, 0, 5.5}, {0, 0.9, 5.9}, 0.04, 0.04, 6)
  scene:box({-0.16, 0.75, 5.75}, {0.16, 1.35, 5.9})
  colors.use(scene, "white")
  scene:box({-0.12, 0.8, 5.71}, {0.12, 1.3, 5.75})
  scene:pop()
end

local paints = {"red", "blue", "white", "dark", "metal", "ochre"}

-- A car whose front looks along +x of the frame.
function furniture.car(scene, at, yaw)
  scene:push(at, yaw or 0)
  local paint = colors.pick(scene, paints)
  colors.use(scene, paint)
  local function body(profile, half)
    -- Profiles lie in x and z; the frame is turned so that they are extruded across.
    local left, right = {}, {}
    for i, p in ipairs(profile) do
      left[i] = {p[1], -half, p[2]}
      right[#profile + 1 - i] = {p[1], half, p[2]}
    end
    scene:face(left)
    scene:face(right)
    for i, p in ipairs(profile) do
      local q = profile[i % #profile + 1]
      scene:quad({p[1], half, p[2]}, {q[1], half, q[2]}, {q[1], -half, q[2]}, {p[1], -half, p[2]})
    end
  end
  body({{-2.1, 0.3}, {2.1, 0.3}, {2.15, 0.65}, {1.9, 0.85}, {1.0, 0.95}, {-1.8, 0.95},
        {-2.15, 0.85}}, 0.86)
  colors.use(scene, "glass")
  body({{-1.75, 0.95}, {1.0, 0.95}, {0.35, 1.42}, {-1.25, 1.42}}, 0.74)
  colors.use(scene, paint)
  scene:box({-1.2, -0.7, 1.42}, {0.32, 0.7, 1.46})
  colors.use(scene, "rubber")
  for _, x in ipairs {-1.3, 1.3} do
    scene:tube({x, -0.88, 0.32}, {x, -0.66, 0.32}, 0.32, 0.32, 12)
    scene:tube({x, 0.66, 0.32}, {x, 0.88, 0.32}, 0.32, 0.32, 12)
  end
  scene:pop()
end

function furniture.bench(scene, at, yaw)
  scene:push(at, yaw or 0)
  colors.use(scene, "wood")
  for i = 0, 3 do scene:box({-0.8, 0.12 * i, 0.42}, {0.8, 0.12 * i + 0.09, 0.46}) end
  for i = 0, 2 do scene:box({-0.8, 0.46, 0.55 + 0.14 * i}, {0.8, 0.49, 0.65 + 0.14 * i}) end
  colors.use(scene, "metal")
  for _, x in ipairs {-0.7, 0.65} do
    scene:box({x, 0, 0}, {x + 0.05, 0.45, 0.42})
    scene:box({x, 0.44, 0.42}, {x + 0.05, 0.47, 0.95})
  end
  scene:pop()
end

-- A stall or terrace roof of cloth on four posts: w by d, seen from inside and outside.
function furniture.awning(scene, at, yaw, w, d)
  scene:push(at, yaw or 0)
  colors.use(scene, "metal")
  for _, x in ipairs {0, w - 0.06} do
    for _, y in ipairs {0, d - 0.06} do scene:box({x, y, 0}, {x + 0.06, y + 0.06, 2.4}) end
  end
  for i = 0, 5 do
    colors.use(scene, i % 2 == 0 and "red" or "white")
    scene:quad({w * i / 6, -0.2, 2.35}, {w * (i + 1) / 6, -0.2, 2.35},
               {w * (i + 1) / 6, d + 0.1, 2.9}, {w * i / 6, d + 0.1, 2.9})
  end
  scene:pop()
end

-- A round table with four chairs.
function furniture.table(scene, at)
  scene:push(at)
  colors.use(scene, "wood")
  scene:tube({0, 0, 0.72}, {0, 0, 0.76}, 0.45, 0.45, 12)
  scene:tube({0, 0, 0}, {0, 0, 0.72}, 0.05, 0.05, 6)
  for i = 0, 3 do
    scene:push({0, 0, 0}, math.pi / 2 * i + 0.4)
    scene:box({0.6, -0.2, 0.42}, {1.0, 0.2, 0.46})
    scene:box({0.97, -0.2, 0.46}, {1.0, 0.2, 0.9})
    for _, p in ipairs {{0.62, -0.18}, {0.95, -0.18}, {0.62, 0.15}, {0.95, 0.15}} do
      scene:box({p[1], p[2], 0}, {p[1] + 0.03, p[2] + 0.03, 0.42})
    end
    scene:pop()
  end
  scene:pop()
end

-- Poles at the places of a list, with wires that hang between them.
function furniture.power_line(scene, places, height)
  height = height or 9
  local arms = {-1.1, 0, 1.1}
  local yaws = {}
  for i = 1, #places do
    local a, b = places[math.max(1, i - 1)], places[math.min(#places, i + 1)]
    yaws[i] = math.atan(b[2] - a[2], b[1] - a[1])
  end
  local function hook(i, arm)
    local p = places[i]
    return {p[1] - arm * math.sin(yaws[i]), p[2] + arm * math.cos(yaws[i]),
            (p[3] or 0) + height - 0.35}
  end
  for i, p in ipairs(places) do
    local z = p[3] or 0
    colors.use(scene, "wood")
    scene:tube({p[1], p[2], z - 0.5}, {p[1], p[2], z + height}, 0.16, 0.11, 8)
    scene:push({p[1], p[2], z}, yaws[i])
    scene:box({-0.06, -1.3, height - 0.65}, {0.06, 1.3, height - 0.5})
    colors.use(scene, "white")
    for _, arm in ipairs(arms) do
      scene:tube({0, arm, height - 0.5}, {0, arm, height - 0.35}, 0.05, 0.04, 6)
    end
    scene:pop()
  end
  colors.use(scene, "dark")
  local pieces = 10
  for i = 1, #places - 1 do
    for _, arm in ipairs(arms) do
      local a, b = hook(i, arm), hook(i + 1, arm)
      local span = math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2)
      local sag, last = 0.03 * span, a
      for k = 1, pieces do
        local s = k / pieces
        local p = {a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2]),
                   a[3] + s * (b[3] - a[3]) - 4 * sag * s * (1 - s)}
        scene:tube(last, p, 0.025, 0.025, 4)
        last = p
      end
    end
  end
end

return furniture
