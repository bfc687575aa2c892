// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/site_work.h"

#include <algorithm>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/map/surface_voxels.h"

namespace lapwing {
namespace {

constexpr std::size_t kBatch = 1 << 16;  // points read at once

std::string count_text(std::uint64_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

// Reads a cloud and keeps what the request wants of it.
class CloudReading {
 public:
  CloudReading(const CloudRequest& request, const MapWork& work)
      : request_(request),
        work_(work),
        reader_(open_cloud(request.file, request.options)),
        reference_(request.reference),
        thinned_(request.resolution, request.most) {
    reference_.system_of_data = reader_->header().system;
    reference_.note_of_data = reader_->header().system_note;
    reference_.height_unit_of_data = reader_->header().height_unit;
  }

  Site site() {
    Site site;
    site.name = reference_.name;
    site.resolution = request_.resolution;
    site.spacing = request_.spacing;
    read_all();
    const std::vector<ThinnedPoint> thinned = thinned_.take();
    add_surface(thinned, site);
    site.description = reader_->header().format + ", " + count_text(read_, "point", "points") +
                       " thinned to " + std::to_string(thinned.size());
    for (const Eigen::Vector3d& place : request_.scanners)
      site.scanners.push_back(frame_->to_world(place));
    site.origin = origin_;
    site.notes = notes_;
    if (const std::string left = left_out(); !left.empty()) site.notes.push_back(left);
    return site;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError("'" + reference_.name + "': " + why);
  }

  void refer(const CloudPoint& first) {
    const auto& bounds = reader_->header().bounds;
    reference_.sample = bounds ? bounds->center().eval() : first.position;
    reference_.lowest = bounds ? bounds->min().z() : first.position.z();
    SiteReference found = refer_site(reference_);
    frame_ = found.frame;
    notes_ = std::move(found.notes);
    origin_ = found.origin;
    if (reader_->header().viewpoint && request_.scanners.empty())
      notes_.push_back("'" + reference_.name + "': it states a viewpoint, which is not used; " +
                       reference_.option + ".scanners states from where it was measured");
  }

  void report() const {
    if (work_.cancellation && work_.cancellation->cancelled()) throw Cancelled();
    if (!work_.progress) return;
    const auto all = reader_->header().points;
    work_.progress->report(
        all ? static_cast<double>(read_) / static_cast<double>(std::max<std::uint64_t>(*all, 1))
            : -1,
        count_text(read_, "point", "points") + " read");
  }

  void read_all() {
    std::vector<CloudPoint> batch(kBatch);
    for (std::size_t count = 0; (count = reader_->read(batch)) > 0;) {
      for (std::size_t i = 0; i < count; ++i) take(batch[i]);
      report();
    }
    if (read_ == 0) fail("it has no points");
    if (bounds_.isEmpty())
      fail("none of its " + count_text(read_, "point", "points") + " can be used: " + left_out());
    require_no_degrees(reference_, bounds_);
    if (thinned_.cells() == 0)
      fail("none of its points lies in the region and within the reach of the tour around it");
  }

  void take(const CloudPoint& point) {
    ++read_;
    if (!point.position.allFinite()) return void(++not_finite_);
    if (point.withheld) return void(++withheld_);
    if (request_.without.count(point.classification)) return void(++of_class_);
    if (!frame_) refer(point);
    bounds_.extend(point.position);
    const Eigen::Vector3d p = frame_->to_world(point.position);
    if (!(p.norm() <= kFarthestSite))
      fail("point " + std::to_string(read_) + " lies at (" + plain_number(p.x(), 9) + ", " +
           plain_number(p.y(), 9) + ", " + plain_number(p.z(), 9) +
           ") m of the world frame, and at most 1e5 m from its origin are possible");
    if (request_.only && !request_.only->contains(p.head<2>().eval())) return void(++outside_);
    thinned_.add(p, turned(point));
  }

  // A normal in the world frame: the way from a place to one a unit along it. Coordinates in
  // degrees have no such way; normals beside them are taken to be east, north, up.
  Eigen::Vector3f turned(const CloudPoint& point) const {
    constexpr double kLongestUnit = 10;  // m
    const Eigen::Vector3d n = point.normal.cast<double>();
    if (!n.allFinite() || !(n.norm() > 0.5)) return Eigen::Vector3f::Zero();
    const Eigen::Vector3d way =
        frame_->to_world(point.position + n.normalized()) - frame_->to_world(point.position);
    return (way.norm() < kLongestUnit ? way : n).normalized().cast<float>();
  }

  void add_surface(const std::vector<ThinnedPoint>& thinned, Site& site) {
    try {
      CloudSurface surface =
          surface_of_cloud(thinned, {request_.spacing, scanners_in_world(), work_.threads});
      site.points = std::move(surface.points);
      const VoxelGrid grid(request_.resolution);
      for (std::size_t i = 0; i < thinned.size(); ++i) {
        if (!surface.kept[i]) continue;
        site.bounds.extend(thinned[i].position);
        if (!grid.contains(thinned[i].position))
          throw InputError("it reaches beyond the largest map of voxels of " +
                           plain_number(request_.resolution) + " m");
        site.measured.push_back(grid.key(thinned[i].position));
      }
      alone_ = surface.alone;
    } catch (const InputError& error) {
      fail(error.what());
    }
    std::sort(site.measured.begin(), site.measured.end());
    site.measured.erase(std::unique(site.measured.begin(), site.measured.end()),
                        site.measured.end());
  }

  std::vector<Eigen::Vector3d> scanners_in_world() const {
    std::vector<Eigen::Vector3d> places;
    for (const Eigen::Vector3d& place : request_.scanners)
      places.push_back(frame_->to_world(place));
    return places;
  }

  // What was left out, and why; "" where nothing was.
  std::string left_out() const {
    std::string text;
    const auto add = [&](std::uint64_t count, const std::string& why) {
      if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + why;
    };
    add(not_finite_, "without finite coordinates");
    add(withheld_, "that the file withholds");
    add(of_class_, "of classes that are left out");
    add(outside_, "outside of the region and the reach around it");
    add(alone_, "(thinned) far from all others");
    return text.empty() ? "" : "points left out: " + text;
  }

  const CloudRequest& request_;
  const MapWork& work_;
  std::unique_ptr<CloudReader> reader_;
  StatedReference reference_;
  ThinnedCloud thinned_;
  std::optional<SiteFrame> frame_;
  std::vector<std::string> notes_;
  std::optional<GeodeticOrigin> origin_;
  Eigen::AlignedBox3d bounds_;  // of the cloud's own coordinates
  std::uint64_t read_ = 0, not_finite_ = 0, withheld_ = 0, of_class_ = 0, outside_ = 0, alone_ = 0;
};

}  // namespace

Site read_site_cloud(const CloudRequest& request, const MapWork& work) {
  return CloudReading(request, work).site();
}

void map_site(const Site& site, const TriangleMesh& mesh, const SiteAir& air, Map& map) {
  const VoxelGrid& grid = map.grid();
  std::vector<VoxelKey> occupied = surface_voxels(mesh.vertices, mesh.triangles, grid.resolution());
  const std::size_t of_mesh = occupied.size();
  occupied.insert(occupied.end(), site.measured.begin(), site.measured.end());
  std::inplace_merge(occupied.begin(), occupied.begin() + static_cast<std::ptrdiff_t>(of_mesh),
                     occupied.end());
  occupied.erase(std::unique(occupied.begin(), occupied.end()), occupied.end());
  constexpr float kSure = std::numeric_limits<float>::infinity();
  std::vector<VoxelLeaf> leaves;
  if (air.sky) leaves = SkyColumns::over(occupied).free_above(grid.index(air.ceiling));
  if (air.scanners)
    for (const VoxelKey& key :
         free_from_scanners(site.measured, occupied, site.scanners, grid, air.range))
      leaves.push_back({key, 0, 0, -kSure});
  if (site.solid) {
    const std::vector<VoxelLeaf> solid = site.solid->solid_below(grid.index(site.bounds.min().z()));
    leaves.insert(leaves.end(), solid.begin(), solid.end());
  }
  for (const VoxelKey& key : occupied) leaves.push_back({key, 0, 0, kSure});
  map.import(leaves);
}

}  // namespace lapwing
