// SPDX-License-Identifier: Apache-2.0
#include "framework/export/film_strip.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/png.h"
#include "framework/export/film_view.h"
#include "framework/picture/render.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

constexpr int kFrameSize = 288;        // pixels, of the longer side
constexpr double kPersonHeight = 1.8;  // m, of a subject that states none
constexpr double kSlender = 3.6;       // height over width of a subject that states no width
constexpr Color kGround{0.60, 0.61, 0.54};
constexpr Color kSubjects[] = {{0.88, 0.36, 0.12}, {0.16, 0.45, 0.78}, {0.55, 0.24, 0.62},
                               {0.85, 0.66, 0.08}, {0.12, 0.56, 0.44}, {0.80, 0.25, 0.42}};
constexpr Color kObstacles[] = {{0.62, 0.60, 0.58}, {0.68, 0.62, 0.54}, {0.56, 0.60, 0.62}};

// As it is drawn: a person where the plan leaves its size open.
UprightCylinderShape body_of(const Subject& subject, double time) {
  UprightCylinderShape shape{subject.position(time), subject.height, subject.width};
  if (!(shape.height > 0)) shape.height = kPersonHeight;
  if (!(shape.width > 0)) shape.width = shape.height / kSlender;
  return shape;
}

// The ground is z = 0, unless the flight or a subject goes below it.
double ground_of(const Plan& plan) {
  double ground = 0;
  for (const Sample& s : plan.trajectory.samples) ground = std::min(ground, s.position.z() - 1);
  for (const Subject& subject : plan.environment.subjects) {
    for (const Eigen::Vector3d& p : subject.positions) {
      ground = std::min(ground, p.z() - subject.height / 2);
    }
  }
  return ground;
}

// A shape where it has moved to.
class MovedBody final : public RayBody {
 public:
  MovedBody(std::shared_ptr<const Shape> shape, const Eigen::Vector3d& moved)
      : shape_(std::move(shape)), moved_(moved) {}
  std::optional<SurfaceHit> hit(const Eigen::Vector3d& origin,
                                const Eigen::Vector3d& direction) const override {
    return shape_->hit(origin - moved_, direction);
  }
  Eigen::AlignedBox3d bounds() const override {
    return {shape_->bounds().min() + moved_, shape_->bounds().max() + moved_};
  }

 private:
  std::shared_ptr<const Shape> shape_;
  Eigen::Vector3d moved_;
};

std::vector<Body> bodies_at(const Plan& plan, double time) {
  std::vector<Body> bodies;
  const auto add = [&bodies](const Body& body) {
    if (drawable(body.shape)) bodies.push_back(body);
  };
  add({GroundShape{ground_of(plan)}, kGround});
  const Environment& environment = plan.environment;
  std::vector<Eigen::Vector3d> middles;
  for (const Subject& subject : environment.subjects) {
    add({body_of(subject, time), kSubjects[middles.size() % std::size(kSubjects)]});
    middles.push_back(subject.position(time));
  }
  std::size_t count = 0;
  for (const Obstacle& obstacle : environment.obstacles) {
    if (obstacle.side == Side::keep_inside || !obstacle.shape) continue;
    const Color& color = kObstacles[count++ % std::size(kObstacles)];
    const Eigen::Vector3d moved = obstacle.moved(time);
    const Shape& shape = *obstacle.shape;
    const bool holds_one =
        shape.solid() && std::any_of(middles.begin(), middles.end(), [&](const auto& p) {
          return shape.distance(p - moved, nullptr) < 0;
        });
    TracedShape traced{obstacle.shape};
    if (!obstacle.still()) traced.body = std::make_shared<MovedBody>(obstacle.shape, moved);
    add({traced, color, holds_one || !obstacle.opaque});
  }
  return bodies;
}

// Shares of the image, from its upper left corner.
std::vector<FrameBox> boxes_of(const Plan& plan, const CameraView& view, double time) {
  std::vector<FrameBox> boxes;
  for (const std::size_t i : subjects_at(plan, time)) {
    const Subject& subject = plan.environment.subjects[i];
    const UprightCylinderShape body = body_of(subject, time);
    const auto box = view.box_of(body.middle, body.height, body.width);
    if (!box) continue;
    const auto across = [&](double x) { return (x + 0.5) / view.pinhole.width; };
    const auto down = [&](double y) { return (y + 0.5) / view.pinhole.height; };
    boxes.push_back(
        {subject.name, across(box->left), down(box->top), across(box->right), down(box->bottom)});
  }
  return boxes;
}

std::string caption_of(const Plan& plan, double time) {
  std::string caption = number_text(time, 3) + " s";
  for (std::size_t i = 0; i < plan.task.keyframes.size(); ++i) {
    if (std::abs(plan.task.keyframes[i].time - time) > 1e-9) continue;
    caption += " \u00b7 keyframe " + std::to_string(i + 1);
  }
  if (plan.environment.subjects.size() < 2) return caption;
  for (const std::size_t i : subjects_at(plan, time)) {
    caption += " \u00b7 " + plan.environment.subjects[i].name;
  }
  return caption;
}

}  // namespace

std::vector<double> strip_times(const Plan& plan, int count) {
  const auto& samples = plan.trajectory.samples;
  if (samples.empty() || count < 1) return {};
  const double start = samples.front().time,
               spacing = count > 1 ? plan.trajectory.duration() / (count - 1) : 0;
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    double time = std::min(start + i * spacing, samples.back().time);
    const double even = time;
    for (const KeyframeTask& keyframe : plan.task.keyframes) {
      const bool nearer = time == even || std::abs(keyframe.time - even) < std::abs(time - even);
      if (nearer && std::abs(keyframe.time - even) < spacing / 3 && keyframe.time >= start &&
          keyframe.time <= samples.back().time) {
        time = keyframe.time;
      }
    }
    if (!in_cut(plan, time) && (times.empty() || time > times.back())) times.push_back(time);
  }
  return times;
}

FilmStrip film_strip(const Plan& plan, const Vehicle& vehicle, const std::vector<double>& times) {
  FilmStrip strip{"What the camera films", {}};
  const Pinhole pinhole = vehicle.camera.pinhole().fitted(kFrameSize, kFrameSize);
  for (const double time : times) {
    const CameraView view = view_of(sample_at(plan.trajectory, time), pinhole);
    const Picture picture = Renderer(bodies_at(plan, time)).picture(view);
    strip.frames.push_back({encode_png(picture), picture.width, picture.height,
                            caption_of(plan, time), boxes_of(plan, view, time)});
  }
  return strip;
}

std::string film_frame(const Plan& plan, const Vehicle& vehicle, double time, int most_across,
                       int most_down) {
  const auto& samples = plan.trajectory.samples;
  if (samples.empty() || !(time >= samples.front().time && time <= samples.back().time))
    throw InputError("there is no frame at " + number_text(time, 6) +
                     " s: the flight does not last until then");
  const Pinhole pinhole = vehicle.camera.pinhole().fitted(most_across, most_down);
  const CameraView view = view_of(sample_at(plan.trajectory, time), pinhole);
  return encode_png(Renderer(bodies_at(plan, time)).picture(view));
}

}  // namespace lapwing
