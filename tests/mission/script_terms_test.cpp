// SPDX-License-Identifier: Apache-2.0
// Cost terms and constraints written in Lua: the shipped ones written so agree with themselves.
#include "framework/core/random.h"
#include "tests/guide.h"
#include "tests/mission/term_fixture.h"

namespace lapwing {
namespace {

// What the shipped camera terms have in their headers (camera_axes.h, camera_error.h).
constexpr const char* kCameraParts = R"(
local function in_camera(yaw, pitch, d)
  local cy, sy = lapwing.cos(yaw), lapwing.sin(yaw)
  local cp, sp = lapwing.cos(pitch), lapwing.sin(pitch)
  return lapwing.vector(lapwing.dot({ sy, -cy, 0 }, d), lapwing.dot({ sp * cy, sp * sy, -cp }, d),
                        lapwing.dot({ cp * cy, cp * sy, sp }, d))
end
local function step(share)
  return share * share * share * (10 + share * (6 * share - 15))
end
local function near_fade(squared)
  local share = squared / 0.01
  return lapwing.where(share - 1, 1, step(share))
end
local function angles(d)
  local squared = lapwing.dot(d, d)
  local c = d / lapwing.sqrt(squared)
  local across = c.x * c.x + c.y * c.y
  local sine = lapwing.sqrt(across)
  local series = 1 + across * (1 / 6 + across * (3 / 40 + across * (15 / 336)))
  local close = lapwing.where(c.z, lapwing.where(1e-4 - across, 1, -1), -1)
  local ratio = lapwing.where(close, series, lapwing.atan2(sine, c.z) / sine)
  return near_fade(squared) * ratio * lapwing.vector(c.x, c.y)
end
)";

TEST_F(TermTest, TermsOfMotionAgree) {
  expect_same(R"(p:add_cost { type = "flight_time", name = "t", weight = 3 })",
              R"(p:add_cost { name = "t", weight = 3, window = 2,
                              residual = function() return 1 end })");
  expect_same(R"(p:add_cost { type = "input_effort", name = "t", weight = 2 })",
              R"(local m = v.mass * 9.80665
                 p:add_cost { name = "t", weight = 2, residual = function(s)
                   return s.force / m - { 0, 0, 1 }, s.yaw_torque / p_torque
                 end })");
  for (const int order : {1, 2, 3, 4})
    expect_same("p:add_cost { type = 'derivative', name = 't', block = 'position', order = " +
                    std::to_string(order) + " }",
                "local order = " + std::to_string(order) + R"(
                 p:add_cost { name = "t", residual = function(s)
                   local row = { s.position }
                   for i = 1, order do row[i + 1] = s[i].position end
                   for _ = 1, order do
                     for i = 1, #row - 1 do row[i] = (row[i + 1] - row[i]) / s.step end
                     row[#row] = nil
                   end
                   return row[1]
                 end })");
  expect_same(R"(p:add_cost { type = "keyframe", name = "t", weight = 4, block = "yaw",
                              keyframes = { { time = 0.33, value = {0.5} },
                                            { time = 1, value = {0.5} } } })",
              R"(p:add_cost { name = "t", weight = 4, times = { 0.33, 1 },
                              residual = function(s) return s.yaw - 0.5 end })");
}

TEST_F(TermTest, TermsOfTheCameraAgree) {
  const std::string parts = kCameraParts;
  expect_same(R"(p:add_cost { type = "camera_angle", name = "t", weight = 10,
                              except = { { start = 0.5, finish = 0.8 } } })",
              parts + R"(
                 p:add_cost { name = "t", weight = 10, smoothing = 0,
                              except = { { start = 0.5, finish = 0.8 } }, residual = function(s)
                   return angles(in_camera(s.yaw + s.gimbal_yaw, s.gimbal_pitch,
                                           s.target - s.position))
                 end })");
  expect_same(R"(p:add_cost { type = "skewness", name = "t", height = 4 })", parts + R"(
                 p:add_cost { name = "t", smoothing = 0, residual = function(s)
                   local d = s.target - s.position
                   local squared = lapwing.dot(d, d)
                   return near_fade(squared) * 4 * d.z / (squared + 2 * lapwing.abs(d.z))
                 end })");
  expect_same(R"(p:add_cost { type = "framing", name = "t", subject = "walker", horizontal = 0.3,
                              vertical = 0.6, size = 0.4, size_weight = 2 })",
              parts + R"(
                 local c = p_camera
                 local f = lapwing.normalize { (0.3 * c.width - 0.5 - c.principal_x) / c.focal_x,
                   (0.6 * c.height - 0.5 - c.principal_y) / c.focal_y, 1 }
                 local right = lapwing.normalize(lapwing.cross({ 0, 1, 0 }, f))
                 local down = lapwing.cross(f, right)
                 local distance = 1.8 * c.focal_y / (0.4 * c.height)
                 p:add_cost { name = "t", smoothing = 0, residual = function(s)
                   local away = s:subject("walker") - s.position
                   local seen = in_camera(s.yaw + s.gimbal_yaw, s.gimbal_pitch, away)
                   local turned = lapwing.vector(lapwing.dot(right, seen), lapwing.dot(down, seen),
                                                 lapwing.dot(f, seen))
                   local squared = lapwing.dot(away, away)
                   return angles(turned),
                          math.sqrt(2) * (0.5 * lapwing.log(squared) - math.log(distance))
                 end })");
}

