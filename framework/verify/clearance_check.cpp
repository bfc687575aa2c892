// SPDX-License-Identifier: Apache-2.0
// Distance of the continuous path from every obstacle and zone, never overestimated.
//
// The path between two integrated points is replaced by their chord; it leaves the chord by at most
// |a|max h^2 / 8 (kBulge), which is taken off the distance.
#include "framework/verify/checks.h"

namespace lapwing {
namespace {

constexpr double kReach = 50;    // m beyond the margin; farther meshes are far
constexpr double kApart = 1e-9;  // m, above what rounding can do

struct Chord {
  Eigen::Vector3d from, to;
  double bulge;
  Eigen::Vector3d at(double s) const { return from + s * (to - from); }
};

// Signed distances of a point from a surface: negative inside. Those of spheres and boxes are
// convex functions of the point; all change by no more than the point moves.
double distance(const Sphere& sphere, const Eigen::Vector3d& p) {
  return (p - sphere.center).norm() - sphere.radius;
}

double distance(const Box& box, const Eigen::Vector3d& p) {
  const Eigen::Vector3d beyond = (box.lower - p).cwiseMax(p - box.upper);
  const double deepest = beyond.maxCoeff();
  return deepest <= 0 ? deepest : beyond.cwiseMax(0.0).norm();
}

// From the edges of a polygon that does not cross itself.
double distance(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& p) {
  double nearest2 = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[i + 1 < corners.size() ? i + 1 : 0];
    const Eigen::Vector2d edge = b - a, to_p = p - a;
    const double share = std::clamp(to_p.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    nearest2 = std::min(nearest2, (to_p - share * edge).squaredNorm());
    // Each edge that a ray from p towards +x crosses turns outside into inside.
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    const double side = edge.x() * to_p.y() - edge.y() * to_p.x();
    if ((side > 0) == (edge.y() > 0)) inside = !inside;
  }
  return inside ? -std::sqrt(nearest2) : std::sqrt(nearest2);
}

double distance(const Zone& zone, const Eigen::Vector3d& p) {
  const double across = distance(zone.corners, p.head<2>());
  const double up = std::max(zone.floor - p.z(), p.z() - zone.ceiling);
  if (across <= 0 && up <= 0) return std::max(across, up);
  return std::hypot(std::max(across, 0.0), std::max(up, 0.0));
}

// A mesh with the name that the environment gives it. Distances are told apart up to `reach`.
struct MeshBody {
  const std::string& name;
  const MeshScene& scene;
  double reach;
};

double distance(const MeshBody& mesh, const Eigen::Vector3d& p, double more = 0) {
  const auto nearest = mesh.scene.nearest(p, mesh.reach + more);
  return nearest ? nearest->distance : mesh.reach + more;
}

// Likewise a map.
struct MapBody {
  const std::string& name;
  const BlockedVoxels& voxels;
  double reach;
};

double distance(const MapBody& map, const Eigen::Vector3d& p, double more = 0) {
  return map.voxels.distance(p, map.reach + more);
}

// The distance told apart `more` metres farther than otherwise, where it has an end.
template <class Obstacle>
double far_distance(const Obstacle& obstacle, const Eigen::Vector3d& p, double more) {
  if constexpr (requires { obstacle.reach; })
    return distance(obstacle, p, more);
  else
    return distance(obstacle, p);
}

// How far inside a flight zone a point is; negative outside.
struct Inside {
  const std::string& name;
  const Zone& zone;
};

double distance(const Inside& inside, const Eigen::Vector3d& p) {
  return -distance(inside.zone, p);
}

// The smallest distance on a chord and its share of it; never above the true one.
struct Nearest {
  double distance, share;
};

// By golden sections: the distance along the chord is convex.
template <class Obstacle>
Nearest nearest(const Obstacle& obstacle, const Chord& chord) {
  constexpr double kGolden = 0.6180339887498949;
  double low = 0, high = 1;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double value_a = distance(obstacle, chord.at(a)), value_b = distance(obstacle, chord.at(b));
  for (int i = 0; i < 50; ++i) {
    if (value_a < value_b) {
      high = b, b = a, value_b = value_a;
      a = high - kGolden * (high - low), value_a = distance(obstacle, chord.at(a));
    } else {
      low = a, a = b, value_a = value_b;
      b = low + kGolden * (high - low), value_b = distance(obstacle, chord.at(b));
    }
  }
  Nearest best{distance(obstacle, chord.from), 0};
  for (const double share : {(low + high) / 2, 1.0}) {
    const double value = distance(obstacle, chord.at(share));
    if (value < best.distance) best = {value, share};
  }
  return best;
}

// What need not be convex: halves of the chord that may hold less than the best so far are halved
// again, down to a length that is taken off the distance.
template <class Obstacle>
Nearest nearest_by_halves(const Obstacle& obstacle, const Chord& chord) {
  const double length = (chord.to - chord.from).norm();
  const double resolution = std::max(tolerances::kBulge, length / 2048);
  Nearest best{distance(obstacle, chord.from), 0};
  std::vector<std::pair<double, double>> parts{{0.0, 1.0}};
  while (!parts.empty()) {
    const auto [from, to] = parts.back();
    parts.pop_back();
    const double middle = (from + to) / 2, half = (to - from) / 2 * length;
    const double value = far_distance(obstacle, chord.at(middle), half);
    if (value - half >= best.distance) continue;
    if (half <= resolution) {
      best = {value - half, middle};
    } else {
      if (value < best.distance) best = {value, middle};
      parts.emplace_back(middle, to);
      parts.emplace_back(from, middle);
    }
  }
  return best;
}

Nearest nearest(const Zone& zone, const Chord& chord) {
  return nearest_by_halves(zone, chord);
}

Nearest nearest(const MeshBody& mesh, const Chord& chord) {
  return nearest_by_halves(mesh, chord);
}

Nearest nearest(const MapBody& map, const Chord& chord) {
  const auto found = map.voxels.nearest(chord.from, chord.to, map.reach);
  return {found.distance, found.share};
}

Nearest nearest(const Inside& inside, const Chord& chord) {
  return nearest_by_halves(inside, chord);
}

class Clearance {
 public:
  Clearance(const char* check, double margin)
      : worst_(check, margin, tolerances::kClearance, true) {}

