// Keeps the path outside every zone of the environment, grown by the margin, along the whole path
// and not at the stages alone (problem/path_clearance.h). A zone is a prism over a polygon of any
// shape, between a floor and a ceiling, of which each may be missing.
//
//   d(p_i) - sqrt((margin + a h^2/8)^2 + L_i^2/4) >= 0,   L_i = |v_i| h + a h^2/2
//
// d: the distance from the prism; inside, minus that from the nearest of its faces.
//
//   p:add_constraint { type = "no_fly_zone" }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/path_clearance.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A polygon whose edges know their way out.
class Polygon {
 public:
  explicit Polygon(std::vector<Eigen::Vector2d> corners) {
    double twice_area = 0;
    for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
      twice_area += corners[j].x() * corners[i].y() - corners[i].x() * corners[j].y();
      if (corners[i] != corners[j]) corners_.push_back(corners[i]);
    }
    if (twice_area < 0) std::reverse(corners_.begin(), corners_.end());
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Eigen::Vector2d edge = corners_[next(i)] - corners_[i];
      outward_.emplace_back(Eigen::Vector2d(edge.y(), -edge.x()).normalized());
    }
  }

  // Signed distance, negative inside: the nearest edge or corner is found by value.
  template <class T>
  T distance(const T& x, const T& y) const {
    using std::sqrt;
    constexpr double kCorner = 1e-6;  // m
    const Eigen::Vector2d p(value_of(x), value_of(y));
    const Nearest nearest = nearest_part(p);
    const Eigen::Vector2d& corner = corners_[nearest.corner];
    const T dx = x - corner.x(), dy = y - corner.y();
    if (nearest.on_edge) {
      const Eigen::Vector2d& out = outward_[nearest.corner];
      return out.x() * dx + out.y() * dy;
    }
    if (nearest.distance < kCorner) {  // on the corner itself: out between its edges
      const Eigen::Vector2d out = way_out(nearest.corner);
      return out.x() * dx + out.y() * dy;
    }
    const T away = sqrt(dx * dx + dy * dy);
    return nearest.inside ? -away : away;
  }

 private:
  struct Nearest {
    std::size_t corner = 0;  // or the one where the edge begins
    bool on_edge = false, inside = false;
    double distance = kInfinity;
  };

  std::size_t next(std::size_t i) const { return i + 1 < corners_.size() ? i + 1 : 0; }

  Nearest nearest_part(const Eigen::Vector2d& p) const {
    Nearest nearest;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Eigen::Vector2d &a = corners_[i], &b = corners_[next(i)];
      const Eigen::Vector2d edge = b - a;
      const double share = std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      const double distance = (p - a - share * edge).norm();
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < a.x() + (p.y() - a.y()) / edge.y() * edge.x())
        nearest.inside = !nearest.inside;
      if (distance >= nearest.distance) continue;
      nearest.distance = distance;
      nearest.on_edge = share > 0 && share < 1;
      nearest.corner = share < 1 ? i : next(i);
    }
    return nearest;
  }

  Eigen::Vector2d way_out(std::size_t corner) const {
    const Eigen::Vector2d& before = outward_[corner > 0 ? corner - 1 : corners_.size() - 1];
    const Eigen::Vector2d sum = before + outward_[corner];
    return sum.norm() > 1e-3 ? sum.normalized() : before;  // a spike of no width
  }

  std::vector<Eigen::Vector2d> corners_;  // counter-clockwise
  std::vector<Eigen::Vector2d> outward_;  // of the edge from each corner to the next
};

class NoFlyZone final : public DifferentiableConstraint<NoFlyZone, 7> {
 public:
  static constexpr PluginText kText{"no_fly_zone", "1.0.0",
                                    "the path keeps out of the environment's zones", ""};
  static ParameterTable parameters() { return {}; }
  explicit NoFlyZone(const Parameters&) {}

  FunctionShape declare(const ProblemSetting& setting) {
    margin_ = setting.environment.margin;
    clearance_ = PathClearance(setting.vehicle);
    prisms_.clear();
    FunctionShape shape{.blocks = setting.layout.indices({"position", "velocity", "step"})};
    for (const Zone& zone : setting.environment.zones) {
      if (zone.corners.size() < 3)
        throw InputError("zone '" + zone.name + "' has fewer than three corners");
      prisms_.push_back({Polygon(zone.corners), zone.floor, zone.ceiling});
      shape.row_names.push_back(zone.name.empty() ? std::to_string(prisms_.size()) : zone.name);
    }
    shape.rows = static_cast<int>(prisms_.size());
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const T asked =
        clearance_.around<T>(stage.template vector<3>(1), stage.scalar(2)).asked(margin_);
    for (std::size_t k = 0; k < prisms_.size(); ++k)
      rows[static_cast<int>(k)] = distance(prisms_[k], stage.data(0)) - asked;
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, range.count * prisms_.size(), 0.0);
    std::fill_n(upper, range.count * prisms_.size(), kInfinity);
  }

 private:
  struct Prism {
    Polygon polygon;
    double floor, ceiling;  // m, perhaps infinite
  };

  template <class T>
  static T distance(const Prism& prism, const T* p) {
    using std::max, std::sqrt;
    const T across = prism.polygon.distance(p[0], p[1]);
    if (std::isinf(prism.floor) && std::isinf(prism.ceiling)) return across;
    T up;
    if (std::isinf(prism.ceiling))
      up = prism.floor - p[2];
    else if (std::isinf(prism.floor))
      up = p[2] - prism.ceiling;
    else
      up = max(p[2] - prism.ceiling, prism.floor - p[2]);
    if (value_of(across) > 0 && value_of(up) > 0) return sqrt(across * across + up * up);
    return max(up, across);
  }

  std::vector<Prism> prisms_;
  double margin_ = 0;
  PathClearance clearance_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::NoFlyZone)
