// SPDX-License-Identifier: Apache-2.0
// Keeps the path of each span of time inside a convex region: a box, cut by half spaces where
// given.
//
// Two stages in one region have their chord in it; the path leaves the chord by a h^2/8 at most,
// which every face gives way for (problem/path_clearance.h). A step between two stages belongs to
// the regions that hold its middle, so that where one span ends and the next begins the stage lies
// in both.
//
//   p:add_constraint { type = "corridor", regions = {
//     { start = 0, finish = 2.5, lower = {0, 0, 1}, size = {4, 3, 5} } } }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/path_clearance.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// normal . p <= offset, the normal a unit vector.
struct Face {
  Eigen::Vector3d normal;
  double offset;
};

struct Region {
  double start = 0, finish = 0;  // s
  std::vector<Face> faces;       // the first six are the box's
};

Region region_of(const Parameters& given) {
  Region region{given.number("start"), given.number("finish"), {}};
  if (region.finish < region.start)
    throw InputError(given.origin("finish"), "a region ends before it begins");
  const Eigen::Vector3d lower(given.numbers("lower").data()), size(given.numbers("size").data());
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
    region.faces.push_back({-axis, -lower(i)});
    region.faces.push_back({axis, lower(i) + size(i)});
  }
  for (const Parameters& half : given.tables("half_spaces")) {
    const Eigen::Vector3d normal(half.numbers("normal").data());
    if (!(normal.norm() > 1e-9))
      throw InputError(half.origin("normal"), "the normal of a half space has no length");
    region.faces.push_back({normal.normalized(), half.number("offset") / normal.norm()});
  }
  return region;
}

class Corridor final : public DifferentiableConstraint<Corridor, 4> {
 public:
  static constexpr PluginText kText{"corridor", "1.0.0",
                                    "the path stays in a convex region in each span of time",
                                    "thesis 6.1, global before local"};
  static ParameterTable parameters() {
    const Range far = between(-1e6, 1e6);
    ParameterTable half;
    half.required_numbers("normal", 3, "", "outward normal", far)
        .required_number("offset", "m", "normal . p <= offset");
    ParameterTable region;
    region.required_number("start", "s", "start of the span", at_least(0))
        .required_number("finish", "s", "end of the span", at_least(0))
        .required_numbers("lower", 3, "m", "lower corner of the box, world", far)
        .required_numbers("size", 3, "m", "edge lengths of the box", {0, 2e6, true})
        .tables("half_spaces", half, "half spaces that cut the box");
    return ParameterTable{}.tables("regions", region, "regions, in any order", true);
  }
  explicit Corridor(const Parameters& parameters) {
    for (const Parameters& given : parameters.tables("regions"))
      regions_.push_back(region_of(given));
  }

  FunctionShape declare(const ProblemSetting& setting) {
    acceleration_ = largest_acceleration(setting.vehicle);
    const Horizon& horizon = setting.horizon;
    stages_.clear();
    faces_.clear();
    std::size_t most = 0;
    for (int stage = 0; stage < horizon.stages; ++stage) {
      std::vector<Face> faces = faces_at(stage, horizon);
      if (faces.empty()) continue;
      check_box(faces, horizon.time(stage), horizon.step_after(stage));
      most = std::max(most, faces.size());
      stages_.push_back(stage);
      faces_.push_back(std::move(faces));
    }
    FunctionShape shape{
        .rows = static_cast<int>(most), .stages = stages_, .affine = !horizon.step_free};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add<3>("position"), reads.add("step")};
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const auto p = stage(in_.position);
    const T bulge = (0.125 * acceleration_) * stage(in_.step) * stage(in_.step);
    const std::vector<Face>& faces = faces_[static_cast<std::size_t>(stage.instance())];
    for (std::size_t k = 0; k < faces.size(); ++k) {
      const Eigen::Vector3d& n = faces[k].normal;
      rows[static_cast<int>(k)] = n.x() * p[0] + n.y() * p[1] + n.z() * p[2] + bulge;
    }
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    if (faces_.empty()) return;
    std::size_t rows = 0;
    for (const auto& faces : faces_) rows = std::max(rows, faces.size());
    std::fill_n(lower, range.count * rows, -kInfinity);
    std::fill_n(upper, range.count * rows, kInfinity);
    for (int i = 0; i < range.count; ++i) {
      const auto& faces = faces_[static_cast<std::size_t>(range.first + i)];
      for (std::size_t k = 0; k < faces.size(); ++k)
        upper[static_cast<std::size_t>(i) * rows + k] = faces[k].offset;
    }
  }

 private:
  // Those of the steps on both sides, the tightest of each direction.
  std::vector<Face> faces_at(int stage, const Horizon& horizon) const {
    std::vector<Face> faces;
    const auto add = [&](const Face& face) {
      for (Face& other : faces)
        if (other.normal == face.normal) {
          other.offset = std::min(other.offset, face.offset);
          return;
        }
      faces.push_back(face);
    };
    const double here = horizon.time(stage);
    const double before = horizon.time(std::max(stage - 1, 0));
    const double after = horizon.time(std::min(stage + 1, horizon.stages - 1));
    for (const double time : {(before + here) / 2, (here + after) / 2}) {
      for (const Region& region : regions_)
        if (region.start <= time && time <= region.finish)
          for (const Face& face : region.faces) add(face);
    }
    return faces;
  }

  void check_box(const std::vector<Face>& faces, double time, double step) const {
    const double bulge = acceleration_ * step * step / 8;
    for (const Face& a : faces)
      for (const Face& b : faces) {
        if (a.normal != -b.normal || a.offset + b.offset >= 2 * bulge) continue;
        char text[120];
        std::snprintf(text, sizeof text,
                      "corridor: the regions at %.4g s have no common point; they must overlap",
                      time);
        throw InputError(text);
      }
  }

  struct {
    VectorHandle position;
    NumberHandle step;
  } in_;
  std::vector<Region> regions_;
  std::vector<int> stages_;
  std::vector<std::vector<Face>> faces_;  // of each stage in stages_
  double acceleration_ = 0;               // m/s^2
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Corridor)
