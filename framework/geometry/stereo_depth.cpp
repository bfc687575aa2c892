// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/stereo_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "framework/core/error.h"
#include "framework/core/parallel.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kSky = 0.9;      // brightness
constexpr double kClouds = 0.1;   // share of it that clouds take or add: without them no far shift
constexpr double kCloudsAt = 20;  // m, where a cloud's bumps would be as wide as those of a wall
constexpr double kFinest = 0.05;  // m, wavelength of the texture's smallest bumps
constexpr int kOctaves = 7;       // each twice as long as the one before
constexpr int kFine = 2;          // rays a pixel, across and down

// A number in [-1, 1] that belongs to a corner of the grid.
double corner_value(std::int64_t x, std::int64_t y, std::int64_t z, int octave) {
  std::uint64_t h = static_cast<std::uint64_t>(octave) + 1;
  for (const std::int64_t v : {x, y, z}) {
    h = (h ^ static_cast<std::uint64_t>(v)) * 0x9e3779b97f4a7c15ULL;
    h ^= h >> 31;
  }
  h *= 0xbf58476d1ce4e5b9ULL;
  return static_cast<double>(h >> 11) * 0x1p-52 - 1;
}

// Smooth between the corners.
double bumps(const Vector3d& p, int octave) {
  const Vector3d base = p.array().floor();
  Vector3d s = p - base;
  s = s.array() * s.array() * (3 - 2 * s.array());
  const auto x = static_cast<std::int64_t>(base.x()), y = static_cast<std::int64_t>(base.y()),
             z = static_cast<std::int64_t>(base.z());
  double sum = 0;
  for (int k = 0; k < 8; ++k) {
    const int i = k & 1, j = k >> 1 & 1, l = k >> 2;
    sum += (i ? s.x() : 1 - s.x()) * (j ? s.y() : 1 - s.y()) * (l ? s.z() : 1 - s.z()) *
           corner_value(x + i, y + j, z + l, octave);
  }
  return sum;
}

// Bumps that a pixel of this width cannot show would only flicker.
double texture(const Vector3d& p, double pixel_width) {
  double sum = 0, weights = 0;
  for (int octave = 0; octave < kOctaves; ++octave) {
    const double wavelength = kFinest * (1 << octave);
    if (wavelength < 1.5 * pixel_width && octave + 1 < kOctaves) continue;
    sum += bumps(p / wavelength, octave);
    weights += 1;
  }
  return sum / std::sqrt(weights);
}

class Painter {
 public:
  Painter(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole, double range,
          double clouds)
      : scene_(scene),
        position_(camera.position),
        to_world_(camera.orientation.toRotationMatrix()),
        pinhole_(pinhole),
        range_(range),
        clouds_(clouds) {}

  std::uint8_t pixel(int x, int y) const {
    double sum = 0;
    for (int k = 0; k < kFine * kFine; ++k) {
      sum += brightness(x + (k % kFine + 0.5) / kFine - 0.5, y + (k / kFine + 0.5) / kFine - 0.5);
    }
    return static_cast<std::uint8_t>(std::lround(255 * sum / (kFine * kFine)));
  }

 private:
  double brightness(double x, double y) const {
    const Vector3d ray = pixel_ray(pinhole_, x, y);
    const double length = ray.norm();
    const Vector3d direction = to_world_ * (ray / length);
    const MeshHit hit = scene_.cast({position_, direction, range_ * length});
    if (hit.triangle < 0) return sky(direction);
    const Vector3d p = position_ + hit.distance * direction;
    const double pixel_width = hit.distance / length / pinhole_.focal_x;
    // The light comes from above and stays where it is when the camera moves.
    const double light = 0.55 + 0.25 * hit.normal.z() + 0.1 * hit.normal.x();
    return std::clamp(tone(hit.triangle) * light * (1 + 0.6 * texture(p, pixel_width)), 0.0, 1.0);
  }

  // It belongs to directions alone: infinitely far, so that both pictures show the same.
  double sky(const Vector3d& direction) const {
    if (clouds_ == 0) return kSky;
    const double bumps = texture(kCloudsAt * direction, kCloudsAt / pinhole_.focal_x);
    return std::clamp(kSky * (1 + clouds_ * bumps), 0.0, 1.0);
  }

  double tone(int triangle) const {
    const auto& colors = scene_.mesh().colors;
    if (colors.empty()) return 0.7;
    const Rgb& c = colors[static_cast<std::size_t>(triangle)];
    return 0.25 + 0.6 * (0.3 * c[0] + 0.6 * c[1] + 0.1 * c[2]) / 255;
  }

  const MeshScene& scene_;
  Vector3d position_;
  Eigen::Matrix3d to_world_;
  const Pinhole& pinhole_;
  double range_, clouds_;
};

GreyPicture paint(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole, double range,
                  double clouds, int threads) {
  check_camera(pinhole, range);
  const Painter painter(scene, camera, pinhole, range, clouds);
  GreyPicture picture{pinhole.width, pinhole.height, {}};
  const auto width = static_cast<std::size_t>(pinhole.width);
  picture.pixels.resize(width * static_cast<std::size_t>(pinhole.height));
  parallel_for(static_cast<std::size_t>(pinhole.height), threads, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      picture.pixels[y * width + x] = painter.pixel(static_cast<int>(x), static_cast<int>(y));
    }
  });
  return picture;
}

