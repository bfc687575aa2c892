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

constexpr const char* kImageEnd = ".depth.png";
constexpr const char* kPoseEnd = ".pose.txt";
constexpr const char* kCamera = "camera-intrinsics.txt";
constexpr double kMillimetres = 1000;   // a metre
constexpr std::uint16_t kNone = 65535;  // what many sensors write beside 0

[[noreturn]] void fail(const fs::path& file, const std::string& why) {
  throw InputError("'" + file.string() + "': " + why);
}

// A square matrix of finite numbers, apart by white space.
Eigen::MatrixXd read_matrix(const fs::path& file, int size) {
  const std::string text = read_file(file, 1 << 16);
  Eigen::MatrixXd matrix(size, size);
  int count = 0;
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
    if (count < size * size) matrix(count / size, count % size) = number;
    ++count;
  }
  if (count != size * size) {
    fail(file, "expected " + std::to_string(size) + " rows of " + std::to_string(size) +
                   " numbers, got " + std::to_string(count) + " numbers");
  }
  return matrix;
}

Pose read_pose(const fs::path& file) {
  const Eigen::Matrix4d m = read_matrix(file, 4);
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
  return {m.topRightCorner<3, 1>(), Eigen::Quaterniond(r).normalized()};
}

Grey16 read_image(const fs::path& file) {
  return decode_grey16_png(read_file(file), "'" + file.string() + "'");
}

// The frames, in order of their names; a pose without its image is a lost image.
std::vector<std::string> names_in(const fs::path& folder) {
  std::error_code error;
  std::vector<std::string> names, posed;
  fs::directory_iterator files(folder, error);
  if (error) fail(folder, "cannot be listed: " + error.message());
  for (const auto& entry : files) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(kImageEnd)) {
      names.push_back(name.substr(0, name.size() - std::string(kImageEnd).size()));
    } else if (name.ends_with(kPoseEnd)) {
      posed.push_back(name.substr(0, name.size() - std::string(kPoseEnd).size()));
    }
  }
  std::sort(names.begin(), names.end());
  std::sort(posed.begin(), posed.end());
  for (const std::string& name : posed) {
    if (std::binary_search(names.begin(), names.end(), name)) continue;
    if (names.empty()) break;
    fail(folder / (name + kPoseEnd), "its image " + name + kImageEnd + " is missing");
  }
  return names;
}

}  // namespace

DepthFolder::DepthFolder(const fs::path& folder) : folder_(folder), names_(names_in(folder)) {
  if (names_.empty()) fail(folder, std::string("holds no depth image (NAME") + kImageEnd + ")");
  const fs::path camera = folder / kCamera;
  const Eigen::Matrix3d k = read_matrix(camera, 3);
  const double other = std::max({std::abs(k(0, 1)), std::abs(k(1, 0)), std::abs(k(2, 0)),
                                 std::abs(k(2, 1)), std::abs(k(2, 2) - 1)});
  if (!(k(0, 0) > 0 && k(1, 1) > 0) || other > 1e-9) {
    fail(camera, "expected the rows: fx 0 cx, 0 fy cy, 0 0 1, with fx and fy above 0 pixels");
  }
  const Grey16 first = read_image(image_path(0));
  pinhole_ = {first.width, first.height, k(0, 0), k(1, 1), k(0, 2), k(1, 2)};
  if (!(k(0, 2) >= 0 && k(0, 2) < first.width && k(1, 2) >= 0 && k(1, 2) < first.height)) {
    fail(camera, "the principal point lies outside the images of " + std::to_string(first.width) +
                     " by " + std::to_string(first.height) + " pixels");
  }
  for (const std::string& name : names_) poses_.push_back(read_pose(folder / (name + kPoseEnd)));
}

fs::path DepthFolder::image_path(std::size_t frame) const {
  return folder_ / (names_[frame] + kImageEnd);
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
  std::transform(
      image.pixels.begin(), image.pixels.end(), posed.image.depth.begin(),
      [](std::uint16_t v) { return v == kNone ? 0.0f : static_cast<float>(v / kMillimetres); });
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
  write_file_atomically(folder / (name + kPoseEnd), pose + "0 0 0 1\n");
  write_file_atomically(folder / (name + kImageEnd), encode_grey16_png(image));
}

}  // namespace lapwing
