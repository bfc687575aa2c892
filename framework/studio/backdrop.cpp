// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/backdrop.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/studio/file_look.h"
#include "framework/survey/reference_system.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr double kMostPixels = 0x1p23;  // 32 MiB
constexpr int kMostAcross = 4096;       // pixels: what every graphics processor takes
constexpr double kLeastAround = 300;    // m, around the scene
constexpr int kEdgeSamples = 16;        // along each side of a box
constexpr int kMostCells = 64;          // along each side
constexpr double kGoodEnough = 0.1;     // pixels

[[noreturn]] void refuse_backdrop(const fs::path& file, const std::string& why) {
  throw InputError("'" + file.string() + "': " + why);
}

// Between pixels of a raster and places of the world.
class PlacedPixels {
 public:
  PlacedPixels(const fs::path& file, RasterLook look, const GeodeticOrigin& origin)
      : look_(std::move(look)),
        system_(system_in(file, look_)),
        origin_(origin.point()),
        to_pixels_(look_.to_coordinates.inverse()) {}

  // Of a backdrop the heights are left aside: 100 m move a place 1 km away by 2 cm.
  static ReferenceSystem system_in(const fs::path& file, const RasterLook& look) {
    if (look.system.empty())
      refuse_backdrop(file,
                      "it states no reference system, so that its place on the earth is not known. "
                      "State it, as gdal_edit.py -a_srs EPSG:... FILE does");
    return ReferenceSystem::of(look.system).horizontal();
  }

  Vector2d world_of(const Vector2d& pixel) const {
    const Vector2d p = look_.to_coordinates * pixel;
    GeodeticPoint there = system_.to_geodetic({p.x(), p.y(), 0});
    there.altitude = origin_.altitude;
    return to_local(origin_, there).head<2>();
  }

  Vector2d pixel_of(const Vector2d& place) const {
    const GeodeticPoint there = to_geodetic(origin_, {place.x(), place.y(), 0});
    return to_pixels_ *
           system_.from_geodetic({there.latitude_deg, there.longitude_deg, 0}).head<2>().eval();
  }

  // The pixels that a box of the world needs; empty where it has none.
  RasterWindow window_of(const AlignedBox2d& box) const {
    AlignedBox2d pixels;
    const Vector2d low = box.min(), size = box.sizes();
    for (int k = 0; k <= kEdgeSamples; ++k) {
      const double t = k / static_cast<double>(kEdgeSamples);
      for (const Vector2d& share : {Vector2d(t, 0), Vector2d(t, 1), Vector2d(0, t), Vector2d(1, t)})
        pixels.extend(pixel_of(low + share.cwiseProduct(size)));
    }
    const auto within = [](double value, int most) {
      return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(most)));
    };
    RasterWindow window;
    window.column = within(std::floor(pixels.min().x()), look_.width);
    window.row = within(std::floor(pixels.min().y()), look_.height);
    window.width = within(std::ceil(pixels.max().x()), look_.width) - window.column;
    window.height = within(std::ceil(pixels.max().y()), look_.height) - window.row;
    return window;
  }

  const RasterLook& look() const { return look_; }
  const ReferenceSystem& system() const { return system_; }

 private:
  RasterLook look_;
  ReferenceSystem system_;
  GeodeticPoint origin_;
  Eigen::Affine2d to_pixels_;
};

std::string distance_in_words(double metres) {
  return metres < 1000 ? plain_number(std::round(metres)) + " m"
                       : plain_number(metres / 1000, 3) + " km";
}

// Where the raster's middle is, for somebody who expected it elsewhere.
std::string elsewhere(const PlacedPixels& pixels, const AlignedBox2d& box) {
  std::string where;
  try {
    const Vector2d middle =
        pixels.world_of({pixels.look().width / 2.0, pixels.look().height / 2.0});
    where = ", its middle " + distance_in_words((middle - box.center()).norm()) + " from there";
  } catch (const InputError&) {  // on the other side of the earth
  }
  return "it does not reach to the flight: it lies elsewhere by its reference system '" +
         pixels.system().name() + "'" + where +
         ". Name one of this place, or check origin.latitude_deg and origin.longitude_deg";
}

class CornerGrid {
 public:
  CornerGrid(const PlacedPixels& pixels, const RasterWindow& window)
      : pixels_(pixels), window_(window) {}

  // As few cells as are exact enough.
  void fill(PlacedPicture& picture) const {
    for (int cells = 1;; cells *= 2) {
      auto corners = corners_of(cells);
      if (cells < kMostCells && error_of(corners, cells) > kGoodEnough * picture.pixel) continue;
      picture.cells = cells;
      picture.corners = std::move(corners);
      return;
    }
  }

  Vector2d place(double across, double down) const {  // shares of the window
    return pixels_.world_of(
        {window_.column + across * window_.width, window_.row + down * window_.height});
  }

 private:
  std::vector<Vector2d> corners_of(int cells) const {
    std::vector<Vector2d> corners;
    for (int row = 0; row <= cells; ++row)
      for (int column = 0; column <= cells; ++column)
        corners.push_back(
            place(static_cast<double>(column) / cells, static_cast<double>(row) / cells));
    return corners;
  }

