// SPDX-License-Identifier: Apache-2.0
#include "framework/picture/render.h"

#include <algorithm>
#include <cmath>

#include "framework/picture/daylight.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kTint = 0.3;  // of a see-through body
constexpr int kFine = 3;       // samples across a pixel where something ends in it

Light linear(const Color& c) {
  return {linear_light(c.red), linear_light(c.green), linear_light(c.blue)};
}

// The integral of a square wave of +-1, which a difference of averages over a width.
double square_integral(double x) {
  // Rounding by conversion, which is quicker than std::floor where that is a call.
  const double phase = std::abs(x - 2 * static_cast<double>(static_cast<std::int64_t>(x / 2)));
  return phase < 1 ? phase : 2 - phase;
}

// Squares of +-1, averaged over a width in each direction.
double checkers(const Vector3d& p, const Eigen::Array2d& width, double size) {
  if (width.maxCoeff() > 16 * size) return 0;  // below 1/16 of what is a faint pattern anyway
  double value = 1;
  for (int i = 0; i < 2; ++i) {
    const double w = std::max(width[i] / size, 1e-6), x = p[i] / size;
    value *= (square_integral(x + w / 2) - square_integral(x - w / 2)) / w;
  }
  return value;
}

// A ray through a point of the picture.
struct PictureRay {
  Vector3d origin, direction;  // direction is a unit vector
  double pixels;               // that this ray stands for, across
};

// How far apart the points are where the rays one pixel to the right and down meet the ground, in x
// and y.
Eigen::Array2d ground_width(const CameraView& view, const PictureRay& ray, const Vector3d& p) {
  const Vector3d& right = view.axes.right;
  const Vector3d& down = view.axes.down;
  // Along the axis, so that a step of a pixel is a step of the direction.
  const Vector3d direction = ray.direction / view.axes.forward.dot(ray.direction);
  Eigen::Array2d width = Eigen::Array2d::Zero();
  for (const Vector3d& step :
       {Vector3d(right / view.pinhole.focal_x), Vector3d(down / view.pinhole.focal_y)}) {
    const Vector3d other = direction + step;
    if (other.z() * direction.z() <= 0) return Eigen::Array2d::Constant(1e6);
    const double distance = (p.z() - ray.origin.z()) / other.z();
    width = width.max((ray.origin + distance * other - p).head<2>().array().abs());
  }
  return width * ray.pixels;
}

struct Sample {
  Light light;
  int shape = -1;  // what the ray met; -1 is the sky, and shadows count as shapes of their own
};

class Painter {
 public:
  Painter(const Scene& solid, const std::vector<Color>& solid_colors, const Scene& see_through,
          const std::vector<Color>& see_through_colors, const CameraView& view)
      : solid_(solid),
        solid_colors_(solid_colors),
        see_through_(see_through),
        see_through_colors_(see_through_colors),
        view_(view) {}

  Sample sample(double x, double y, double pixels) const {
    const PictureRay ray{view_.position, view_.ray(x, y), pixels};
    const auto hit = solid_.cast(ray.origin, ray.direction);
    Sample sample{sky_light(ray.direction), -1};
    if (hit) sample = lit(*hit, ray);
    if (see_through_.shapes().empty()) return sample;
    const double farthest = hit ? hit->distance : std::numeric_limits<double>::infinity();
    const auto veil = see_through_.cast(ray.origin, ray.direction, farthest);
    if (!veil) return sample;
    const Light color = light_of(see_through_colors_[static_cast<std::size_t>(veil->shape)]);
    // More of it towards its outline, as with glass, so that its shape can be seen.
    const double facing = std::abs(veil->normal.dot(ray.direction));
    sample.light += kTint * (1.5 - facing) * (color * daylight(veil->normal, 1) - sample.light);
    sample.shape += 1'000'000;
    return sample;
  }

 private:
  static Light light_of(const Color& linear_color) {
    return {linear_color.red, linear_color.green, linear_color.blue};
  }

