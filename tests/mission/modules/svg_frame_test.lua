-- SPDX-License-Identifier: Apache-2.0
-- Strokes cut to a rectangle: known cuts, and random strokes against small steps along them.
local check = require "check"
local frames = require "mission.svg_frame"

local T = {}

local FRAME = { 0, 0, 10, 6 }

local function cut(stroke, margin)
  return frames.cut({ stroke }, FRAME, margin or 0)
end

function T.what_lies_within_stays()
  local strokes = { { { 1, 1 }, { 9, 5 }, { 3, 3 } }, { { 0, 0 }, { 10, 0 }, { 10, 6 }, { 0, 0 } } }
  local pieces, any = frames.cut(strokes, FRAME, 0)
  check.equal(pieces, strokes)
  check.equal(any, false)
end

function T.known_cuts()
  for _, case in ipairs {
    { "through", { { -5, 3 }, { 15, 3 } }, { { { 0, 3 }, { 10, 3 } } } },
    { "upright", { { 4, -10 }, { 4, 20 } }, { { { 4, 0 }, { 4, 6 } } } },
    { "backwards", { { 15, 3 }, { -5, 3 } }, { { { 10, 3 }, { 0, 3 } } } },
    { "out", { { 5, 3 }, { 15, 8 } }, { { { 5, 3 }, { 10, 5.5 } } } },
    { "in", { { 5, 9 }, { 5, 3 }, { 6, 3 } }, { { { 5, 6 }, { 5, 3 }, { 6, 3 } } } },
    { "beside", { { -5, 7 }, { 15, 7 } }, {} },
    { "past a corner", { { -2, 5 }, { 2, 9 } }, {} },
    { "out and back", { { 5, 3 }, { 5, 9 }, { 7, 9 }, { 7, 3 } },
      { { { 5, 3 }, { 5, 6 } }, { { 7, 6 }, { 7, 3 } } } },
    { "over the edge within one piece", { { 2, 3 }, { 12, 3 }, { 2, 3 } },
      { { { 2, 3 }, { 10, 3 } }, { { 10, 3 }, { 2, 3 } } } },
    { "just above", { { 1, -0.5 }, { 9, -0.5 } }, {} },
    { "just left", { { -0.5, 1 }, { -0.5, 5 } }, {} },
    { "a corner alone", { { -1, 1 }, { 1, -1 } }, {} },
    { "all of a point", { { 20, 20 }, { 20, 20 } }, {} },
  } do
    local pieces, any = cut(case[2])
    check.near(pieces, case[3], 1e-12, case[1])
    check.equal(any, true, case[1])
  end
end

function T.points_that_stand_twice_stay()
  for _, strokes in ipairs { { { { 1, 1 }, { 1, 1 }, { 5, 1 } } }, { { { 2, 2 }, { 2, 2 } } },
                             { { { 0, 0 }, { 0, 0 } } } } do
    local pieces, any = frames.cut(strokes, FRAME, 0)
    check.equal(pieces, strokes)
    check.equal(any, false)
  end
end

function T.a_margin_widens_all_sides()
  local pieces = cut({ { -5, 3 }, { 15, 3 } }, 0.5)
  check.near(pieces, { { { -0.5, 3 }, { 10.5, 3 } } }, 1e-12)
  pieces = cut({ { 5, -5 }, { 5, 15 } }, 0.5)
  check.near(pieces, { { { 5, -0.5 }, { 5, 6.5 } } }, 1e-12)
end

function T.a_frame_without_an_end_cuts_one_side()
  local pieces, any = frames.cut({ { { -5, 1 }, { 1e9, 1 } } }, { 0, 0, math.huge, math.huge }, 0)
  check.near(pieces, { { { 0, 1 }, { 1e9, 1 } } }, 1e-3)
  check.equal(any, true)
end

local function length_of(strokes)
  local sum = 0
  for _, stroke in ipairs(strokes) do
    for i = 2, #stroke do
      local p, q = stroke[i - 1], stroke[i]
      sum = sum + math.sqrt((q[1] - p[1]) ^ 2 + (q[2] - p[2]) ^ 2)
    end
  end
  return sum
end

-- The length within, by steps of a thousandth of each piece.
function T.nothing_within_is_lost_or_invented()
  local random = check.random(5)
  for _ = 1, 20 do
    local stroke = {}
    for i = 1, 6 do stroke[i] = { 20 * random() - 5, 14 * random() - 4 } end
    local inside = 0
    for i = 2, #stroke do
      local p, q = stroke[i - 1], stroke[i]
      local step = math.sqrt((q[1] - p[1]) ^ 2 + (q[2] - p[2]) ^ 2) / 1000
      for k = 0.5, 999.5 do
        local x = p[1] + (q[1] - p[1]) * k / 1000
        local y = p[2] + (q[2] - p[2]) * k / 1000
        if x >= 0 and x <= 10 and y >= 0 and y <= 6 then inside = inside + step end
      end
    end
    local pieces = cut(stroke)
    check.near(length_of(pieces), inside, 0.15, "length within")
    for _, piece in ipairs(pieces) do
      for _, p in ipairs(piece) do
        check.yes(p[1] > -1e-9 and p[1] < 10 + 1e-9 and p[2] > -1e-9 and p[2] < 6 + 1e-9, "within")
      end
    end
  end
end

return check.all(T)
