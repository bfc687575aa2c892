-- SPDX-License-Identifier: Apache-2.0
-- Shapes of a picture, lengths, transforms and the frames that pictures are seen through.
local check = require "check"
local path = require "mission.svg_path"
local shapes = require "mission.svg_shapes"

local T = {}

local function moved(matrix, x, y)
  return { matrix[1] * x + matrix[3] * y + matrix[5], matrix[2] * x + matrix[4] * y + matrix[6] }
end

function T.transforms_move_points_as_svg_says()
  for _, case in ipairs {
    { "", { 3, 4 } }, { "translate(10)", { 13, 4 } }, { "translate(10, -2)", { 13, 2 } },
    { "scale(2)", { 6, 8 } }, { "scale(2 -1)", { 6, -4 } }, { "rotate(90)", { -4, 3 } },
    { "rotate(-90)", { 4, -3 } }, { "rotate(90 3 4)", { 3, 4 } },
        { "rotate(180, 1, 1)", { -1, -2 } },
    { "skewX(45)", { 7, 4 } }, { "skewY(45)", { 3, 7 } }, { "matrix(1 2 3 4 5 6)", { 20, 28 } },
    -- The last is applied first.
    { "translate(10,0) scale(2)", { 16, 8 } }, { "scale(2),translate(10,0)", { 26, 8 } },
    { "  rotate( 90 )translate(1)\n", { -4, 4 } },
  } do
    check.near(moved(shapes.transform(case[1]), 3, 4), case[2], 1e-12, case[1])
  end
  check.equal(shapes.transform(nil), shapes.IDENTITY)
end

function T.products_of_transforms_are_associative()
  local random = check.random(3)
  local function any()
    local m = {}
    for i = 1, 6 do m[i] = 2 * random() - 1 end
    return m
  end
  for _ = 1, 20 do
    local a, b, c = any(), any(), any()
    check.near(shapes.times(shapes.times(a, b), c), shapes.times(a, shapes.times(b, c)), 1e-12)
    check.near(shapes.times(a, shapes.IDENTITY), a, 0)
    check.near(shapes.times(shapes.IDENTITY, a), a, 0)
    local p = moved(b, 1, 2)
    check.near(moved(shapes.times(a, b), 1, 2), moved(a, p[1], p[2]), 1e-12)
  end
end

function T.wrong_transforms_are_named()
  for text, message in pairs {
    ["rotate(90"] = "lacks its ')'", ["turn(90)"] = "unknown transform 'turn'",
    ["matrix(1 2 3)"] = "transform matrix", ["scale()"] = "transform scale",
    ["rotate(1 2)"] = "transform rotate", ["translate(1 2 3)"] = "transform translate",
    ["skewX(1 2)"] = "transform skewX", ["matrix(1 2 3 4 5 6 7)"] = "transform matrix",
    ["scale(x)"] = "expected a number", ["rotate 90"] = "transform 'rotate 90'",
    ["scale(2) and more"] = "transform ' and more'", ["rotate(9) 5 scale(2)"] = "unknown transform",
    ["(1 2)"] = "unknown transform",
  } do
    check.fails(message, shapes.transform, text)
  end
end

function T.lengths_have_units()
  for text, units in pairs { ["5"] = 5, [" 5px "] = 5, ["1in"] = 96, ["2.54cm"] = 96,
                             ["25.4 mm"] = 96,
                             ["72pt"] = 96, ["6pc"] = 96, ["-.5"] = -0.5, ["1e1"] = 10,
                             ["+2E-1in"] = 19.2 } do
    check.near(shapes.length({ w = text }, "w"), units, 1e-12, text)
  end
  check.equal(shapes.length({}, "w", 7), 7)
  check.equal(shapes.length({}, "w"), nil)
  check.fails("w is '50%': percentages are not read", shapes.length, { w = "50%" }, "w")
  for _, text in ipairs { "", "px", "1em", "2 3", "1e", "5+3", "1..2", "four", "1 px px" } do
    check.fails("w is '" .. text .. "': expected a number", shapes.length, { w = text }, "w")
  end
end