TEST_F(TermTest, OcclusionAgrees) {
  expect_same(R"(p:add_cost { type = "occlusion", name = "t", weight = 10 })",
              std::string(kCameraParts) + R"(
    local NODES = { -0.9491079123427585, -0.7415311855993945, -0.4058451513773972, 0.0,
                    0.4058451513773972, 0.7415311855993945, 0.9491079123427585 }
    local WEIGHTS = { 0.1294849661688697, 0.2797053914892766, 0.3818300505051189,
                      0.4179591836734694, 0.3818300505051189, 0.2797053914892766,
                      0.1294849661688697 }
    local margin = 0.5
    local function haze(q, round)
      local thickness = 1 - lapwing.dot(q, q)
      if not round then thickness = (1 - q.x ^ 2) * (1 - q.y ^ 2) * (1 - q.z ^ 2) end
      return thickness ^ 2 * (1 + lapwing.dot({ 0.08, 0.06, -0.17 }, q))
    end
    local function ball(start, along)
      local a, b = lapwing.dot(along, along), lapwing.dot(start, along)
      local rest = b * b - a * (lapwing.dot(start, start) - 1)
      local root = lapwing.sqrt(lapwing.where(rest, rest, 1))
      local first, last = lapwing.max(0, (-b - root) / a), lapwing.min(1, (root - b) / a)
      return first, last, lapwing.where(rest, last - first, -1)
    end
    local function cube(start, along)
      local first, last = 0, 1
      for i = 1, 3 do
        local one, other = (1 - start[i]) / along[i], (-1 - start[i]) / along[i]
        first = lapwing.max(first, lapwing.min(one, other))
        last = lapwing.min(last, lapwing.max(one, other))
      end
      return first, last, last - first
    end
    local function clear_of(o, target)
      local squared = 0
      if o.round then
        local outside = lapwing.norm(target - o.center) - o.half[1]
        squared = lapwing.where(outside, outside ^ 2, 0)
      else
        for i = 1, 3 do
          local outside = lapwing.abs(target[i] - o.center[i]) - o.half[i]
          squared = squared + lapwing.where(outside, outside ^ 2, 0)
        end
      end
      local share = squared / margin ^ 2
      return lapwing.where(share - 1, 1, step(share))
    end
    local function hidden(o, from, to)
      local way = to - from
      local length = lapwing.dot(way, way)
      local start, along = {}, {}
      for i = 1, 3 do
        start[i] = (from[i] - o.center[i]) / (o.half[i] + margin)
        along[i] = way[i] / (o.half[i] + margin)
      end
      start, along = lapwing.vector(start), lapwing.vector(along)
      local first, last, through = (o.round and ball or cube)(start, along)
      local half_way, sum = 0.5 * (last - first), 0
      for g = 1, 7 do
        local share = 0.5 * (first + last) + NODES[g] * half_way
        sum = sum + WEIGHTS[g] * haze(start + share * along, o.round)
      end
      local unit = math.min(table.unpack(o.half)) + margin
      return lapwing.where(through, near_fade(length) * clear_of(o, to) * sum * half_way
                                    * lapwing.sqrt(length) / unit, 0)
    end
    local obstacles = { { center = { 4, 0.2, 3 }, half = { 1.5, 1.5, 1.5 }, round = true },
                        { center = { 1, 1.5, 1.5 }, half = { 1, 0.5, 1.5 } } }
    p:add_cost { name = "t", weight = 10, smoothing = 0, residual = function(s)
      return hidden(obstacles[1], s.position, s.target), hidden(obstacles[2], s.position, s.target)
    end })");
}

TEST_F(TermTest, ConstraintsAgree) {
  const std::string reach = R"(
    local function asked(s, kept, speed)
      local v = s.velocity
      local half = s.step * (0.5 * lapwing.sqrt(lapwing.dot(v, v) + 1e-4) + 0.5 * speed
                             + 0.25 * p_acceleration * s.step)
      local bulge = s.step * (0.125 * p_acceleration * s.step + 0.5 * speed)
      return lapwing.sqrt((kept + bulge) ^ 2 + half ^ 2)
    end
  )";
  more_ = kRockAlone;
  expect_same(R"(p:add_constraint { type = "obstacle", name = "t" })", reach + R"(
    p:add_constraint { name = "t", lower = 0, value = function(s)
      return lapwing.norm(s.position - { 4, 0.2, 3 }) - asked(s, 1.5 + 0.25, 0)
    end })");
  more_ = "";
  expect_same(R"(p:add_constraint { type = "subject_distance", name = "t", subject = "walker",
                                    distance = 2 })",
              reach + R"(
    p:add_constraint { name = "t", lower = 0, value = function(s)
      return lapwing.norm(s.position - s:subject("walker")) - asked(s, 2, math.sqrt(0.5))
    end })");
  expect_same(R"(p:add_constraint { type = "hard_keyframe", name = "t", tolerance = 0.25,
                                    block = "yaw", keyframes = { { time = 0.73, value = {2} } } })",
              R"(p:add_constraint { name = "t", times = { 0.73 }, lower = 1.75, upper = 2.25,
                                    value = function(s) return s.yaw end })",
              /*as_bounds=*/true);
}

