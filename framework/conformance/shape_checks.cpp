// SPDX-License-Identifier: Apache-2.0
// What every plugin of kind `shape` must pass: a distance that is the distance to its surface, and
// surface, box and rays that tell of the same shape.
#include <cmath>
#include <cstdlib>
#include <map>

#include "framework/conformance/differences.h"
#include "framework/conformance/findings.h"
#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/core/random.h"
#include "framework/geometry/mesh_file.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/geometry/winding.h"
#include "framework/map/map.h"
#include "framework/map/map_file.h"
#include "framework/plugin/registry.h"
#include "framework/shape/shape.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kTolerance = 0.01;  // m, of the surfaces that are asked for
constexpr double kWithin = 40;       // m to each side of the origin, where they are asked for
constexpr int kPlaces = 400, kRays = 150;

constexpr const char* kMapHolder = "brick";
constexpr const char* kNoFile = "is at hand to try it with";

// A folder with a mesh and a map, for shapes that are read from files.
class TriedShapes final : public ShapeSetting {
 public:
  explicit TriedShapes(const Registry* registry) : registry_(registry) {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "lapwing_shape_XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw Error(pattern + ": cannot make a folder");
    folder_ = pattern;
    margin = 0.5;
    write_ply(box_surface({Vector3d(-1, -2, 0), Vector3d(2, 1, 3)}), folder_ / "mesh.ply");
    if (!registry || !has_holder()) return;
    // A room of 4 m with a pillar, of voxels of half a metre.
    const std::shared_ptr<Map> map = make_map(kMapHolder, 0.5);
    std::vector<VoxelLeaf> leaves;
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y)
        for (int z = 0; z < 6; ++z) {
          VoxelLeaf leaf;
          leaf.key = map->grid().key(Vector3d(0.5 * x + 0.25, 0.5 * y + 0.25, 0.5 * z + 0.25));
          leaf.log_odds = x == 4 && y == 4 ? 3.0f : -3.0f;
          leaves.push_back(leaf);
        }
    map->import(leaves);
    write_map_file(folder_ / "map.ot", *map);
    has_map_ = true;
  }
  ~TriedShapes() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::filesystem::path find(const std::string&, const std::string& folder) override {
    if (folder == "meshes") return folder_ / "mesh.ply";
    if (folder == "maps" && has_map_) return folder_ / "map.ot";
    throw InputError("no file of " + folder + " " + kNoFile);
  }
  KeptFile keep(const std::string& bytes, const std::string& ending) override {
    write_file_atomically(folder_ / ("kept" + ending), bytes);
    return {"kept" + ending, sha256(bytes)};
  }
  std::filesystem::path kept(const std::string& file) const override { return folder_ / file; }
  std::shared_ptr<Map> make_map(const std::string&, double resolution) override {
    if (!registry_) throw InputError(std::string("no map ") + kNoFile);
    Value parameters = Value::map();
    parameters.set("resolution", resolution);
    return registry_->create<Map>(kMapHolder, parameters);
  }
  void tell(const std::string&) override {}

 private:
  bool has_holder() const {
    const auto& all = registry_->entries();
    return std::any_of(all.begin(), all.end(), [](const PluginEntry& entry) {
      return entry.kind == Map::kKind && entry.name == kMapHolder;
    });
  }

  const Registry* registry_;
  std::filesystem::path folder_;
  bool has_map_ = false;
};

// Numbers of the size that obstacles have: places within 10 m, lengths of some metres, lists of
// numbers as the corners of a polygon round a place.
Value drawn_parameters(const ParameterTable& table, Random& random) {
  Value value = Value::map();
  for (const ParameterSpec& spec : table.specs()) {
    if (!spec.required && (spec.type != ParameterType::number || random.uniform() < 0.5)) continue;
    if (!spec.required && spec.default_value.is_number()) continue;
    if (spec.type == ParameterType::text) value.set(spec.name, "file");
    if (spec.type == ParameterType::number) {
      const double low = std::max(spec.range.minimum, spec.required ? 0.5 : -5.0);
      const double high = std::min(spec.range.maximum, spec.required ? 5.0 : 10.0);
      value.set(spec.name, random.uniform(std::min(low, high), high));
    }
    if (spec.type != ParameterType::numbers) continue;
    Value list = Value::list();
    const int corners = spec.size > 0 ? 0 : static_cast<int>(random.integer(3, 9));
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * M_PI * k / corners, radius = random.uniform(1, 6);
      list.push_back(radius * std::cos(angle) + 1);
      list.push_back(radius * std::sin(angle) - 2);
    }
    for (int k = 0; k < spec.size; ++k) list.push_back(random.uniform(-10, 10));
    value.set(spec.name, std::move(list));
  }
  return value;
}

