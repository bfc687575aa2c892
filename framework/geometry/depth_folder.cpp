// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/depth_folder.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/png.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCamera = "camera-intrinsics.txt";
constexpr double kMillimetres = 1000;   // a metre
constexpr std::uint16_t kNone = 65535;  // what many sensors write beside 0

[[noreturn]] void fail(const fs::path& file, const std::string& why) {
  throw InputError("'" + file.string() + "': " + why);
}

// Finite numbers, apart by white space.
std::vector<double> read_numbers(const fs::path& file) {
  const std::string text = read_file(file, 1 << 16);
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (;;) {
    at = std::find_if(at, end, [](unsigned char c) { return !std::isspace(c); });
    if (at == end) break;
    const char* const word = at;
    at = std::find_if(at, end, [](unsigned char c) { return std::isspace(c); });
    double number = 0;
    const auto [stop, error] = std::from_chars(*word == '+' ? word + 1 : word, at, number);
    if (error != std::errc{} || stop != at || !std::isfinite(number)) {
      fail(file, "'" + std::string(word, at) + "' is not a finite number");
    }
    numbers.push_back(number);
  }
  return numbers;
}

Eigen::MatrixXd square(const std::vector<double>& numbers, int size) {
  Eigen::MatrixXd matrix(size, size);
  for (int i = 0; i < size * size; ++i)
    matrix(i / size, i % size) = numbers[static_cast<std::size_t>(i)];
  return matrix;
}

