// SPDX-License-Identifier: Apache-2.0
// Points of a trajectory problem that are made of another trajectory.
#include "framework/core/plugin_object.h"
#include "framework/problem/trajectory_problem_impl.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
Stages TrajectoryProblem::point_of(const Trajectory& trajectory) const {
  const StageColumns& columns = impl_->columns;
  const StageLayout& layout = columns.layout;
  const int target = layout.find("target");
  const bool aimed = trajectory.has_target && target >= 0 && layout.block(target).size == 3;
  const double begin = trajectory.samples.front().time, duration = trajectory.duration();
  const double here = columns.horizon.duration();
  Stages at = initial_guess();
  for (int i = 0; i < columns.horizon.stages; ++i) {
    const double share = here > 0 ? std::min(1.0, columns.horizon.time(i) / here) : 0.0;
    Sample sample = sample_at(trajectory, begin + share * duration);
    if (here > 0) {
      const double middle = columns.horizon.time(i) + 0.5 * columns.horizon.step_after(i);
      smooth_held_inputs(trajectory, begin + middle / here * duration, sample);
    }
    for (const BoundModel& model : columns.models) {
      std::vector<double> numbers(model.states + model.inputs);
      in_plugin(*model.model, "from_sample",
                [&] { model.model->from_sample(sample, numbers.data()); });
      const double* from = numbers.data();
      for (const auto* blocks : {&model.state_blocks, &model.input_blocks})
        for (const int b : *blocks) {
          const int size = layout.block(b).size;
          std::copy_n(from, size, at.col(i).data() + layout.offset(b));
          from += size;
        }
    }
    if (aimed) at.col(i).segment<3>(layout.offset(target)) = sample.target;
  }
  return at;
}

}  // namespace lapwing
