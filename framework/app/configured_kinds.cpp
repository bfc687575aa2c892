// SPDX-License-Identifier: Apache-2.0
// Races, scans and light paintings against their configurations.
#include "framework/app/configured_task.h"
#include "framework/app/stated_values.h"
#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"

namespace lapwing {
namespace {

constexpr double kSame = 1e-9;          // m, and of unit vectors
constexpr double kBudgetSpeed = 3;      // m/s, of a budget in metres
constexpr double kScanBudget = 300;     // s, where none is stated
constexpr double kDrawingShare = 0.01;  // of the height, that drawings may miss by

void compare_closed_loop(const Plan& plan, ConfigurationComparison& found) {
  if (stated_text(plan.configuration, "closed_loop") == "required" &&
      !plan.task.closed_loop_required)
    found.faults.push_back(
        "the closed loop is reported only in the plan and required in its configuration");
}

bool near(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).norm() < kSame;
}

// What of a gate is not as the configuration states it; empty where it is.
std::string gate_difference(const Value& asked, const GateTask& here) {
  const auto size = [&](const char* key) { return stated_number(asked, key).value_or(0); };
  const auto position = stated_numbers(asked, "position");
  if (position && !same_vector(*position, here.position)) return "elsewhere";
  std::vector<Eigen::Vector2d> corners;
  try {
    corners = gate_corners(
        {stated_text(asked, "shape"), size("width"), size("height"), size("radius"), size("side")});
  } catch (const InputError&) {
    return "of another shape";
  }
  if (corners.size() != here.corners.size()) return "of another shape";
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (!near(corners[i], here.corners[i])) return "of another size";
  if (here.ball()) return same_number(here.radius, size("radius")) ? "" : "of another radius";
  if (!same_number(here.tunnel_length, size("tunnel_length"))) return "of another tunnel";
  // Plans made before 0.2.0 state these angles, in degrees too, without the unit in the name.
  const auto angle = [&](const std::string& key) {
    const auto stated = stated_number(asked, (key + "_deg").c_str());
    return radians(stated ? *stated : size(key.c_str()));
  };
  const double yaw = angle("normal_yaw"), pitch = angle("normal_pitch");
  const Eigen::Vector3d direction(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch),
                                  std::sin(pitch));
  GateTask turned;
  set_direction(turned, direction, Eigen::Vector3d::UnitZ());
  return near(turned.direction, here.direction) && near(turned.up, here.up) ? ""
                                                                            : "turned another way";
}

// The gates of one lap as tables of the form of `gates`.
Value::List gates_of_a_lap(const Value& asked) {
  Value::List gates = stated_tables(asked, "gates");
  for (const Value& keyframe : stated_tables(asked, "keyframes")) {
    Value ball = Value::map();
    ball.set("shape", "ball");
    if (const Value* position = keyframe.find("position")) ball.set("position", *position);
    if (const Value* radius = asked.find("tolerance")) ball.set("radius", *radius);
    gates.push_back(ball);
  }
  return gates;
}

void compare_gates(const Plan& plan, ConfigurationComparison& found) {
  const Value& asked = plan.configuration;
  const Value::List lap = gates_of_a_lap(asked);
  Value::List all;
  const auto laps =
      static_cast<std::size_t>(std::clamp(stated_number(asked, "laps").value_or(1), 1.0, 1e4));
  if (lap.size() * laps > 1'000'000) return found.faults.push_back("the laps cannot be counted");
  for (std::size_t i = 0; i < laps; ++i) all.insert(all.end(), lap.begin(), lap.end());
  // A closed course begins in its first gate, which ends it.
  if (stated_flag(asked, "closed") && !all.empty())
    std::rotate(all.begin(), all.begin() + 1, all.end());
  const std::vector<GateTask>& here = plan.task.gates;
  if (here.size() != all.size())
    return found.faults.push_back("there are " + std::to_string(here.size()) +
                                  " gates in the plan and " + std::to_string(all.size()) +
                                  " in its configuration");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string difference = gate_difference(all[i], here[i]);
    if (!difference.empty())
      found.faults.push_back("gate " + std::to_string(i + 1) + " ('" + here[i].name + "') is " +
                             difference + " in the plan than in its configuration");
  }
}

// Nothing where the drawing's height is not stated either.
std::optional<double> drawing_tolerance(const Value& asked) {
  if (const auto stated = stated_number(asked, "tolerance")) return stated;
  const auto height = stated_number(asked, "height");
  return height ? std::optional(kDrawingShare * *height) : std::nullopt;
}

void compare_budget(const Plan& plan, std::optional<double> asked, ConfigurationComparison& found) {
  if (asked && !plan.budget)
    found.faults.push_back(otherwise("the budget", "not stated", plain_number(*asked) + " s"));
  else if (plan.budget)
    compare_number("the budget", *plan.budget, asked, " s", Than::above, found);
}

