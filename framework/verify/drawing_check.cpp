// SPDX-License-Identifier: Apache-2.0
// How far the light is from the drawing, and the drawing from the light.
//
// Means over length: of every span of light to the nearest stroke, and of every stroke to the
// nearest lit path. The worst counts, so that no stroke is left out and no light drawn beside them.
// Once as planned, once as flown under control.
#include "framework/trajectory/polyline.h"
#include "framework/verify/checks.h"

namespace lapwing {
namespace {

constexpr double kSpacing = 0.01;  // m, between the places at which distances are taken

// The parts of the integrated path with the light on, cut at both ends of every span.
std::vector<Points> lit_paths(const Flight& flight) {
  const auto& lights = flight.plan.lights;
  std::vector<Points> lit(lights.size());
  Motion& motion = flight.motion;
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const auto points = motion.integrate(i);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const MotionPoint &a = points[k - 1], &b = points[k];
      const double h = b.time - a.time;
      for (std::size_t s = 0; s < lights.size(); ++s) {
        const double from = std::max(a.time, lights[s].start),
                     to = std::min(b.time, lights[s].finish);
        if (from > to || !(h > 0)) continue;
        const auto at = [&](double t) -> Eigen::Vector3d {
          return a.position + (t - a.time) / h * (b.position - a.position);
        };
        if (lit[s].empty()) lit[s].push_back(at(from));
        lit[s].push_back(at(to));
      }
    }
  }
  std::erase_if(lit, [](const Points& path) { return path.empty(); });
  return lit;
}

// Means over length, the largest of all parts and which it is.
struct WorstPart {
  double mean = 0;
  std::size_t part = 0;
};

WorstPart worst_mean(const std::vector<Points>& parts, const std::vector<Points>& to) {
  WorstPart worst;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Points places = resampled(parts[i], kSpacing);
    double sum = 0;
    for (const Eigen::Vector3d& p : places) sum += distance_to(to, p);
    const double mean = sum / static_cast<double>(places.size());
    if (!(mean <= worst.mean)) worst = {mean, i};
  }
  return worst;
}

// The worse of the light against the strokes and the strokes against the light.
Check drawn(const char* name, const std::vector<Points>& lit, const Task& task) {
  const WorstPart light = worst_mean(lit, task.strokes), stroke = worst_mean(task.strokes, lit);
  const bool by_light = light.mean >= stroke.mean;
  Check check =
      judged(make_check(name), std::max(light.mean, stroke.mean), task.drawing_tolerance, 0, 0);
  if (!check.detail.empty()) check.detail += "; ";
  check.detail += by_light ? "light " + std::to_string(light.part + 1) + " from the strokes"
                           : "stroke " + std::to_string(stroke.part + 1) + " from the light";
  return check;
}

std::vector<Points> lit_paths(const Plan& plan, const FlownPath& flown) {
  std::vector<Points> lit;
  for (const TimeSpan& light : plan.lights) {
    Points path;
    for (const FlownSample& sample : flown.samples)
      if (light.start <= sample.time && sample.time <= light.finish)
        path.push_back(sample.state.position);
    if (!path.empty()) lit.push_back(std::move(path));
  }
  return lit;
}

}  // namespace

void check_drawing(const Flight& flight, const std::optional<FlownPath>& flown,
                   Certificate& certificate) {
  auto& checks = certificate.checks;
  if (flight.plan.task.strokes.empty()) {
    for (const char* name : {"drawing", "drawing_flown"})
      checks.push_back(skipped_check(name, "the task has no stroke"));
    return;
  }
  checks.push_back(drawn("drawing", lit_paths(flight), flight.plan.task));
  checks.push_back(flown ? drawn("drawing_flown", lit_paths(flight.plan, *flown), flight.plan.task)
                         : skipped_check("drawing_flown", "the plan is not simulated"));
}

}  // namespace lapwing