  template <class Obstacle>
  void see(const Obstacle& obstacle, const char* kind, std::size_t number, const Chord& chord,
           double time, double duration) {
    // Nothing farther away than the worst so far has to be told apart.
    Obstacle near = obstacle;
    if constexpr (requires { near.reach; })
      if (seen_) near.reach = std::min(near.reach, worst_.value() + chord.bulge + kApart);
    // Distances change by no more than the way travelled, so most chords need one evaluation.
    const double length = (chord.to - chord.from).norm();
    const double around = length / 2 + chord.bulge;
    const double lowest = far_distance(near, chord.at(0.5), around) - around;
    if (seen_ && lowest >= worst_.value()) return;
    seen_ = true;
    const Nearest best = nearest(near, chord);
    if (worst_.see(best.distance - chord.bulge, time + best.share * duration)) {
      nearest_ = obstacle.name.empty() ? std::string(kind) + " " + std::to_string(number + 1)
                                       : std::string(kind) + " '" + obstacle.name + "'";
    }
  }

  Check check() const {
    Check check = worst_.check();
    check.detail += (check.detail.empty() ? "" : "; ") + nearest_;
    return check;
  }

 private:
  Worst worst_;
  bool seen_ = false;
  std::string nearest_;
};

void see_all(const Flight& flight, const Chord& chord, double time, double duration,
             Clearance& clearance) {
  const Environment& environment = flight.plan.environment;
  for (std::size_t i = 0; i < environment.spheres.size(); ++i) {
    clearance.see(environment.spheres[i], "sphere", i, chord, time, duration);
  }
  for (std::size_t i = 0; i < environment.boxes.size(); ++i) {
    clearance.see(environment.boxes[i], "box", i, chord, time, duration);
  }
  for (std::size_t i = 0; i < environment.zones.size(); ++i) {
    clearance.see(environment.zones[i], "zone", i, chord, time, duration);
  }
  for (std::size_t i = 0; i < flight.meshes.size(); ++i) {
    const MeshBody mesh{environment.meshes[i].name, flight.meshes[i], kReach + environment.margin};
    clearance.see(mesh, "mesh", i, chord, time, duration);
  }
  for (std::size_t i = 0; i < flight.maps.size(); ++i) {
    const MapBody map{environment.maps[i].name, flight.maps[i],
                      environment.margin + tolerances::kMapReach};
    clearance.see(map, "map", i, chord, time, duration);
  }
}

// Calls see(chord, time, duration) for the samples and for all that lies between them.
template <class See>
void along(Motion& motion, See see) {
  for (std::size_t i = 0; i <= motion.intervals(); ++i) {
    const MotionPoint p = motion.stated(i);
    see(Chord{p.position, p.position, 0}, p.time, 0.0);
  }
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const auto points = motion.integrate(i);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const MotionPoint& a = points[k - 1];
      const MotionPoint& b = points[k];
      const double h = b.time - a.time;
      const double bulge = std::max(a.acceleration.norm(), b.acceleration.norm()) * h * h / 8;
      see(Chord{a.position, b.position, bulge}, a.time, h);
    }
  }
}

}  // namespace

void check_clearance(const Flight& flight, Certificate& certificate) {
  const Environment& environment = flight.plan.environment;
  if (environment.spheres.empty() && environment.boxes.empty() && environment.zones.empty() &&
      environment.meshes.empty() && environment.maps.empty()) {
    certificate.checks.push_back(skipped_check("clearance", "the environment has no obstacle"));
    return;
  }
  Clearance clearance("clearance", environment.margin);
  along(flight.motion, [&](const Chord& chord, double time, double duration) {
    see_all(flight, chord, time, duration, clearance);
  });
  certificate.checks.push_back(clearance.check());
}

void check_flight_zones(const Flight& flight, Certificate& certificate) {
  const Environment& environment = flight.plan.environment;
  if (environment.flight_zones.empty()) {
    certificate.checks.push_back(
        skipped_check("flight_zone", "the environment has no zone to stay in"));
    return;
  }
  Clearance inside("flight_zone", environment.margin);
  along(flight.motion, [&](const Chord& chord, double time, double duration) {
    for (std::size_t i = 0; i < environment.flight_zones.size(); ++i) {
      const Zone& zone = environment.flight_zones[i];
      inside.see(Inside{zone.name, zone}, "flight zone", i, chord, time, duration);
    }
  });
  certificate.checks.push_back(inside.check());
}

}  // namespace lapwing