// The surface of a shape, as a judge of its distance.
class SurfaceJudge {
 public:
  SurfaceJudge(const Shape& shape, const Eigen::AlignedBox3d& within)
      : mesh_(shape.triangles(kTolerance, within)), scene_(mesh_, "the surface") {}

  const TriangleMesh& mesh() const { return mesh_; }
  double distance(const Vector3d& p) const { return scene_.nearest(p, 1e4)->distance; }

  bool inside(const Vector3d& p) const { return winding_number(mesh_, p) > 0.5; }

  // Edges that no neighbour closes.
  std::size_t open() const {
    std::map<std::pair<int, int>, int> balance;
    for (const auto& t : mesh_.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
      }
    std::size_t open = 0;
    for (const auto& [edge, count] : balance) open += count != 0;
    return open;
  }

 private:
  TriangleMesh mesh_;
  MeshScene scene_;
};

std::string place_text(const Vector3d& p) {
  return "(" + text_of(p.x()) + ", " + text_of(p.y()) + ", " + text_of(p.z()) + ")";
}

void check_derivatives(const Shape& shape, const Vector3d& p, Findings& findings) {
  constexpr double kStep = 1e-5, kAround = 1.1e-4, kNear = 2e-4;
  // Of what is interpolated each component alone is at most 1.
  const double steepest = shape.surrounds() ? std::sqrt(3.0) : 1;
  Vector3d gradient;
  const double value = shape.distance(p, &gradient);
  findings.expect("values", std::isfinite(value) && gradient.allFinite(),
                  [&] { return "the distance at " + place_text(p) + " is not finite"; });
  findings.expect("values", value == shape.distance(p, nullptr), [&] {
    return "the distance at " + place_text(p) + " is another without its gradient";
  });
  findings.expect("gradient", gradient.norm() <= steepest + 1e-6, [&] {
    return "at " + place_text(p) + " the gradient is " + text_of(gradient.norm()) +
           " long: a distance changes by no more than its point moves";
  });
  const Eigen::Matrix3d curvature = shape.curvature(p);
  findings.expect("curvature", curvature.allFinite(),
                  [&] { return "the curvature at " + place_text(p) + " is not finite"; });
  for (int i = 0; i < 3; ++i) {
    const Vector3d step = kStep * Vector3d::Unit(i);
    Vector3d before, after;
    const double low = shape.distance(p - step, &before), high = shape.distance(p + step, &after);
    // Across a kink neither is anything.
    Vector3d left, right;
    shape.distance(p - kAround * Vector3d::Unit(i), &left);
    shape.distance(p + kAround * Vector3d::Unit(i), &right);
    if ((after - before).norm() > 0.02 || (right - left).norm() > 0.02) continue;
    findings.expect("gradient", std::abs((high - low) / (2 * kStep) - gradient(i)) < kNear, [&] {
      return "at " + place_text(p) + " component " + std::to_string(i) + " is " +
             text_of(gradient(i)) + ", differences say " + text_of((high - low) / (2 * kStep));
    });
    if (shape.surrounds()) continue;
    const Vector3d column = (after - before) / (2 * kStep);
    const double size = std::max(1.0, column.norm());
    findings.expect("curvature", (column - curvature.col(i)).norm() < 0.02 * size, [&] {
      return "at " + place_text(p) + " column " + std::to_string(i) + " is (" +
             place_text(curvature.col(i)) + "), differences say " + place_text(column);
    });
  }
}

