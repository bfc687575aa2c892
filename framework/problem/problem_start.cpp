// SPDX-License-Identifier: Apache-2.0
// Where a trajectory problem begins from another trajectory: points made of it, stages held to it.
#include <algorithm>
#include <limits>

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
    const double share =
        here > 0 ? std::min(1.0, (columns.horizon.time(i) - columns.horizon.begin) / here) : 0.0;
    Sample sample = sample_at(trajectory, begin + share * duration);
    if (here > 0) {
      const double middle =
          columns.horizon.time(i) - columns.horizon.begin + 0.5 * columns.horizon.step_after(i);
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

void TrajectoryProblem::continue_from(Stages before, int held) {
  impl_->expect_unfinished();
  if (held < 1 || held > before.cols() || before.cols() > impl_->columns.horizon.stages)
    throw InputError("continue_from: " + std::to_string(held) + " stages of " +
                     std::to_string(before.cols()) + " cannot be held in " +
                     std::to_string(impl_->columns.horizon.stages));
  if (impl_->columns.horizon.step_free)
    throw InputError("continue_from: a flight with free steps cannot be continued");
  impl_->before = std::move(before);
  impl_->held = held;
}

// Inputs are held before the last held stage, free blocks in all of them, states in the first one:
// the others follow from the motion. What cannot change any more is bound by nothing else: rounding
// must not make it contradict the motion or a limit.
void TrajectoryProblem::Impl::hold_stages() {
  if (held == 0) return;
  const StageLayout& layout = columns.layout;
  if (before.rows() != layout.size())
    throw InputError("continue_from: the flight before has stages of " +
                     std::to_string(before.rows()) + " numbers, this one of " +
                     std::to_string(layout.size()));
  bound_owners.push_back("flight before");
  const int owner = static_cast<int>(bound_owners.size()) - 1;
  std::vector<bool> decided(columns.total(), false);
  for (int b = 0; b < layout.count(); ++b) {
    const BlockSpec& block = layout.block(b);
    if (block.role == BlockRole::clock) continue;
    if (block.topology != Topology::line)
      throw InputError("continue_from: block '" + block.name + "' is an orientation");
    const bool state = block.role == BlockRole::state;
    const int stages = block.role == BlockRole::input ? held - 1 : held;
    for (int stage = 0; stage < stages; ++stage)
      for (int i = 0; i < block.size; ++i) {
        const int column = columns.column(stage, layout.tangent_offset(b) + i);
        const double value = before(layout.offset(b) + i, stage);
        ColumnBound& bound = bounds[column];
        decided[column] = true;
        if (bound.lower == bound.upper) continue;  // it never moves
        bound = state && stage > 0 ? ColumnBound{} : ColumnBound{value, value, owner, owner};
      }
  }
  for (ConstraintEntry& entry : constraints)
    if (!entry.is_bounds) release_rows(entry, decided);
}

// Rows of a constraint that read decided columns alone.
void TrajectoryProblem::Impl::release_rows(ConstraintEntry& entry,
                                           const std::vector<bool>& decided) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const BoundFunction& bound = *entry.bound;
  for (int k = 0; k < bound.instances(); ++k) {
    bool all = true;
    for (int c = 0; c < bound.width(); ++c)
      all &= bound.columns(k)[c] < 0 || decided[bound.columns(k)[c]];
    if (!all) continue;
    std::fill_n(entry.lower.begin() + k * bound.rows(), bound.rows(), -kNone);
    std::fill_n(entry.upper.begin() + k * bound.rows(), bound.rows(), kNone);
  }
}

void TrajectoryProblem::Impl::begin_as_before(Stages& guess) const {
  const StageLayout& layout = columns.layout;
  for (int b = 0; b < layout.count() && before.size() > 0; ++b)
    if (layout.block(b).role != BlockRole::clock)
      guess.block(layout.offset(b), 0, layout.block(b).size, before.cols()) =
          before.middleRows(layout.offset(b), layout.block(b).size);
}

}  // namespace lapwing
