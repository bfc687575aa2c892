-- SPDX-License-Identifier: Apache-2.0
-- Clips strokes to a rectangle.
local M = {}

-- The shares of a piece from p to q between which it lies within; nil where none of it does.
local function shares(p, q, frame)
  local first, last = 0, 1
  for axis = 1, 2 do
    local from, step = p[axis], q[axis] - p[axis]
    local low, high = frame[axis] - from, frame[axis + 2] - from
    if step == 0 then
      if low > 0 or high < 0 then return nil end
    else
      if step < 0 then low, high = high, low end
      first, last = math.max(first, low / step), math.min(last, high / step)
    end
  end
  if first > last then return nil end
  return first, last
end

local function between(p, q, share)
  if share == 0 then return p end
  if share == 1 then return q end
  return { p[1] + share * (q[1] - p[1]), p[2] + share * (q[2] - p[2]) }
end

-- The pieces of one stroke within the frame, added to `pieces`. Whether anything was cut off.
local function cut_stroke(stroke, frame, pieces)
  local piece, cut = nil, false
  for i = 2, #stroke do
    local p, q = stroke[i - 1], stroke[i]
    local first, last = shares(p, q, frame)
    if first ~= 0 or last ~= 1 then cut = true end
    if not first or first > 0 then piece = nil end
    if first and (first < last or first == 0 and last == 1) then
      if not piece then
        piece = { between(p, q, first) }
        pieces[#pieces + 1] = piece
      end
      piece[#piece + 1] = between(p, q, last)
    end
    if last ~= 1 then piece = nil end
  end
  return cut
end

-- Strokes, lists of {x, y}, cut to the frame { left, top, right, bottom }, widened by `margin`; and
-- whether anything was cut off. A stroke that leaves the frame and returns becomes several.
function M.cut(strokes, frame, margin)
  local wide = { frame[1] - margin, frame[2] - margin, frame[3] + margin, frame[4] + margin }
  local pieces, cut = {}, false
  for _, stroke in ipairs(strokes) do
    if cut_stroke(stroke, wide, pieces) then cut = true end
  end
  return pieces, cut
end

return M
