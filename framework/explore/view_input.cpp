// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/view_input.h"

#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "framework/explore/ground_truth.h"

namespace lapwing {

std::size_t numbers_of(const ViewInput& input) {
  return std::visit([](const auto& shape) { return shape.size(); }, input);
}

std::size_t targets_of(const ViewInput& input) {
  const auto* rays = std::get_if<RayShape>(&input);
  return rays ? static_cast<std::size_t>(rays->rays()) : 1;
}

Value to_value(const ViewInput& input) {
  Value value = Value::map();
  if (const auto* rays = std::get_if<RayShape>(&input))
    value.set("rays", to_value(*rays));
  else
    value.set("grid", to_value(std::get<GridShape>(input)));
  return value;
}

ViewInput view_input_from(const Value& value) {
  Diagnostics errors;
  Fields fields(value, "input", errors);
  const bool rays = fields.has("rays");
  const Value shape = fields.opaque(rays ? "rays" : "grid");
  fields.finish();
  errors.throw_if_any();
  if (rays) return ray_shape_from(shape);
  return grid_shape_from(shape);
}

void sample_view(const EpisodeView& known, const Viewpoint& view, const ViewInput& input,
                 std::span<float> numbers) {
  if (const auto* rays = std::get_if<RayShape>(&input))
    sample_rays(known, view, *rays, numbers);
  else
    sample_grid(known, view, std::get<GridShape>(input), numbers);
}

void view_targets(const ObservedSurface& observed, const Viewpoint& view, const Pinhole& pinhole,
                  const ViewInput& input, std::span<float> targets) {
  if (targets.size() != targets_of(input)) throw Error("targets of another number");
  const auto* rays = std::get_if<RayShape>(&input);
  if (!rays) {
    targets[0] = static_cast<float>(observed.gain(view));
    return;
  }
  std::fill(targets.begin(), targets.end(), 0.0f);
  const Eigen::Matrix3d to_camera = view.camera().orientation.toRotationMatrix().transpose();
  observed.each_gain(view, [&](const Eigen::Vector3d& p_W, double gain) {
    const int cell = ray_cell(*rays, pinhole, to_camera * (p_W - view.position));
    targets[static_cast<std::size_t>(cell)] += static_cast<float>(gain);
  });
}

}  // namespace lapwing
