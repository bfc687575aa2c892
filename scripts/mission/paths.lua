-- SPDX-License-Identifier: Apache-2.0
-- Paths in the format of the kernel: a flat list of x, y, z of each point.
local M = {}

-- Of a list of points, which are lists of numbers or vectors.
function M.flat(points)
  local numbers = {}
  for _, p in ipairs(points) do
    local n = #numbers
    numbers[n + 1], numbers[n + 2], numbers[n + 3] = p[1], p[2], p[3]
  end
  return numbers
end

-- Point `i` of such a path, from 1.
function M.point(numbers, i) return { table.unpack(numbers, 3 * i - 2, 3 * i) } end

-- m, between two places.
function M.distance(a, b) return lapwing.norm(lapwing.vector(b) - a) end

-- m, of a list of places joined by straight lines.
function M.length(places)
  local length = 0
  for i = 2, #places do length = length + M.distance(places[i - 1], places[i]) end
  return length
end

return M