// A free step: the derivative of a term by the step, and its weight by it.
TEST_F(TermTest, TermsAgreeWhereTheStepIsFree) {
  more_ = "step_mode = 'free',";
  expect_same("p:add_cost { type = 'derivative', name = 't', order = 2 }",
              R"(p:add_cost { name = "t", residual = function(s)
                   return (s[2].position - 2 * s[1].position + s.position) / s.step ^ 2
                 end })");
}

// ---- what only a term of one's own does ---------------------------------------------------------

TEST_F(TermTest, ParametersChangeBetweenSolves) {
  const char* kTerm = R"(
    p:add_cost { name = "stay", parameters = { height = 3, side = { 1, 2 } }, integral = false,
                 residual = function(s, q)
      return s.position.z * q.height - q.side[1], s.position.x - q.side[2]
    end }
    after = function() p:set_parameter { term = "stay", name = "height", value = 5 } end)";
  const auto problem = stated(kTerm);
  const Stages at = problem->initial_guess();
  double expected = 0;
  const int place = problem->layout().offset(problem->layout().index("position"));
  for (Eigen::Index i = 0; i < at.cols(); ++i)
    expected += std::pow(5 * at(place + 2, i) - 1, 2) + std::pow(at(place, i) - 2, 2);
  EXPECT_NEAR(problem->cost(at), expected, 1e-9 * expected);
  EXPECT_FALSE(problem->quadratic());  // height changes a slope
  refuses(std::string(kTerm) +
              " after = function() p:set_parameter { term = 'stya', name = "
              "'height', value = 5 } end",
          "no term 'stya' of the script; there is 'stay'");
  refuses(std::string(kTerm) +
              " after = function() p:set_parameter { term = 'stay', name = "
              "'side', value = 5 } end",
          "'side' has 2 numbers, got 1");
}

TEST_F(TermTest, DistancesToTheEnvironmentAreThere) {
  const auto problem = stated(R"(
    p:add_cost { name = "far", residual = function(s)
      return 1 / (1 + s:distance(s.position) ^ 2), s:distance(s.position + s.velocity, "hut")
    end })");
  expect_term_derivatives(*problem);
}

TEST_F(TermTest, EveryFunctionHasItsDerivatives) {
  expect_term_derivatives(*stated(R"(
    p:add_cost { name = "all", smoothing = 0.05, residual = function(s)
      local v, d = s.velocity, s.target - s.position
      return lapwing.max(s.position.z - 2, v.x, 0.1), lapwing.min(v.y, v.z, s.yaw),
             lapwing.abs(d.x), lapwing.norm(v), lapwing.normalize(d),
             lapwing.cross(v, d), lapwing.tan(0.1 * s.yaw), lapwing.exp(0.2 * v.x),
             lapwing.log(3 + s.yaw), lapwing.where(v.x, v.x ^ 3, v.x ^ 4), (2 + s.yaw) ^ 1.5,
             (2 + s.yaw) ^ -1, 2 ^ v.y, (2 + s.yaw) ^ v.y, s[1].yaw * s.yaw, -d, #d,
             lapwing.atan2(d.y, d.x), s.time * v.x
    end })"));
}

TEST_F(TermTest, AConstraintOfOnesOwnHolds) {
  const auto problem = stated(R"(
    p:add_constraint { name = "cone", upper = 0, value = function(s)
      return lapwing.norm(s.position) - 2 * s.position.z
    end })");
  EXPECT_EQ(problem->rows() - problem->dynamics_rows(), problem->horizon().stages);
  EXPECT_NE(problem->row_name(problem->rows() - 1).find("cone at 1 s"), std::string::npos);
}

// What the guides show is right.
TEST_F(TermTest, SnippetsOfTheGuidesAreRight) {
  const auto terms = snippets_of(LAPWING_SOURCE_DIR "/framework/mission/README.md", "## Terms of");
  ASSERT_EQ(terms.size(), 1u);
  EXPECT_EQ(stated(terms[0].text)->quadratic(), false);
  const auto films = snippets_of(LAPWING_SOURCE_DIR "/scripts/mission/README.md", "## film");
  ASSERT_EQ(films.size(), 2u);
  const auto mission = load(film(films[1].text));
  mission->configure({}, {});
  EXPECT_EQ(mission->plan().report.status, SolveStatus::optimal);
}

}  // namespace
}  // namespace lapwing