void check_distance(const Shape& shape, const SurfaceJudge& judge, const Vector3d& p,
                    Findings& findings) {
  const double told = shape.distance(p, nullptr), away = judge.distance(p);
  const bool inside = shape.solid() && judge.inside(p);
  const double truth = inside ? -away : away;
  const double slack = 1.5 * kTolerance;
  findings.expect("never too large", told <= truth + slack, [&] {
    return "at " + place_text(p) + " it says " + text_of(told) + " m, its surface is " +
           text_of(truth) + " m away";
  });
  if (!shape.solid() || away < slack) return;
  findings.expect("sign", (told < 0) == inside, [&] {
    return place_text(p) + " is " + (inside ? "inside" : "outside") + " of its surface, and " +
           text_of(told) + " m are said";
  });
  // Flights may be kept inside of it. Where the surface of `within` is as near, its triangles end.
  const double to_end = (Vector3d::Constant(kWithin) - p.cwiseAbs()).minCoeff();
  findings.expect("depth", !inside || away > to_end - slack || -told <= away + slack, [&] {
    return "at " + place_text(p) + " it says " + text_of(-told) + " m inside, its surface is " +
           text_of(away) + " m away";
  });
}

void check_ray(const Shape& shape, const Vector3d& from, const Vector3d& way, double length,
               Findings& findings) {
  constexpr int kSteps = 400;
  const auto hit = shape.hit(from, way);
  const bool begins_inside = shape.solid() && shape.distance(from, nullptr) < 0;
  const double end = hit ? std::min(hit->distance, length) : length;
  const auto ray = [&] { return "the ray from " + place_text(from) + " along " + place_text(way); };
  if (hit) {
    const double told = shape.distance(from + hit->distance * way, nullptr);
    // What surrounds a flight has a distance that is interpolated: it ends within a voxel.
    findings.expect("rays", shape.surrounds() || std::abs(told) < 1e-4, [&] {
      return ray() + " ends at " + text_of(hit->distance) + " m, where the surface is " +
             text_of(told) + " m away";
    });
    findings.expect("rays", std::abs(hit->normal.norm() - 1) < 1e-6 && hit->normal.dot(way) < 1e-6,
                    [&] { return ray() + " has a normal that does not face it"; });
  }
  if (!shape.solid()) return;
  for (int k = 1; k < kSteps; ++k) {
    const double at = end * k / kSteps;
    const double told = shape.distance(from + at * way, nullptr);
    findings.expect("rays", begins_inside ? told < 1e-3 : told > -1e-3, [&] {
      return ray() + " passes through the surface before " + text_of(at) + " m unseen";
    });
  }
}

// Between two places it is no farther than at the farther of both.
void check_convex(const Shape& shape, const Vector3d& p, const Vector3d& q, Findings& findings) {
  if (!shape.convex()) return findings.expect("convex", true, {});
  const double at_p = shape.distance(p, nullptr), at_q = shape.distance(q, nullptr);
  const double middle = shape.distance((p + q) / 2, nullptr);
  findings.expect("convex", middle <= std::max(at_p, at_q) + 1e-9, [&] {
    return "it says that it is convex, and between " + place_text(p) + " and " + place_text(q) +
           " it is farther than at both";
  });
}

// Likewise between two places of its surface, where a gap shows that random places miss.
void check_surface_convex(const Shape& shape, const TriangleMesh& surface, Random& random,
                          Findings& findings) {
  constexpr int kPairs = 200;
  if (surface.vertices.empty()) return;
  const auto vertex = [&] {
    const auto last = static_cast<std::int64_t>(surface.vertices.size()) - 1;
    return surface.vertices[static_cast<std::size_t>(random.integer(0, last))];
  };
  for (int k = 0; k < kPairs; ++k) {
    const Vector3d p = vertex(), q = vertex();
    check_convex(shape, p, q, findings);
  }
}

