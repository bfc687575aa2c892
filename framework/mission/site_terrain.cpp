// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/site_terrain.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/survey/height_raster.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMostPixels = 0x1p27;
constexpr double kMostNodes = 0x1p27;                // of a grid
constexpr double kLowest = -1000, kHighest = 10000;  // m; other heights are none
constexpr int kEdgeSamples = 16;                     // along each side of a raster, for its box
constexpr float kNoHeight = std::numeric_limits<float>::quiet_NaN();

// A raster and where it lies in the world.
class PlacedRaster {
 public:
  PlacedRaster(const std::filesystem::path& file, const std::string& name, StatedReference stated)
      : file_(file), name_(name), info_(raster_info(file)), stated_(std::move(stated)) {
    stated_.name = name;
    stated_.system_of_data = info_.system;
    stated_.height_unit_of_data = info_.height_unit;
    const Vector2d middle = info_.to_coordinates * Vector2d(info_.width / 2.0, info_.height / 2.0);
    stated_.sample = {middle.x(), middle.y(), info_.lowest};
    stated_.lowest = info_.lowest;
    reference_.emplace(refer_site(stated_));
    box_ = box_in_world();
    require_no_degrees(stated_, box_in_coordinates());
  }

  const RasterInfo& info() const { return info_; }
  const SiteReference& reference() const { return *reference_; }
  const Eigen::AlignedBox2d& box() const { return box_; }
  std::size_t impossible() const { return impossible_; }

  // Reads the pixels that the box (world) needs.
  void load(const Eigen::AlignedBox2d& box) {
    const Eigen::Affine2d back = info_.to_coordinates.inverse();
    Eigen::AlignedBox2d pixels;
    for (int k = 0; k <= kEdgeSamples; ++k)
      for (const Vector2d& p : around(box, k / static_cast<double>(kEdgeSamples)))
        pixels.extend(back * reference_->frame.from_world({p.x(), p.y(), 0}).head<2>().eval());
    const auto within = [](double value, int most) {
      return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(most)));
    };
    window_.column = within(std::floor(pixels.min().x()) - 1, info_.width);
    window_.row = within(std::floor(pixels.min().y()) - 1, info_.height);
    window_.width = within(std::ceil(pixels.max().x()) + 2, info_.width) - window_.column;
    window_.height = within(std::ceil(pixels.max().y()) + 2, info_.height) - window_.row;
    if (window_.width < 1 || window_.height < 1)
      throw InputError("'" + name_ + "': it does not reach into the region");
    const double count = static_cast<double>(window_.width) * window_.height;
    if (count > kMostPixels)
      throw InputError("'" + name_ + "': " + plain_number(count, 3) +
                       " of its pixels are in the region, and at most 1.3e8 are possible: state a "
                       "smaller region");
    values_ = raster_values(file_, window_);
  }

  // World z of the raster at a place; NaN without data.
  float height(const Vector2d& p) {
    const Vector3d there = reference_->frame.from_world({p.x(), p.y(), 0});
    const Vector2d pixel = info_.to_coordinates.inverse() * there.head<2>().eval();
    const float value = between(pixel - Vector2d(0.5, 0.5));
    if (std::isnan(value)) return kNoHeight;
    const double z = reference_->frame.to_world({there.x(), there.y(), value}).z();
    if (possible(z)) return static_cast<float>(z);
    ++impossible_;
    return kNoHeight;
  }

  // Points of the surface (m, world) at the middles of the loaded pixels, and between those of
  // neighbours at most `step` (m) apart: the crests of a bilinear surface run there. `use` takes
  // each of them, `row_done` the share of the rows.
  template <class Use, class RowDone>
  void crests(double step, const Use& use, const RowDone& row_done) const {
    for (int row = 0; row < window_.height; ++row) {
      row_done(static_cast<double>(row) / window_.height);
      for (int column = 0; column < window_.width; ++column) {
        const auto here = surface_at(column, row);
        if (!here) continue;
        use(*here);
        for (const auto& [right, down] : {std::pair(1, 0), std::pair(0, 1)}) {
          const auto next = surface_at(column + right, row + down);
          if (!next) continue;
          const Vector3d along = *next - *here;
          const double parts = std::ceil(along.head<2>().norm() / step);
          for (int k = 1; k < parts; ++k) use(*here + along * (k / parts));
        }
      }
    }
  }

 private:
  // A place along each side of a box.
  static std::array<Vector2d, 4> around(const Eigen::AlignedBox2d& box, double t) {
    const Vector2d low = box.min(), high = box.max(), p = low + t * (high - low);
    return {Vector2d(p.x(), low.y()), Vector2d(p.x(), high.y()), Vector2d(low.x(), p.y()),
            Vector2d(high.x(), p.y())};
  }

  Eigen::AlignedBox2d box_in_world() const {
    const Eigen::AlignedBox2d pixels(Vector2d(0, 0), Vector2d(info_.width, info_.height));
    Eigen::AlignedBox2d box;
    for (int k = 0; k <= kEdgeSamples; ++k)
      for (const Vector2d& pixel : around(pixels, k / static_cast<double>(kEdgeSamples))) {
        const Vector2d p = info_.to_coordinates * pixel;
        box.extend(reference_->frame.to_world({p.x(), p.y(), info_.lowest}).head<2>().eval());
      }
    return box;
  }

  Eigen::AlignedBox3d box_in_coordinates() const {
    Eigen::AlignedBox3d box;
    for (const Vector2d& pixel : {Vector2d(0, 0), Vector2d(info_.width, info_.height)}) {
      const Vector2d p = info_.to_coordinates * pixel;
      box.extend(Vector3d(p.x(), p.y(), 0));
    }
    box.max().z() = 10;  // m, that anything on earth rises
    return box;
  }

  // Bilinear between the middles of pixels; at the rim, half a pixel wide, the outermost one.
  float between(const Vector2d& middle) const {
    const double x = middle.x(), y = middle.y();
    if (!(x >= -0.5 && y >= -0.5 && x <= info_.width - 0.5 && y <= info_.height - 0.5))
      return kNoHeight;
    const double low_x = std::floor(x), low_y = std::floor(y);
    const double s = x - low_x, t = y - low_y;
    double sum = 0;
    for (int corner = 0; corner < 4; ++corner) {
      const int right = corner & 1, down = corner >> 1;
      const double weight = (right ? s : 1 - s) * (down ? t : 1 - t);
      if (weight > 0)
        sum += weight * pixel(static_cast<int>(low_x) + right, static_cast<int>(low_y) + down);
    }
    return static_cast<float>(sum);
  }

  static bool possible(double z) { return z > kLowest && z < kHighest; }

  // The middle of a pixel of the window on the surface (m, world); absent without data.
  std::optional<Vector3d> surface_at(int column, int row) const {
    if (column >= window_.width || row >= window_.height) return std::nullopt;
    const double value = pixel(window_.column + column, window_.row + row);
    if (std::isnan(value)) return std::nullopt;
    const Vector2d place =
        info_.to_coordinates * Vector2d(window_.column + column + 0.5, window_.row + row + 0.5);
    const Vector3d p = reference_->frame.to_world({place.x(), place.y(), value});
    return possible(p.z()) ? std::optional(p) : std::nullopt;
  }

  double pixel(int column, int row) const {
    column = std::clamp(column, 0, info_.width - 1) - window_.column;
    row = std::clamp(row, 0, info_.height - 1) - window_.row;
    if (column < 0 || row < 0 || column >= window_.width || row >= window_.height)
      return std::numeric_limits<double>::quiet_NaN();
    return values_[static_cast<std::size_t>(row) * static_cast<std::size_t>(window_.width) +
                   static_cast<std::size_t>(column)];
  }

  std::filesystem::path file_;
  std::string name_;
  RasterInfo info_;
  StatedReference stated_;
  std::optional<SiteReference> reference_;
  Eigen::AlignedBox2d box_;  // m, world
  RasterWindow window_;
  std::vector<float> values_;  // of the window
  std::size_t impossible_ = 0;
};