  Sample lit(const RayHit& hit, const PictureRay& ray) const {
    const Vector3d p = ray.origin + hit.distance * ray.direction;
    const auto index = static_cast<std::size_t>(hit.shape);
    Light color = light_of(solid_colors_[index]);
    if (std::holds_alternative<GroundShape>(solid_.shapes()[index])) {
      const Eigen::Array2d width = ground_width(view_, ray, p);
      color *= 1 + 0.1 * checkers(p, width, 1) + 0.16 * checkers(p, width, 10);
    }
    // Off the surface, by more than what rounding may have put the point behind it.
    const Vector3d start = p + 1e-9 * (1 + p.norm() + hit.distance) * hit.normal;
    const bool shadow = hit.normal.dot(towards_sun()) <= 0 || solid_.blocked(start, towards_sun());
    const Light light = color * daylight(hit.normal, shadow ? 0 : 1);
    return {through_haze(light, hit.distance), 2 * hit.shape + (shadow ? 1 : 0)};
  }

  const Scene& solid_;
  const std::vector<Color>& solid_colors_;
  const Scene& see_through_;
  const std::vector<Color>& see_through_colors_;
  const CameraView& view_;
};

// Pixels whose neighbours show something else.
std::vector<bool> outlines(const std::vector<Sample>& samples, int width, int height) {
  std::vector<bool> found(samples.size(), false);
  const auto compare = [&](std::size_t a, std::size_t b) {
    if (samples[a].shape != samples[b].shape) found[a] = found[b] = true;
  };
  const auto row = static_cast<std::size_t>(width);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if ((i + 1) % row != 0) compare(i, i + 1);
    if (i + row < row * static_cast<std::size_t>(height)) compare(i, i + row);
  }
  return found;
}

std::vector<BodyShape> shapes_of(const std::vector<Body>& bodies, bool see_through) {
  std::vector<BodyShape> shapes;
  for (const Body& body : bodies) {
    if (body.see_through == see_through) shapes.push_back(body.shape);
  }
  return shapes;
}

std::vector<Color> colors_of(const std::vector<Body>& bodies, bool see_through) {
  std::vector<Color> colors;
  for (const Body& body : bodies) {
    if (body.see_through != see_through) continue;
    const Light light = linear(body.color);
    colors.push_back({light.x(), light.y(), light.z()});
  }
  return colors;
}

}  // namespace

Renderer::Renderer(const std::vector<Body>& bodies)
    : solid_(shapes_of(bodies, false)),
      see_through_(shapes_of(bodies, true)),
      solid_colors_(colors_of(bodies, false)),
      see_through_colors_(colors_of(bodies, true)) {}

Picture Renderer::picture(const CameraView& view) const {
  const int width = view.pinhole.width, height = view.pinhole.height;
  check_picture_size(width, height);
  const Painter painter(solid_, solid_colors_, see_through_, see_through_colors_, view);
  std::vector<Sample> samples;
  samples.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) samples.push_back(painter.sample(x, y, 1));
  }
  const std::vector<bool> outline = outlines(samples, width, height);
  Picture picture{width, height, {}};
  picture.rgb.reserve(3 * samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Light light = samples[i].light;
    if (outline[i]) {
      const auto x = static_cast<double>(i % static_cast<std::size_t>(width));
      const auto y = static_cast<double>(i / static_cast<std::size_t>(width));
      light.setZero();
      for (int k = 0; k < kFine * kFine; ++k) {
        const double dx = (k % kFine + 0.5) / kFine - 0.5, dy = (k / kFine + 0.5) / kFine - 0.5;
        // What saturates does so before the mean is taken, or bright outlines would be jagged.
        light += painter.sample(x + dx, y + dy, 1.0 / kFine).light.min(1.0);
      }
      light /= kFine * kFine;
    }
    for (const double v : light) picture.rgb.push_back(encoded_light(v));
  }
  return picture;
}

}  // namespace lapwing
