-- SPDX-License-Identifier: Apache-2.0
-- Path data: numbers, commands, curves against their definitions.
local check = require "check"
local path = require "mission.svg_path"

local T = {}

local function numbers(text)
  local r, list = path.reader(text), {}
  while not r.done() do list[#list + 1] = r.number() end
  return list
end

-- The only stroke of some data.
local function stroke(data)
  local strokes = path.strokes(data)
  check.equal(#strokes, 1, data)
  return strokes[1]
end

function T.numbers_need_no_blanks()
  check.equal(numbers("1.5.5"), { 1.5, 0.5 })
  check.equal(numbers("1-2+3"), { 1, -2, 3 })
  check.equal(numbers(" \t\n,1,,2, "), { 1, 2 })
  check.equal(numbers("1e2-1E-2.5e1"), { 100, -0.01, 5 })
  check.equal(numbers("-.5-0.25 7."), { -0.5, -0.25, 7 })
  check.equal(numbers(""), {})
end

function T.what_is_no_number_is_quoted()
  for _, text in ipairs { "x", "--1", "+", ".", "nan", "0x10x", "1e", "inf" } do
    check.fails("path data: expected a number at '", numbers, text)
  end
  check.fails("at 'wrong number '", numbers, "1 wrong number that goes on")
end

function T.lines_relative_and_not()
  local corners = { { 1, 2 }, { 4, 2 }, { 4, 7 }, { 0, 7 }, { 0, 0 } }
  for _, data in ipairs { "M1,2 L4,2 L4,7 L0,7 L0,0", "M1 2 4 2 4 7 0 7 0 0",
                          "m1,2 l3,0 l0,5 l-4,0 l0,-7", "m1 2 3 0 0 5-4 0 0-7",
                          "M1,2 H4 V7 H0 V0", "m1,2h3v5h-4v-7", "M1,2 H2 3 4 V5 6 7 H0 V0" } do
    local got = stroke(data)
    -- Several numbers of H are several points on one line.
    local kept = {}
    for _, p in ipairs(got) do
      for _, corner in ipairs(corners) do
        if p[1] == corner[1] and p[2] == corner[2] then kept[#kept + 1] = p end
      end
    end
    check.equal(kept, corners, data)
  end
end

function T.a_closed_part_ends_where_it_began()
  check.equal(path.strokes("M1,1 h2 v2 z"), { { { 1, 1 }, { 3, 1 }, { 3, 3 }, { 1, 1 } } })
  -- What follows without a move begins there as well, relative or not.
  check.equal(path.strokes("M1,1 h2 v2 z l5,5"),
              { { { 1, 1 }, { 3, 1 }, { 3, 3 }, { 1, 1 } }, { { 1, 1 }, { 6, 6 } } })
  check.equal(path.strokes("M1,1 h2 z m1,1 h2"),
              { { { 1, 1 }, { 3, 1 }, { 1, 1 } }, { { 2, 2 }, { 4, 2 } } })
  check.equal(path.strokes("M1,1 h2 M5,5 h1"), { { { 1, 1 }, { 3, 1 } }, { { 5, 5 }, { 6, 5 } } })
  check.equal(path.strokes("M1,1 M5,5"), {}, "a move draws nothing")
  check.equal(path.strokes(""), {})
end

-- A Bezier curve by its definition, the Bernstein polynomials.
local function bernstein(p, t)
  local s = 1 - t
  local w = #p == 3 and { s * s, 2 * s * t, t * t }
            or { s ^ 3, 3 * s * s * t, 3 * s * t * t, t ^ 3 }
  local x, y = 0, 0
  for i, share in ipairs(w) do x, y = x + share * p[i][1], y + share * p[i][2] end
  return { x, y }
end

-- That the last points of `got` are those of the curve at even parameters.
local function on_curve(got, p, what)
  local pieces = 24
  for i = 0, pieces do
    check.near(got[#got - pieces + i], bernstein(p, i / pieces), 1e-12, what)
  end
end

function T.curves_are_those_of_their_definition()
  local cubic = { { 1, 2 }, { 3, 9 }, { -4, 5 }, { 7, 1 } }
  on_curve(stroke "M1,2 C3,9 -4,5 7,1", cubic, "C")
  on_curve(stroke "M1,2 c2,7 -5,3 6,-1", cubic, "c")
  local square = { { 1, 2 }, { 3, 9 }, { 7, 1 } }
  on_curve(stroke "M1,2 Q3,9 7,1", square, "Q")
  on_curve(stroke "M1,2 q2,7 6,-1", square, "q")
  -- A quadratic curve raised to a cubic one is the same curve.
  check.near(stroke "M0,0 Q3,6 9,0", stroke "M0,0 C2,4 5,4 9,0", 1e-12)
end

function T.smooth_curves_mirror_the_control_point()
  on_curve(stroke "M0,0 C1,1 2,3 4,4 S9,9 10,0", { { 4, 4 }, { 6, 5 }, { 9, 9 }, { 10, 0 } }, "S")
  on_curve(stroke "M0,0 c1,1 2,3 4,4 s5,5 6,-4", { { 4, 4 }, { 6, 5 }, { 9, 9 }, { 10, 0 } }, "s")
  on_curve(stroke "M0,0 S2,3 4,4 8,8 9,0", { { 4, 4 }, { 6, 5 }, { 8, 8 }, { 9, 0 } }, "S S")
  on_curve(stroke "M0,0 Q1,3 4,4 T10,0", { { 4, 4 }, { 7, 5 }, { 10, 0 } }, "T")
  on_curve(stroke "M0,0 Q1,3 4,4 T10,0 12,1", { { 10, 0 }, { 13, -5 }, { 12, 1 } }, "T T")
  -- Only a curve of the same degree before is mirrored; else the control point is the beginning.
  on_curve(stroke "M0,0 S2,3 4,4", { { 0, 0 }, { 0, 0 }, { 2, 3 }, { 4, 4 } }, "S alone")
  on_curve(stroke "M0,0 Q1,3 4,4 S9,9 10,0", { { 4, 4 }, { 4, 4 }, { 9, 9 }, { 10, 0 } }, "Q S")
  on_curve(stroke "M0,0 C1,1 2,3 4,4 T10,0", { { 4, 4 }, { 4, 4 }, { 10, 0 } }, "C T")
  on_curve(stroke "M0,0 C1,1 2,3 4,4 L5,5 S9,9 10,0", { { 5, 5 }, { 5, 5 }, { 9, 9 }, { 10, 0 } },
           "L between")
end

-- The turn about a centre from the first to the last point, in radians, y down: positive is the
-- direction of growing angles. Every point must be `radius` from it.
local function turned(points, cx, cy, radius)
  local sum = 0
  for i, p in ipairs(points) do
    check.near(math.sqrt((p[1] - cx) ^ 2 + (p[2] - cy) ^ 2), radius, 1e-9, "radius")
    if i > 1 then
      local a = math.atan(points[i - 1][2] - cy, points[i - 1][1] - cx)
      local b = math.atan(p[2] - cy, p[1] - cx)
      sum = sum + (b - a + math.pi) % (2 * math.pi) - math.pi
    end
  end
  return sum
end

function T.the_flags_of_an_arc_choose_among_four()
  for _, case in ipairs {
    { "0 1", 0, 0, 90 }, { "1 0", 0, 0, -270 }, { "0 0", 1, 1, -90 }, { "1 1", 1, 1, 270 },
    { "01", 0, 0, 90 }, { "10", 0, 0, -270 },
  } do
    local flags, cx, cy, degrees = table.unpack(case)
    for _, radii in ipairs { "1,1", "-1,1", "1-1" } do
      local got = stroke("M1,0 A" .. radii .. " 0 " .. flags .. " 0,1")
      check.near(got[#got], { 0, 1 }, 1e-12)
      check.near(math.deg(turned(got, cx, cy, 1)), degrees, 1e-6, flags)
    end
  end
end

function T.flags_need_no_blanks_before_a_number()
  check.near(stroke "M1,0a1,1 0 01-1,1", stroke "M1,0 A1,1 0 0 1 0,1", 1e-12)
  check.near(stroke "M1,0a1,1 0 10.5.5", stroke "M1,0 A1,1 0 1 0 1.5,.5", 1e-12)
  -- Two arcs of one command.
  local got = stroke "M1,0 A1,1 0 0 1 0,1 1,1 0 0 1-1,0"
  check.near(math.deg(turned(got, 0, 0, 1)), 180, 1e-6)
end

function T.an_arc_that_cannot_reach_grows()
  local got = stroke "M0,0 A1,1 0 0 1 4,0"
  check.near(math.deg(turned(got, 2, 0, 2)), 180, 1e-6)
  got = stroke "M0,0 A1,1 0 0 0 4,0"
  check.near(math.deg(turned(got, 2, 0, 2)), -180, 1e-6)
  -- An ellipse grows in its own proportion: here one that is twice as high as it is wide.
  for _, p in ipairs(stroke "M0,0 A1,2 0 0 1 6,0") do
    check.near(((p[1] - 3) / 3) ^ 2 + (p[2] / 6) ^ 2, 1, 1e-9)
  end
  for _, p in ipairs(stroke "M0,0 A1,2 0 0 1 0,8") do
    check.near((p[1] / 2) ^ 2 + ((p[2] - 4) / 4) ^ 2, 1, 1e-9)
  end
end

function T.arcs_without_a_curve()
  check.equal(stroke "M1,2 A0,5 0 0 1 3,4", { { 1, 2 }, { 3, 4 } }, "no radius: a line")
  check.equal(stroke "M1,2 A5,0 0 0 1 3,4", { { 1, 2 }, { 3, 4 } })
  check.equal(stroke "M1,2 A5,5 0 1 1 1,2", { { 1, 2 } }, "ends where it begins: nothing")
end

-- A turned ellipse: every point fulfils its equation about the middle, and the arc stays on one
-- side.
function T.turned_ellipses_fulfil_their_equation()
  local turn = math.rad(30)
  local c, s = math.cos(turn), math.sin(turn)
  local got = stroke(("M%.17g,%.17g A5,2 30 0 1 %.17g,%.17g"):format(5 * c, 5 * s, -5 * c, -5 * s))
  for _, p in ipairs(got) do
    local u, v = c * p[1] + s * p[2], -s * p[1] + c * p[2]
    check.near((u / 5) ^ 2 + (v / 2) ^ 2, 1, 1e-9)
    check.yes(v > -1e-9, "on the side of growing angles")
  end
  check.yes(#got >= 36, "a piece for every five degrees")
end

function T.errors()
  check.fails("path data must begin with a command", path.strokes, "1,2")
  check.fails("path data must begin with a command", path.strokes, "M0,0 z 5,5")
  for _, data in ipairs { "L1,1", "z", "h5", "B1,1" } do
    check.fails("must begin with a move, M or m, not with '" .. data:sub(1, 1) .. "'", path.strokes,
                data)
  end
  check.fails("unknown path command 'B'", path.strokes, "M0,0 B1,1")
  check.fails("expected a number at ''", path.strokes, "M0,0 L1")
  check.fails("expected a number at 'L2,2'", path.strokes, "M0,0 C1,1 2,2 L2,2")
  check.fails("expected a flag 0 or 1", path.strokes, "M0,0 A1,1 0 2 1 3,3")
  check.fails("expected a flag 0 or 1", path.strokes, "M0,0 A1,1 0 0")
end

return check.all(T)