// Heights at the corners of a map's voxels, over the box.
HeightGrid grid_of(PlacedRaster& raster, const std::string& name, const Eigen::AlignedBox2d& box,
                   double resolution, const MapWork& work) {
  const Vector2d low = (box.min() / resolution).array().ceil(),
                 high = (box.max() / resolution).array().floor();
  const Vector2d size = high - low + Vector2d::Ones();
  if (!(size.minCoeff() >= 2))
    throw InputError("'" + name + "': fewer than two of its heights are in the region");
  if (size.prod() > kMostNodes)
    throw InputError("'" + name + "': the region has " + plain_number(size.prod(), 3) +
                     " columns of voxels, and at most 1.3e8 are possible: state a larger "
                     "resolution or a smaller region");
  const int columns = static_cast<int>(size.x()), rows = static_cast<int>(size.y());
  std::vector<float> heights;
  heights.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    if (work.cancellation && work.cancellation->cancelled()) throw Cancelled();
    if (work.progress)
      work.progress->report(static_cast<double>(row) / rows, "heights of '" + name + "'");
    for (int column = 0; column < columns; ++column)
      heights.push_back(raster.height(resolution * (low + Vector2d(column, row))));
  }
  try {
    return HeightGrid(resolution * low, resolution, columns, std::move(heights));
  } catch (const InputError&) {
    throw InputError("'" + name + "': it has no data in the region");
  }
}

