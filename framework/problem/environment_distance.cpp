// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/environment_distance.h"

#include "framework/core/parameters.h"
#include "framework/problem/zone_prism.h"

namespace lapwing {
namespace {

// A zone as a field that knows its own derivatives.
class ZoneField final : public DistanceField {
 public:
  explicit ZoneField(const Zone& zone) : prism_(zone) {}

  double distance(const Eigen::Vector3d& p_W, Eigen::Vector3d* gradient) const override {
    if (!gradient) return prism_.distance(p_W.data());
    using T = Dual<double, 3>;
    T p[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = T(p_W(i));
      p[i].d[i] = 1;
    }
    const T result = prism_.distance(p);
    for (int i = 0; i < 3; ++i) (*gradient)(i) = result.d[i];
    return result.v;
  }
  double reach() const override { return std::numeric_limits<double>::infinity(); }

 private:
  ZonePrism prism_;
};

class DistanceWriter {
 public:
  DistanceWriter(ExpressionGraph& graph, const int (&point)[3], double width)
      : graph_(graph), width_(width), point_{point[0], point[1], point[2]} {}

  int sphere(const Sphere& sphere) {
    int squares = graph_.constant(0);
    for (int i = 0; i < 3; ++i) {
      const int away = minus(point_[i], sphere.center(i));
      squares = graph_.apply(TapeOp::add, squares, graph_.apply(TapeOp::multiply, away, away));
    }
    return minus(norm(squares), sphere.radius);
  }

  // Outside by the parts beyond each pair of faces, inside by the nearest face.
  int box(const Box& box) {
    const int zero = graph_.constant(0);
    int squares = zero, nearest_face = -1;
    for (int i = 0; i < 3; ++i) {
      const int middle = minus(point_[i], 0.5 * (box.lower(i) + box.upper(i)));
      const int away = minus(graph_.apply(TapeOp::absolute, middle, -1, -1, width_),
                             0.5 * (box.upper(i) - box.lower(i)));
      // Past a face by value: its square has no kink there, so that nothing need be rounded.
      const int beyond = graph_.apply(TapeOp::maximum, away, zero);
      squares = graph_.apply(TapeOp::add, squares, graph_.apply(TapeOp::multiply, beyond, beyond));
      nearest_face =
          nearest_face < 0 ? away : graph_.apply(TapeOp::maximum, nearest_face, away, -1, width_);
    }
    const int outside = graph_.apply(TapeOp::norm, squares, -1, -1, 0.0);
    return graph_.apply(TapeOp::select, nearest_face, outside, nearest_face);
  }

  int field(std::shared_ptr<const DistanceField> field, FieldSource source) {
    const int index = graph_.add_field(std::move(field), std::move(source));
    return graph_.apply(TapeOp::distance, point_[0], point_[1], point_[2], 0, index);
  }

  int minimum(int a, int b) {
    if (a < 0) return b;
    const int lower = graph_.apply(TapeOp::maximum, graph_.apply(TapeOp::negate, a),
                                   graph_.apply(TapeOp::negate, b), -1, width_);
    return graph_.apply(TapeOp::negate, lower);
  }

 private:
  int minus(int a, double b) { return graph_.apply(TapeOp::subtract, a, graph_.constant(b)); }
  int norm(int squares) { return graph_.apply(TapeOp::norm, squares, -1, -1, width_); }

  ExpressionGraph& graph_;
  double width_;
  int point_[3];
};

}  // namespace

int nearest_distance(ExpressionGraph& graph, const Environment& environment,
                     const std::string& name, const int (&point)[3], double width) {
  DistanceWriter writer(graph, point, width);
  std::vector<std::string> known;
  int nearest = -1;
  const auto each = [&](const auto& obstacles, const auto& distance) {
    for (const auto& obstacle : obstacles) {
      known.push_back(obstacle.name);
      if (name.empty() || obstacle.name == name)
        nearest = writer.minimum(nearest, distance(obstacle));
    }
  };
  const auto read = [&](const auto& obstacle, const char* kind, const auto& list) {
    if (!obstacle.distance)
      throw InputError("'" + obstacle.name + "' has no distances: its file was not read");
    return writer.field(obstacle.distance, {kind, static_cast<int>(&obstacle - list.data())});
  };
  each(environment.spheres, [&](const Sphere& sphere) { return writer.sphere(sphere); });
  each(environment.boxes, [&](const Box& box) { return writer.box(box); });
  each(environment.zones, [&](const Zone& zone) {
    return writer.field(std::make_shared<ZoneField>(zone),
                        {"no_fly_zone", static_cast<int>(&zone - environment.zones.data())});
  });
  each(environment.meshes,
       [&](const MeshObstacle& mesh) { return read(mesh, "mesh", environment.meshes); });
  each(environment.maps,
       [&](const MapObstacle& map) { return read(map, "map", environment.maps); });
  if (nearest >= 0) return nearest;
  if (name.empty()) throw InputError("the environment has no obstacle to be distant from");
  std::string message = "no obstacle '" + name + "' in the environment";
  for (std::size_t k = 0; k < known.size(); ++k)
    message += (k ? ", '" : known.size() == 1 ? "; there is '" : "; there are '") + known[k] + "'";
  const std::string close = nearest_name(name, known);
  throw InputError(message + (close.empty() ? "" : "; did you mean '" + close + "'?"));
}

}  // namespace lapwing