void compare_region(const Value& asked, const ScanTask& scan, ConfigurationComparison& found) {
  if (!stated_tables(asked, "regions").empty()) return;  // compare_flight_rules has them
  const Value* region = asked.find("region");
  const auto lower = region ? stated_numbers(*region, "lower") : std::nullopt;
  const auto upper = region ? stated_numbers(*region, "upper") : std::nullopt;
  if (!lower || !upper)
    return found.not_compared.push_back("the region of interest: none is stated");
  if (!same_vector(*lower, Eigen::Vector3d(scan.region.bounds().min())) ||
      !same_vector(*upper, Eigen::Vector3d(scan.region.bounds().max())))
    found.faults.push_back(
        "the region of interest is another in the plan than in its "
        "configuration");
}

void compare_camera(const Value& asked, const Pinhole& camera, ConfigurationComparison& found) {
  const Value* stated = asked.find("camera");
  if (!stated || !stated->is_map()) return;
  const auto compare = [&](const char* what, double here, const char* key) {
    compare_number(std::string("the camera's ") + what, here, stated_number(*stated, key), " px",
                   Than::other, found);
  };
  compare("width", camera.width, "width");
  compare("height", camera.height, "height");
  compare("focal length", camera.focal_x, "focal");
  compare("focal length across", camera.focal_y, "focal");
}

}  // namespace

void compare_race(const Plan& plan, ConfigurationComparison& found) {
  const Value& asked = plan.configuration;
  const Value* free_form = asked.find("free_form");
  if (!stated_text(asked, "input").empty())
    found.not_compared.push_back("gates of the file '" + stated_text(asked, "input") + "'");
  else if (free_form && stated_number(*free_form, "length"))
    found.not_compared.push_back("gates of a random course");
  else
    compare_gates(plan, found);
  const auto floor = stated_number(asked, "floor");
  const std::vector<Obstacle>& zones = plan.environment.obstacles;
  if (floor && std::none_of(zones.begin(), zones.end(), [&](const Obstacle& zone) {
        const Value* ceiling = zone.parameters.find("ceiling");
        return zone.type == "prism" && ceiling && same_number(ceiling->as_number(), *floor);
      }))
    found.faults.push_back("the floor of its configuration, " + plain_number(*floor) +
                           " m, is not in the plan");
  compare_budget(plan, stated_number(asked, "time"), found);
  compare_closed_loop(plan, found);
  found.not_compared.push_back("where the race begins and ends, and the reach of its floor");
}

void compare_scan(const Plan& plan, ConfigurationComparison& found) {
  const Value& asked = plan.configuration;
  if (!plan.task.scan) return found.faults.push_back("the plan has no region to scan");
  const ScanTask& scan = *plan.task.scan;
  const ScanTask usual;
  compare_region(asked, scan, found);
  compare_camera(asked, scan.camera, found);
  compare_flight_rules(plan, found);
  const auto margin = stated_number(asked, "margin");
  compare_number("the margin", plan.environment.margin,
                 margin ? std::optional(*margin + stated_number(asked, "gps_accuracy").value_or(0))
                        : std::nullopt,
                 " m", Than::below, found);
  compare_number("the range", scan.range, stated_number(asked, "range"), " m", Than::other, found);
  const Value* tour = asked.find("tour");
  if (tour && tour->is_map()) {
    const auto metres = stated_number(*tour, "budget_metres");
    compare_budget(
        plan,
        metres ? *metres / kBudgetSpeed : stated_number(*tour, "budget").value_or(kScanBudget),
        found);
  }
  compare_number("the share that must be seen again", scan.seen_share, usual.seen_share, "",
                 Than::below, found);
  compare_number("the tolerance of views", scan.tolerance, usual.tolerance, " m", Than::above,
                 found);
  compare_number("the tolerance of directions of view", scan.angle_tolerance, usual.angle_tolerance,
                 " rad", Than::above, found);
  compare_closed_loop(plan, found);
  found.not_compared.push_back(
      "the map and the mesh of the tour, its views and how many "
      "voxels they see: they result from the first flight");
}

void compare_light_painting(const Plan& plan, ConfigurationComparison& found) {
  const Value& asked = plan.configuration;
  compare_number("the tolerance of the drawing", plan.task.drawing_tolerance,
                 drawing_tolerance(asked), " m", Than::above, found);
  if (const auto yaw = stated_number(asked, "view_yaw_deg")) {
    const double angle = radians(*yaw);
    if (!near(plan.task.drawing_view, Eigen::Vector3d(std::cos(angle), std::sin(angle), 0)))
      found.faults.push_back("spectators look another way in the plan than in its configuration");
  }
  if (plan.task.strokes.empty()) found.faults.push_back("the plan has nothing to draw");
  if (!plan.task.closed_loop_required)
    found.faults.push_back(
        "the closed loop is reported only in the plan, and required of light "
        "paintings");
  found.not_compared.push_back(
      "the strokes: they result from a text, a picture or a list of points");
}

}  // namespace lapwing