// Triangles between grid points that are `stride` apart, where all corners are known.
TriangleMesh mesh_of_heights(const HeightGrid& grid, int stride) {
  TriangleMesh mesh;
  std::vector<std::int32_t> below, along;
  for (int row = 0; row < grid.rows(); row += stride) {
    along.assign(static_cast<std::size_t>((grid.columns() + stride - 1) / stride), -1);
    for (int column = 0; column < grid.columns(); column += stride) {
      const auto k = static_cast<std::size_t>(column / stride);
      const float z = grid.at(column, row);
      if (!std::isnan(z)) {
        const Vector2d p = grid.place(column, row);
        along[k] = static_cast<std::int32_t>(mesh.vertices.size());
        mesh.vertices.emplace_back(p.x(), p.y(), z);
      }
      if (row == 0 || k == 0) continue;
      const std::int32_t a = below[k - 1], b = below[k], c = along[k], d = along[k - 1];
      if (a < 0 || b < 0 || c < 0 || d < 0) continue;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
    std::swap(below, along);
  }
  weld(mesh, 0);
  return mesh;
}

// The highest voxel of each column, of the heights at its four corners.
SkyColumns columns_of(const HeightGrid& heights, double resolution) {
  const VoxelGrid grid(resolution);
  const Vector2d half = Vector2d::Constant(resolution / 2);
  const Vector2d first = heights.place(0, 0) + half;
  const int x = grid.index(first.x()), y = grid.index(first.y());
  SkyColumns columns(x, y, heights.columns() - 1, heights.rows() - 1);
  for (int row = 0; row + 1 < heights.rows(); ++row)
    for (int column = 0; column + 1 < heights.columns(); ++column) {
      const float corners[4] = {heights.at(column, row), heights.at(column + 1, row),
                                heights.at(column, row + 1), heights.at(column + 1, row + 1)};
      if (std::any_of(corners, corners + 4, [](float z) { return std::isnan(z); })) continue;
      columns.set_top(x + column, y + row, grid.index(*std::max_element(corners, corners + 4)));
    }
  return columns;
}

// Raises columns to what the surface reaches between their corners: a wall may be narrower than a
// voxel. Columns of which nothing is known stay unknown.
void raise_to_crests(SkyColumns& columns, const PlacedRaster& raster, const std::string& name,
                     double resolution, const MapWork& work) {
  const VoxelGrid grid(resolution);
  const auto raise = [&](const Vector3d& p) {
    const int x = grid.index(p.x()), y = grid.index(p.y());
    const std::int32_t top = columns.top(x, y), here = grid.index(p.z());
    if (top != SkyColumns::kUnknown && here > top) columns.set_top(x, y, here);
  };
  raster.crests(resolution / 2, raise, [&](double share) {
    if (work.cancellation && work.cancellation->cancelled()) throw Cancelled();
    if (work.progress) work.progress->report(share, "crests of '" + name + "'");
  });
}

void note_gaps(const PlacedRaster& raster, const HeightGrid& grid, const std::string& name,
               std::vector<std::string>& notes) {
  if (grid.known() < 1) {
    char text[160];
    std::snprintf(text, sizeof text, ": %.2g %% of the region has no data and stays unknown",
                  100 * (1 - grid.known()));
    notes.push_back("'" + name + "'" + text);
  }
  if (raster.impossible() > 0)
    notes.push_back("'" + name + "': " + std::to_string(raster.impossible()) +
                    " heights below -1000 m or above 10000 m are taken for no data");
}

}  // namespace

Site read_site_terrain(const TerrainRequest& request, const MapWork& work) {
  PlacedRaster surface(request.surface, request.surface_name, request.reference);
  Eigen::AlignedBox2d box = surface.box();
  if (request.only) box = box.intersection(*request.only);
  if (box.isEmpty())
    throw InputError("'" + request.surface_name + "': it does not reach into the region");
  surface.load(box);
  const HeightGrid heights = grid_of(surface, request.surface_name, box, request.resolution, work);
  Site site;
  site.name = request.surface_name;
  site.resolution = request.resolution;
  site.spacing = request.cell;
  const RasterInfo& info = surface.info();
  site.description = info.format + ", " + std::to_string(info.width) + " x " +
                     std::to_string(info.height) + " pixels";
  site.notes = surface.reference().notes;
  note_gaps(surface, heights, request.surface_name, site.notes);
  site.origin = surface.reference().origin;
  site.bounds = heights.bounds();
  site.solid = columns_of(heights, request.resolution);
  raise_to_crests(*site.solid, surface, request.surface_name, request.resolution, work);
  const int stride = std::max(1, static_cast<int>(std::lround(request.cell / request.resolution)));
  site.mesh = mesh_of_heights(heights, stride);
  if (site.mesh->triangles.empty())
    throw InputError("'" + request.surface_name +
                     "': its data in the region have gaps everywhere, "
                     "so that there is no surface between them");
  if (!request.ground) {
    site.ground = std::make_shared<HeightGrid>(heights);
    return site;
  }
  StatedReference same = request.reference;
  same.world = surface.reference().world;
  PlacedRaster ground(*request.ground, request.ground_name, same);
  ground.load(box);
  site.ground = std::make_shared<HeightGrid>(grid_of(
      ground, request.ground_name, box.intersection(ground.box()), request.resolution, work));
  note_gaps(ground, *site.ground, request.ground_name, site.notes);
  return site;
}

}  // namespace lapwing