-- Least and greatest x and y of a shape, and its length.
local function extent(name, attributes)
  local data = shapes.data[name](attributes)
  if not data then return nil end
  local left, top, right, bottom, length = math.huge, math.huge, -math.huge, -math.huge, 0
  local strokes = path.strokes(data)
  for _, stroke in ipairs(strokes) do
    for i, p in ipairs(stroke) do
      left, right = math.min(left, p[1]), math.max(right, p[1])
      top, bottom = math.min(top, p[2]), math.max(bottom, p[2])
      local q = stroke[i - 1]
      if q then length = length + math.sqrt((p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2) end
    end
  end
  return { left, top, right, bottom }, length, strokes
end

function T.shapes_reach_as_far_as_they_say()
  local box, length = extent("rect", { x = "1", y = "2", width = "10", height = "4" })
  check.near(box, { 1, 2, 11, 6 }, 1e-9)
  check.near(length, 28, 1e-9)
  box, length = extent("circle", { cx = "1", cy = "2", r = "3" })
  check.near(box, { -2, -1, 4, 5 }, 1e-6)
  check.near(length, 6 * math.pi, 0.01)
  box = extent("ellipse", { cx = "1", cy = "2", rx = "3", ry = "5" })
  check.near(box, { -2, -3, 4, 7 }, 1e-6)
  box, length = extent("line", { x1 = "1", y1 = "2", x2 = "4", y2 = "6" })
  check.near(box, { 1, 2, 4, 6 }, 0)
  check.near(length, 5, 1e-12)
  box, length = extent("polyline", { points = "0,0 3,4 3,0" })
  check.near(length, 9, 1e-12)
  box, length = extent("polygon", { points = "0,0 3,4 3,0" })
  check.near(length, 12, 1e-12)
  check.near(box, { 0, 0, 3, 4 }, 0)
end

-- Round corners: four quarters of an ellipse take the place of the corners.
function T.rectangles_with_round_corners()
  local box, length, strokes = extent("rect", { width = "10", height = "6", rx = "1" })
  check.near(box, { 0, 0, 10, 6 }, 1e-9)
  check.near(length, 2 * (8 + 4) + 2 * math.pi, 0.01)
  for _, p in ipairs(strokes[1]) do
    check.yes((math.min(p[1], 10 - p[1]) - 1) ^ 2 + (math.min(p[2], 6 - p[2]) - 1) ^ 2 > 1 - 1e-9
              or math.min(p[1], 10 - p[1]) >= 1 - 1e-9 or math.min(p[2], 6 - p[2]) >= 1 - 1e-9)
  end
  local first = strokes[1][1]
  check.near(strokes[1][#strokes[1]], first, 1e-9, "closed")
  -- One radius serves both; more than half a side is half of it.
  local _, both = extent("rect", { width = "10", height = "6", rx = "1", ry = "1" })
  check.near(both, length, 1e-9)
  local _, other = extent("rect", { width = "10", height = "6", ry = "1" })
  check.near(other, length, 1e-9)
  box, length = extent("rect", { width = "6", height = "6", rx = "100" })
  check.near(length, 6 * math.pi, 0.01, "a circle")
  check.near(box, { 0, 0, 6, 6 }, 1e-9)
end

function T.shapes_of_no_size_are_none()
  check.equal(extent("rect", { width = "10" }), nil)
  check.equal(extent("rect", {}), nil)
  check.equal(extent("circle", { r = "0" }), nil)
  check.equal(extent("ellipse", { rx = "3" }), nil)
  check.equal(shapes.data.polyline({ points = " \n" }), "")
  check.equal(shapes.data.polygon({}), "")
  check.equal(shapes.data.path({}), "")
  check.fails("must not be below 0", extent, "rect", { width = "-1", height = "2" })
  check.fails("must not be below 0", extent, "circle", { r = "-1" })
  check.fails("must not be below 0", extent, "ellipse", { rx = "1", ry = "-1" })
end

function T.a_view_box_is_fitted_in_the_middle()
  -- 10 x 10 shown in 40 x 20: twice as large, 10 free to the left and to the right.
  local matrix = shapes.viewport({ viewBox = "5 2 10 10" }, { width = "40", height = "20" })
  check.near(moved(matrix, 5, 2), { 10, 0 }, 1e-12)
  check.near(moved(matrix, 15, 12), { 30, 20 }, 1e-12)
  matrix = shapes.viewport({ viewBox = "0 0 10 20", x = "100", y = "1" }, {})
  check.near(moved(matrix, 1, 2), { 101, 3 }, 1e-12, "without a size: its own units")
  check.near(shapes.viewport({ x = "3" }, {}), { 1, 0, 0, 1, 3, 0 }, 0)
  for _, box in ipairs { "0 0 10", "0 0 0 10", "0 0 10 -1", "1 2 3 4 5" } do
    check.fails("viewBox: expected four numbers", shapes.viewport, { viewBox = box }, {})
  end
end

function T.frames_of_windows()
  local function frame(box, w, h, fit)
    return shapes.frame { viewBox = box, width = w, height = h, preserveAspectRatio = fit }
  end
  check.equal(frame(nil, nil, nil), nil)
  check.equal(frame(nil, "100%", "100%"), nil, "the window's")
  check.near(frame(nil, "20", "10"), { 0, 0, 20, 10 }, 0)
  check.near(frame(nil, "20", nil), { 0, 0, 20, math.huge }, 0)
  check.near(frame("1 2 10 20", nil, nil), { 1, 2, 11, 22 }, 0)
  check.near(frame("0 0 .5 .25", "2", "1"), { 0, 0, 0.5, 0.25 }, 0)
  check.near(frame("0 0 0 1", "2", "1"), { 0, 0, 2, 1 }, 0, "none that can be seen through")
  -- A wide window over a square shows more to both sides, or to one.
  check.near(frame("0 0 10 10", "40", "20"), { -5, 0, 15, 10 }, 1e-12)
  check.near(frame("0 0 10 10", "40", "20", "xMinYMid"), { 0, 0, 20, 10 }, 1e-12)
  check.near(frame("0 0 10 10", "40", "20", "xMaxYMid meet"), { -10, 0, 10, 10 }, 1e-12)
  check.near(frame("0 0 10 10", "40", "20", "none"), { 0, 0, 10, 10 }, 1e-12)
  -- Filled: less of it, above and below.
  check.near(frame("0 0 10 10", "40", "20", "xMidYMid slice"), { 0, 2.5, 10, 7.5 }, 1e-12)
  check.near(frame("0 0 10 10", "40", "20", "xMidYMin slice"), { 0, 0, 10, 5 }, 1e-12)
  check.near(frame("0 0 10 10", "20", "40", "xMidYMax"), { 0, -10, 10, 10 }, 1e-12)
end

return check.all(T)
