// SPDX-License-Identifier: Apache-2.0
// What a learned utility is shown of a view, and what it is trained to tell of it.
#pragma once

#include <variant>

#include "framework/explore/ray_image.h"
#include "framework/explore/view_grid.h"

namespace lapwing {

class ObservedSurface;

// A grid around the camera has one target, the gain of the view (5.3). An image of rays has one for
// each ray: the part of that gain that its cell of the image shows.
using ViewInput = std::variant<GridShape, RayShape>;

std::size_t numbers_of(const ViewInput& input);  // that are shown
std::size_t targets_of(const ViewInput& input);
// {grid: {...}} or {rays: {...}}.
Value to_value(const ViewInput& input);
ViewInput view_input_from(const Value& value);

// `numbers` and `targets` have as many places as there are. The means of `known` must be refreshed
// for a grid. Thread-safe.
void sample_view(const EpisodeView& known, const Viewpoint& view, const ViewInput& input,
                 std::span<float> numbers);
void view_targets(const ObservedSurface& observed, const Viewpoint& view, const Pinhole& pinhole,
                  const ViewInput& input, std::span<float> targets);

}  // namespace lapwing