void check_shape(const Shape& shape, Random& random, const CheckOptions& options,
                 Findings& findings) {
  const Eigen::AlignedBox3d within(Vector3d::Constant(-kWithin), Vector3d::Constant(kWithin));
  const SurfaceJudge judge(shape, within);
  findings.expect("values", shape.rounding() >= 0, [] { return "rounding is below 0"; });
  if (shape.solid())
    findings.expect("surface", judge.open() == 0, [&] {
      return std::to_string(judge.open()) + " edges of its triangles lack a neighbour";
    });
  const Eigen::AlignedBox3d bounds = shape.bounds();
  for (const Vector3d& vertex : judge.mesh().vertices) {
    findings.expect("bounds", bounds.exteriorDistance(vertex) < 1e-4, [&] {
      return "its surface reaches " + place_text(vertex) + ", beyond its box";
    });
    const bool cut =
        shape.surrounds() || (vertex.cwiseAbs().array() > 39.999).any();  // of `within`
    findings.expect("surface", cut || std::abs(shape.distance(vertex, nullptr)) <= kTolerance, [&] {
      return "its surface passes " + place_text(vertex) + ", whose distance is " +
             text_of(shape.distance(vertex, nullptr)) + " m";
    });
  }
  const auto place = [&] {
    return Vector3d(random.uniform(-18, 18), random.uniform(-18, 18), random.uniform(-18, 18));
  };
  for (int k = 0; k < kPlaces && !findings.settled(); ++k) {
    const Vector3d p = place(), q = k % 2 ? place() : Vector3d(p + 0.01 * place());
    if (options.wants_any({"values", "gradient", "curvature"}))
      check_derivatives(shape, p, findings);
    const double at_p = shape.distance(p, nullptr), at_q = shape.distance(q, nullptr);
    const double most = (shape.surrounds() ? std::sqrt(3.0) : 1) * (p - q).norm();
    findings.expect("gradient", std::abs(at_p - at_q) <= most + 1e-9, [&] {
      return "from " + place_text(p) + " to " + place_text(q) + " it changes by " +
             text_of(at_p - at_q) + " m over " + text_of((p - q).norm());
    });
    check_distance(shape, judge, p, findings);
    findings.expect("bounds", shape.surrounds() || at_p >= 0 || bounds.exteriorDistance(p) < 1e-6,
                    [&] { return place_text(p) + " is inside of it, and outside of its box"; });
    check_convex(shape, p, q, findings);
    if (k < kRays && options.wants("rays")) check_ray(shape, p, (q - p).normalized(), 60, findings);
  }
  if (options.wants("convex")) check_surface_convex(shape, judge.mesh(), random, findings);
}

// What it records must make it again.
void check_record(const Specimen<Shape>& subject, const Shape& shape, ShapeSetting& setting,
                  Random& random, Findings& findings) {
  const std::unique_ptr<Shape> again = subject.create(shape.record());
  again->open(setting);
  for (int k = 0; k < 50; ++k) {
    const Vector3d p(random.uniform(-18, 18), random.uniform(-18, 18), random.uniform(-18, 18));
    const double here = shape.distance(p, nullptr), there = again->distance(p, nullptr);
    findings.expect("record", std::abs(here - there) <= 1e-9, [&] {
      return "made again from its record, its distance at " + place_text(p) + " is " +
             text_of(there) + " m in place of " + text_of(here);
    });
  }
}

}  // namespace

std::vector<CheckResult> check_shape_plugin(const Specimen<Shape>& subject,
                                            const CheckOptions& options, const Registry* registry) {
  constexpr int kWanted = 8, kTries = 400;
  Findings findings(options);
  Random random(options.seed);
  TriedShapes setting(registry);
  std::string refusal;
  int made = 0;
  for (int k = 0; k < kTries && made < kWanted && !findings.settled(); ++k) {
    const Value parameters = drawn_parameters(subject.parameters, random);
    std::unique_ptr<Shape> shape;
    try {
      shape = subject.create(parameters);
      shape->open(setting);
    } catch (const InputError& error) {
      refusal = error.what();
      continue;
    } catch (const std::exception& error) {
      findings.fail("creation", std::string("throws: ") + error.what());
      break;
    }
    ++made;
    findings.expect("creation", true, {});
    if (!options.wants_answers()) break;
    findings.survives("exceptions", "its distance", [&] {
      check_shape(*shape, random, options, findings);
      if (options.wants("record")) check_record(subject, *shape, setting, random, findings);
    });
  }
  if (made == 0) {
    const bool files = refusal.find(kNoFile) != std::string::npos;
    if (files)
      findings.skip("creation", refusal);
    else
      findings.fail("creation", "refuses all of " + std::to_string(kTries) +
                                    " drawn parameters; the last time: " + refusal);
  }
  return std::move(findings).results();
}

}  // namespace lapwing