  // The largest, at the middles of cells and of their edges; m.
  double error_of(const std::vector<Vector2d>& corners, int cells) const {
    double most = 0;
    const auto at = [&](int column, int row) -> const Vector2d& {
      return corners[static_cast<std::size_t>(row * (cells + 1) + column)];
    };
    for (int row = 0; row < cells; ++row)
      for (int column = 0; column < cells; ++column)
        for (const auto& [right, down] : {std::pair{1, 1}, {1, 0}, {0, 1}}) {
          const Vector2d between = (at(column, row) + at(column + right, row + down)) / 2;
          const Vector2d there = place((column + right / 2.0) / cells, (row + down / 2.0) / cells);
          most = std::max(most, (between - there).norm());
        }
    return most;
  }

  const PlacedPixels& pixels_;
  const RasterWindow& window_;
};

PlacedPicture picture_of(const fs::path& file, const PlacedPixels& pixels,
                         const AlignedBox2d& around) {
  RasterWindow window;
  try {
    window = pixels.window_of(around);
  } catch (const InputError&) {  // the box lies outside of where the system is in use
    refuse_backdrop(file, elsewhere(pixels, around));
  }
  if (window.width < 1 || window.height < 1) refuse_backdrop(file, elsewhere(pixels, around));
  const double count = static_cast<double>(window.width) * window.height;
  const double smaller =
      std::max({1.0, std::sqrt(count / kMostPixels),
                static_cast<double>(std::max(window.width, window.height)) / kMostAcross});
  PlacedPicture picture;
  picture.width = std::max(1, static_cast<int>(window.width / smaller));
  picture.height = std::max(1, static_cast<int>(window.height / smaller));
  const CornerGrid grid(pixels, window);
  const double right = 0.5 / window.width, down = 0.5 / window.height;
  const Vector2d along = grid.place(0.5 + right, 0.5) - grid.place(0.5 - right, 0.5);
  const Vector2d across = grid.place(0.5, 0.5 + down) - grid.place(0.5, 0.5 - down);
  picture.pixel_of_file = std::min(along.norm(), across.norm());
  picture.pixel = std::min(along.norm() * window.width / picture.width,
                           across.norm() * window.height / picture.height);
  grid.fill(picture);
  picture.colours = raster_colours(file, window, picture.width, picture.height);
  return picture;
}

Value number_list(const std::vector<Vector2d>& places) {
  Value list = Value::list();
  for (const Vector2d& p : places) {
    list.push_back(p.x());
    list.push_back(p.y());
  }
  return list;
}

std::string blob_of_picture(const PlacedPicture& picture) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes = "WLP1";
  for (const int size : {picture.width, picture.height}) {
    const auto number = static_cast<std::uint32_t>(size);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  return bytes.append(reinterpret_cast<const char*>(picture.colours.data()),
                      picture.colours.size());
}

}  // namespace

RasterLook backdrop_look(const fs::path& file) {
  RasterLook look = raster_look(file);
  PlacedPixels::system_in(file, look);
  return look;
}

PlacedPicture placed_picture(const fs::path& file, const GeodeticOrigin& origin,
                             const AlignedBox2d& around) {
  return picture_of(file, PlacedPixels(file, raster_look(file), origin), around);
}

AlignedBox2d box_of_scene(const Plan& plan) {
  AlignedBox2d box;
  const auto add = [&](const Eigen::Vector3d& p) { box.extend(p.head<2>().eval()); };
  for (const Sample& sample : plan.trajectory.samples) add(sample.position);
  for (const Subject& subject : plan.environment.subjects)
    for (const Eigen::Vector3d& p : subject.positions) add(p);
  if (plan.task.scan && !plan.task.scan->region.is_empty()) {
    const Eigen::AlignedBox3d& region = plan.task.scan->region.bounds();
    add(region.min());
    add(region.max());
  }
  return box;
}

std::optional<Backdrop::Shown> Backdrop::shown_for(const fs::path& file, const Plan& plan) {
  const AlignedBox2d scene = box_of_scene(plan);
  if (scene.isEmpty()) return std::nullopt;
  const std::string looks = look_of(file);
  if (origin_ && looks == looks_ && plan.geodetic_origin == origin_ && around_.contains(scene))
    return std::nullopt;
  origin_.reset();  // what is refused is shown no longer
  if (!plan.geodetic_origin)
    throw InputError(
        "'" + file.string() +
        "': the mission does not say where it is on the earth. State the place of the world's "
        "origin: origin.latitude_deg, origin.longitude_deg, origin.height and origin.height_of");
  const double margin = std::max(kLeastAround, scene.sizes().maxCoeff());
  const AlignedBox2d around(scene.min() - Vector2d::Constant(margin),
                            scene.max() + Vector2d::Constant(margin));
  const PlacedPixels pixels(file, raster_look(file), *plan.geodetic_origin);
  const PlacedPicture picture = picture_of(file, pixels, around);
  looks_ = looks;
  origin_ = plan.geodetic_origin;
  around_ = around;
  Value members = Value::map();
  members.set("file", as_utf8(file.filename().string()));
  members.set("system", as_utf8(pixels.system().name()));
  members.set("heights", pixels.look().heights);
  members.set("width", std::int64_t{picture.width});
  members.set("height", std::int64_t{picture.height});
  members.set("pixel", picture.pixel);
  members.set("pixel_of_file", picture.pixel_of_file);
  members.set("cells", std::int64_t{picture.cells});
  members.set("corners", number_list(picture.corners));
  std::string text = to_json(members, -1);
  return Shown{text.substr(1, text.size() - 2), blob_of_picture(picture)};
}

}  // namespace lapwing