// The picture right of a border of `left` columns that repeat its first: OpenCV leaves out as many
// columns as it looks for shifts, though far things there are in both pictures.
cv::Mat image_of(const GreyPicture& picture, int left) {
  cv::Mat image(picture.height, left + picture.width, CV_8UC1);
  const auto width = static_cast<std::size_t>(picture.width);
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* row = picture.pixels.data() + static_cast<std::size_t>(y) * width;
    std::fill_n(image.ptr(y), left, row[0]);
    std::copy_n(row, width, image.ptr(y) + left);
  }
  return image;
}

// Whether brightness changes along the row in a square about a pixel: by a grey level a pixel.
bool textured(const GreyPicture& picture, int x, int y, int block) {
  const int half = std::max(block / 2, 1);
  int change = 0, pairs = 0;
  for (int j = std::max(y - half, 0); j <= std::min(y + half, picture.height - 1); ++j)
    for (int i = std::max(x - half, 0); i < std::min(x + half, picture.width - 1); ++i) {
      const std::uint8_t* pixel = picture.pixels.data() + j * picture.width + i;
      change += std::abs(pixel[1] - pixel[0]);
      ++pairs;
    }
  return change >= pairs;
}

void check_options(const Pinhole& pinhole, const StereoOptions& options) {
  if (!(options.baseline > 0 && std::isfinite(options.baseline))) {
    throw InputError("the baseline of a stereo camera must be above 0 m");
  }
  if (!(options.nearest > 0 && std::isfinite(options.nearest))) {
    throw InputError("the nearest distance of a stereo camera must be above 0 m");
  }
  if (options.block < 1 || options.block > 31 || options.block % 2 == 0) {
    throw InputError("the block of a stereo camera must be odd, from 1 to 31 pixels");
  }
  if (pinhole.focal_x * options.baseline / options.nearest >= pinhole.width) {
    throw InputError("a stereo camera cannot see as near as " + std::to_string(options.nearest) +
                     " m: at that distance the two images do not overlap");
  }
}

}  // namespace

GreyPicture render_textured(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                            double range, int threads) {
  return paint(scene, camera, pinhole, range, 0, threads);
}

DepthImage match_stereo(const GreyPicture& left, const GreyPicture& right, const Pinhole& pinhole,
                        const StereoOptions& options) {
  check_options(pinhole, options);
  const std::size_t count =
      static_cast<std::size_t>(pinhole.width) * static_cast<std::size_t>(pinhole.height);
  for (const GreyPicture* picture : {&left, &right}) {
    if (picture->width == pinhole.width && picture->height == pinhole.height &&
        picture->pixels.size() == count) {
      continue;
    }
    throw InputError("a stereo picture of " + std::to_string(picture->width) + " by " +
                     std::to_string(picture->height) + " pixels for a camera of " +
                     std::to_string(pinhole.width) + " by " + std::to_string(pinhole.height));
  }
  const double scale = pinhole.focal_x * options.baseline;
  const int shifts = 16 * static_cast<int>(std::ceil((scale / options.nearest + 1) / 16));
  const int smooth = options.block * options.block;
  cv::Mat shift;
  const auto matcher = cv::StereoSGBM::create(0, shifts, options.block, 8 * smooth, 32 * smooth, 1,
                                              31, 10, 50, 2, cv::StereoSGBM::MODE_SGBM);
  // In sixteenths of a pixel.
  matcher->compute(image_of(left, shifts), image_of(right, shifts), shift);
  DepthImage image{pinhole, std::vector<float>(count, 0)};
  for (int y = 0; y < pinhole.height; ++y) {
    for (int x = 0; x < pinhole.width; ++x) {
      const double pixels = shift.at<std::int16_t>(y, shifts + x) / 16.0;
      // Below 0 is no match; 0 is one of things infinitely far, or of none: where all shifts are as
      // good, the matcher names the least.
      if (pixels < 0 || pixels > x || scale / pixels < options.nearest) continue;
      if (pixels == 0 && !textured(left, x, y, options.block)) continue;
      const auto place = static_cast<std::size_t>(y) * static_cast<std::size_t>(pinhole.width);
      image.depth[place + static_cast<std::size_t>(x)] = static_cast<float>(scale / pixels);
    }
  }
  return image;
}

DepthImage stereo_depth(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                        double range, const StereoOptions& options, int threads) {
  check_options(pinhole, options);
  Pose other = camera;
  other.position += camera.orientation * Vector3d(options.baseline, 0, 0);
  // What lies beyond the range shows, so that it is matched rather than taken for something near.
  const double seen = 2 * range;
  DepthImage image =
      match_stereo(paint(scene, camera, pinhole, seen, kClouds, threads),
                   paint(scene, other, pinhole, seen, kClouds, threads), pinhole, options);
  // A match beyond the range is a measurement: nothing was found within it.
  for (float& depth : image.depth)
    if (depth > range) depth = std::numeric_limits<float>::infinity();
  return image;
}

}  // namespace lapwing
