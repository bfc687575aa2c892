// SPDX-License-Identifier: Apache-2.0
// Points with normals of a COLMAP model.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <unordered_map>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/photogrammetry/colmap_depth.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kNeighbours = 12, kLeastImages = 3;
constexpr double kLonely = 10;                               // times the usual distance
constexpr std::size_t kLargestCloud = std::size_t{4} << 30;  // bytes
constexpr std::uint64_t kMostCells = 200;                    // along the longest edge
constexpr std::int64_t kMostRings = 40;                      // of cubes that are searched

using Cell = std::array<std::int64_t, 3>;

// Points by cubes, so that near ones are found without looking at all.
class PointGrid {
 public:
  explicit PointGrid(const std::vector<Vector3d>& points) : points_(points) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : points) box.extend(p);
    // Cubes that hold some few points each, were they spread over a surface.
    const double across = std::max(box.sizes().maxCoeff(), 1e-9);
    const double cells = std::sqrt(static_cast<double>(points.size()) / 4);
    edge_ = across / std::clamp(cells, 1.0, static_cast<double>(kMostCells));
    for (std::size_t k = 0; k < points.size(); ++k) cells_[cell_of(points[k])].push_back(k);
  }

  // The nearest of a point, itself among them, nearest first; fewer where there are fewer.
  std::vector<std::size_t> nearest(const Vector3d& p, std::size_t count) const {
    std::vector<std::pair<double, std::size_t>> found;
    const Cell middle = cell_of(p);
    for (std::int64_t ring = 0; ring <= kMostRings; ++ring) {
      collect(p, middle, ring, found);
      std::sort(found.begin(), found.end());
      // What lies in rings farther out is at least so far away.
      const double safe = static_cast<double>(ring) * edge_;
      if (found.size() >= count && found[count - 1].first <= safe * safe) break;
      if (found.size() == points_.size()) break;
    }
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < std::min(count, found.size()); ++k)
      places.push_back(found[k].second);
    return places;
  }

 private:
  Cell cell_of(const Vector3d& p) const {
    const Vector3d c = (p / edge_).array().floor();
    return {static_cast<std::int64_t>(c.x()), static_cast<std::int64_t>(c.y()),
            static_cast<std::int64_t>(c.z())};
  }
  void collect(const Vector3d& p, const Cell& middle, std::int64_t ring,
               std::vector<std::pair<double, std::size_t>>& found) const {
    for (std::int64_t x = -ring; x <= ring; ++x)
      for (std::int64_t y = -ring; y <= ring; ++y) {
        const bool shell = std::abs(x) == ring || std::abs(y) == ring;
        for (std::int64_t z = -ring; z <= ring; z += shell || ring == 0 ? 1 : 2 * ring) {
          const auto at = cells_.find({middle[0] + x, middle[1] + y, middle[2] + z});
          if (at == cells_.end()) continue;
          for (const std::size_t k : at->second)
            found.emplace_back((points_[k] - p).squaredNorm(), k);
        }
      }
  }

  const std::vector<Vector3d>& points_;
  double edge_ = 1;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

// Of the plane through points; zero where they are too few.
Vector3d normal_of(const std::vector<Vector3d>& points, const std::vector<std::size_t>& near) {
  if (near.size() < 4) return Vector3d::Zero();
  Vector3d mean = Vector3d::Zero();
  for (const std::size_t k : near) mean += points[k] / static_cast<double>(near.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const std::size_t k : near) {
    const Vector3d d = points[k] - mean;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) spread(i, j) += d[i] * d[j];
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
}

}  // namespace

std::vector<FusedPoint> surface_of_colmap(const ColmapModel& model) {
  std::map<std::uint32_t, Vector3d> cameras;
  for (const ColmapImage& image : model.images) cameras[image.id] = image.pose.position;
  std::vector<Vector3d> positions;
  std::vector<const ColmapPoint*> kept;
  for (const ColmapPoint& point : model.points) {
    if (point.images.size() < kLeastImages) continue;
    kept.push_back(&point);
    positions.push_back(point.position);
  }
  if (kept.empty()) return {};
  const PointGrid grid(positions);
  std::vector<FusedPoint> surface;
  std::vector<double> reach;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const std::vector<std::size_t> near = grid.nearest(positions[k], kNeighbours + 1);
    Vector3d normal = normal_of(positions, near);
    Vector3d towards = Vector3d::Zero();
    for (const std::uint32_t image : kept[k]->images)
      towards += (cameras.at(image) - positions[k]).normalized();
    if (normal.dot(towards) < 0) normal = -normal;
    surface.push_back({positions[k], normal, static_cast<int>(kept[k]->images.size())});
    reach.push_back((positions[near.back()] - positions[k]).norm());
  }
  std::vector<double> usual = reach;
  std::nth_element(usual.begin(), usual.begin() + static_cast<std::ptrdiff_t>(usual.size() / 2),
                   usual.end());
  const double most = kLonely * usual[usual.size() / 2];
  std::vector<FusedPoint> clean;
  for (std::size_t k = 0; k < surface.size(); ++k)
    if (reach[k] <= most && surface[k].normal.norm() > 0.5) clean.push_back(surface[k]);
  return clean;
}

