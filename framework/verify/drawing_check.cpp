// How far the light is from the drawing, and the drawing from the light.
//
// Means over length: of the lit path to the nearest stroke, and of the strokes to the nearest lit
// path. The worse counts, so that a light that is never on draws nothing. Light is on in the spans
// that the plan states.
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

double mean_distance(const std::vector<Points>& from, const std::vector<Points>& to) {
  double sum = 0, lengths = 0;
  for (const Points& path : from) {
    const double length = length_of(path);
    if (!(length > 0)) continue;
    const Points places = resampled(path, kSpacing);
    double part = 0;
    for (const Eigen::Vector3d& p : places) part += distance_to(to, p);
    sum += length * part / static_cast<double>(places.size());
    lengths += length;
  }
  return lengths > 0 ? sum / lengths : std::numeric_limits<double>::infinity();
}

}  // namespace

void check_drawing(const Flight& flight, Certificate& certificate) {
  const auto& strokes = flight.plan.task.strokes;
  if (strokes.empty()) {
    certificate.checks.push_back(skipped_check("drawing", "the task has no stroke"));
    return;
  }
  const std::vector<Points> lit = lit_paths(flight);
  const double light = mean_distance(lit, strokes), drawing = mean_distance(strokes, lit);
  Check check = judged(make_check("drawing"), std::max(light, drawing),
                       flight.plan.task.drawing_tolerance, 0, 0);
  if (!check.detail.empty()) check.detail += "; ";
  check.detail += light >= drawing ? "mean from the light to the strokes"
                                   : "mean from the strokes to the light";
  certificate.checks.push_back(check);
}

}  // namespace lapwing