Pose read_pose(const fs::path& file, bool to_camera) {
  const std::vector<double> numbers = read_numbers(file);
  if (numbers.size() != 16)
    fail(file, "expected 4 rows of 4 numbers, got " + std::to_string(numbers.size()) + " numbers");
  const Eigen::Matrix4d m = square(numbers, 4);
  const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
  const double skew =
      (r.transpose().lazyProduct(r) - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const double last = (m.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff();
  if (!(skew <= 1e-3) || r.determinant() < 0) {
    fail(file,
         "the upper left 3 x 3 numbers are no rotation (its columns must be unit vectors at "
         "right angles that make a right-handed frame)");
  }
  if (!(last <= 1e-6)) fail(file, "the last row must be 0 0 0 1");
  const Eigen::Quaterniond q = Eigen::Quaterniond(r).normalized();
  const Eigen::Vector3d t = m.topRightCorner<3, 1>();
  if (to_camera) return {q.conjugate() * -t, q.conjugate()};
  return {t, q};
}

Grey16 read_image(const fs::path& file) {
  return decode_grey16_png(read_file(file), "'" + file.string() + "'");
}

// "depth/*.png" as its folder, what is before the star and what is after it.
struct NamePattern {
  NamePattern(const std::string& text, const char* what) {
    const std::size_t slash = text.rfind('/'), star = text.find('*');
    if (star == std::string::npos || text.find('*', star + 1) != std::string::npos ||
        (slash != std::string::npos && star < slash)) {
      throw InputError("the names of " + std::string(what) + ", '" + text +
                       "', must contain one * in the name of the file, as \"depth/*.png\"");
    }
    const std::size_t name = slash == std::string::npos ? 0 : slash + 1;
    folder = text.substr(0, name);
    before = text.substr(name, star - name);
    after = text.substr(star + 1);
  }
  std::string file(const std::string& name) const { return folder + before + name + after; }
  // The frames whose files a folder has, in the order of their names.
  std::vector<std::string> frames_in(const fs::path& root) const {
    std::error_code error;
    std::vector<std::string> names;
    const fs::path place = folder.empty() ? root : root / folder;
    fs::directory_iterator files(place, error);
    if (error) fail(place, "cannot be listed: " + error.message());
    for (const auto& entry : files) {
      const std::string name = entry.path().filename().string();
      if (name.size() <= before.size() + after.size() || !name.starts_with(before) ||
          !name.ends_with(after)) {
        continue;
      }
      names.push_back(name.substr(before.size(), name.size() - before.size() - after.size()));
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  std::string folder, before, after;
};

// The frames; a pose without its image is a lost image.
std::vector<std::string> names_in(const fs::path& folder, const DepthLayout& layout) {
  const NamePattern images(layout.depth, "depth images"), poses(layout.pose, "poses");
  std::vector<std::string> names = images.frames_in(folder);
  if (names.empty()) fail(folder, "holds no depth image (" + images.file("NAME") + ")");
  for (const std::string& name : poses.frames_in(folder)) {
    if (std::binary_search(names.begin(), names.end(), name)) continue;
    fail(folder / poses.file(name), "its image " + images.file(name) + " is missing");
  }
  for (const std::string& name : names) {
    if (fs::exists(folder / poses.file(name))) continue;
    fail(folder / images.file(name), "its pose " + poses.file(name) + " is missing");
  }
  return names;
}

// Focal lengths and principal point; `file` is where they are stated.
Eigen::Vector4d read_camera(const fs::path& file) {
  const std::vector<double> numbers = read_numbers(file);
  const int size = numbers.size() == 16 ? 4 : 3;
  if (numbers.size() != 16 && numbers.size() != 9)
    fail(file, "expected 3 rows of 3 numbers, got " + std::to_string(numbers.size()) + " numbers");
  Eigen::MatrixXd k = square(numbers, size);
  const Eigen::Vector4d camera(k(0, 0), k(1, 1), k(0, 2), k(1, 2));
  k(0, 0) = k(1, 1) = 1;
  k(0, 2) = k(1, 2) = 0;
  if ((k - Eigen::MatrixXd::Identity(size, size)).cwiseAbs().maxCoeff() > 1e-9)
    fail(file, "expected the rows: fx 0 cx, 0 fy cy, 0 0 1, with fx and fy above 0 pixels");
  return camera;
}

void check_camera(const Pinhole& p, const fs::path& file) {
  if (!(p.focal_x > 0 && p.focal_y > 0))
    fail(file, "expected the rows: fx 0 cx, 0 fy cy, 0 0 1, with fx and fy above 0 pixels");
  if (!(p.principal_x >= 0 && p.principal_x < p.width && p.principal_y >= 0 &&
        p.principal_y < p.height)) {
    fail(file, "the principal point lies outside the images of " + std::to_string(p.width) +
                   " by " + std::to_string(p.height) + " pixels");
  }
}

}  // namespace

DepthFolder::DepthFolder(const fs::path& folder, const DepthLayout& layout)
    : folder_(folder), layout_(layout), names_(names_in(folder, layout)) {
  if (!(layout.unit > 0 && std::isfinite(layout.unit)))
    throw InputError("the unit of depth images must be above 0 m");
  const fs::path stated = layout.camera ? folder : folder / layout.intrinsics;
  const Eigen::Vector4d k = layout.camera ? *layout.camera : read_camera(stated);
  const Grey16 first = read_image(image_path(0));
  pinhole_ = {first.width, first.height, k[0], k[1], k[2], k[3]};
  check_camera(pinhole_, stated);
  const NamePattern poses(layout.pose, "poses");
  for (const std::string& name : names_)
    poses_.push_back(read_pose(folder / poses.file(name), layout.poses_to_camera));
}

fs::path DepthFolder::image_path(std::size_t frame) const {
  return folder_ / NamePattern(layout_.depth, "depth images").file(names_[frame]);
}

PosedDepthImage DepthFolder::read(std::size_t frame) const {
  const Grey16 image = read_image(image_path(frame));
  if (image.width != pinhole_.width || image.height != pinhole_.height) {
    fail(image_path(frame), "an image of " + std::to_string(image.width) + " by " +
                                std::to_string(image.height) + " pixels among those of " +
                                std::to_string(pinhole_.width) + " by " +
                                std::to_string(pinhole_.height));
  }
  PosedDepthImage posed{poses_[frame], {pinhole_, std::vector<float>(image.pixels.size())}};
  // Division by the counts of a metre, where there is a whole number of them, rounds once.
  const double counts = std::round(1 / layout_.unit);
  const bool whole = std::abs(counts * layout_.unit - 1) < 1e-12;
  std::transform(
      image.pixels.begin(), image.pixels.end(), posed.image.depth.begin(), [&](std::uint16_t v) {
        return v == kNone ? 0.0f : static_cast<float>(whole ? v / counts : v * layout_.unit);
      });
  return posed;
}

void write_depth_frame(const fs::path& folder, const std::string& name,
                       const PosedDepthImage& frame) {
  const Pinhole& p = frame.image.pinhole;
  Grey16 image{p.width, p.height, {}};
  for (const float depth : frame.image.depth) {
    const double v = std::round(kMillimetres * static_cast<double>(depth));
    image.pixels.push_back(v > 0 && v < kNone ? static_cast<std::uint16_t>(v) : 0);
  }
  const Eigen::Matrix3d r = frame.camera.orientation.toRotationMatrix();
  std::string pose;
  char row[160];
  for (int i = 0; i < 3; ++i) {
    std::snprintf(row, sizeof row, "%.17g %.17g %.17g %.17g\n", r(i, 0), r(i, 1), r(i, 2),
                  frame.camera.position[i]);
    pose += row;
  }
  std::string camera;
  std::snprintf(row, sizeof row, "%.17g 0 %.17g\n", p.focal_x, p.principal_x);
  camera += row;
  std::snprintf(row, sizeof row, "0 %.17g %.17g\n0 0 1\n", p.focal_y, p.principal_y);
  camera += row;
  write_file_atomically(folder / kCamera, camera);
  write_file_atomically(folder / (name + ".pose.txt"), pose + "0 0 0 1\n");
  write_file_atomically(folder / (name + ".depth.png"), encode_grey16_png(image));
}

}  // namespace lapwing