std::vector<FusedPoint> read_fused_points(const std::filesystem::path& file) {
  const std::string bytes = read_file(file, kLargestCloud);
  const auto fail = [&](const std::string& why) -> void {
    throw InputError("'" + file.string() + "': " + why);
  };
  static constexpr std::string_view kEnd = "end_header\n";
  const std::size_t end = bytes.substr(0, 1 << 16).find(kEnd);
  if (!bytes.starts_with("ply\n") || end == std::string::npos) fail("is no PLY file");
  const std::string header = bytes.substr(0, end);
  if (header.find("format binary_little_endian 1.0\n") == std::string::npos)
    fail("is not in the binary form that COLMAP writes");
  std::size_t at = header.find("element vertex ");
  if (at == std::string::npos) fail("has no vertices");
  const std::size_t count = std::strtoull(header.c_str() + at + 15, nullptr, 10);
  // The floats x, y, z, nx, ny, nz lead; what follows has a size that is known.
  at = header.find('\n', at) + 1;
  std::size_t stride = 0;
  for (int k = 0; header.compare(at, 9, "property ") == 0; ++k) {
    const std::size_t line = std::min(header.find('\n', at), header.size());
    const std::string text = header.substr(at + 9, line - at - 9);
    static constexpr const char* kFirst[] = {"float x",  "float y",  "float z",
                                             "float nx", "float ny", "float nz"};
    if (k < 6 && text != kFirst[k])
      fail("must begin with the properties x, y, z, nx, ny, nz as float, not '" + text + "'");
    if (text.starts_with("float "))
      stride += 4;
    else if (text.starts_with("uchar "))
      stride += 1;
    else
      fail("has a property '" + text + "' that COLMAP does not write");
    at = line + 1;
  }
  const std::size_t body = end + kEnd.size();
  if (stride < 24 || (bytes.size() - body) / stride < count)
    fail("is cut short: it counts " + std::to_string(count) + " points");
  std::vector<FusedPoint> points;
  for (std::size_t k = 0; k < count; ++k) {
    float v[6];
    std::memcpy(v, bytes.data() + body + k * stride, sizeof v);
    FusedPoint point;
    point.position = Vector3d(v[0], v[1], v[2]);
    point.normal = Vector3d(v[3], v[4], v[5]);
    point.images = 1;
    if (!point.position.allFinite() || !point.normal.allFinite())
      fail("the point " + std::to_string(k + 1) + " is not finite");
    if (!(point.normal.norm() > 0.5)) continue;
    point.normal.normalize();
    points.push_back(point);
  }
  return points;
}

std::vector<FusedPoint> thinned(const std::vector<FusedPoint>& points, double spacing) {
  if (!(spacing > 0)) throw InputError("the spacing of points must be above 0 m");
  struct Sum {
    Vector3d position = Vector3d::Zero(), normal = Vector3d::Zero();
    double count = 0;
    int images = 0;
  };
  std::map<Cell, Sum> sums;
  for (const FusedPoint& point : points) {
    const Vector3d c = (point.position / spacing).array().floor();
    if (!(c.cwiseAbs().maxCoeff() < 1e9)) throw InputError("a point lies too far away");
    Sum& sum = sums[{static_cast<std::int64_t>(c.x()), static_cast<std::int64_t>(c.y()),
                     static_cast<std::int64_t>(c.z())}];
    sum.position += point.position;
    sum.normal += point.normal;
    sum.count += 1;
    sum.images = std::max(sum.images, point.images);
  }
  std::vector<FusedPoint> thin;
  for (const auto& [cell, sum] : sums)
    if (sum.normal.norm() > 1e-9 * sum.count)
      thin.push_back({sum.position / sum.count, sum.normal.normalized(), sum.images});
  return thin;
}

}  // namespace lapwing
