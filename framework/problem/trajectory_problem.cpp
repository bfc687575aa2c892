// SPDX-License-Identifier: Apache-2.0
// Builds a trajectory problem and translates between its points and trajectories.
//
// How: while models, blocks and terms are added, they are only stored. `finish` then
//   1. appends the blocks `time` and `step` and numbers the columns: one for each number of a
//      stage's tangent space, none for constants (add_clock);
//   2. collects bounds on columns from the models and the clock. `tighten` keeps the tighter bound
//      and its owner, so that messages can name who set it;
//   3. binds each term to the stages that it reads (BoundFunction). A constraint that is an
//      identity on line blocks becomes bounds on columns instead of rows (bind_terms);
//   4. computes the sparsity patterns of Jacobian and Hessian (problem_pattern.cpp).
// Evaluation is in problem_evaluation.cpp, periodic flights in problem_closure.cpp.
//
// A point is a matrix `Stages` with one column per stage. The first guess is made of samples:
// positions and yaw from the path guess, velocities by differences, hovering force; or all of it
// from an earlier motion, leg by leg. Each model converts a sample into its own blocks. Free blocks
// are interpolated from their guesses.
#include "framework/problem/trajectory_problem.h"

#include <cmath>
#include <numbers>

#include "framework/core/units.h"
#include "framework/problem/trajectory_problem_impl.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kShortestStep = 1e-3;  // s, lower bound of a free step

// Straight between the guess's times (for an orientation, the shortest turn), constant outside.
Eigen::VectorXd interpolate(const BlockSpec& block, const BlockGuess& guess, double time) {
  const auto& t = guess.times;
  const auto after = std::upper_bound(t.begin(), t.end(), time);
  if (after == t.begin()) return guess.values.front();
  if (after == t.end()) return guess.values.back();
  const std::size_t k = after - t.begin();
  const double span = t[k] - t[k - 1];
  const double s = span > 0 ? (time - t[k - 1]) / span : 1.0;
  Eigen::VectorXd delta(block.tangent_size()), result(block.size);
  block_difference(block, guess.values[k - 1].data(), guess.values[k].data(), delta.data());
  delta *= s;
  block_retract(block, guess.values[k - 1].data(), delta.data(), result.data());
  return result;
}

const BlockSpec kPathPosition{.name = "position", .size = 3, .unit = "m"};
const BlockSpec kPathYaw{.name = "yaw", .size = 1, .unit = "rad"};

template <class Vectors>
void check_guess(const std::vector<double>& times, const Vectors& values, const std::string& what) {
  if (times.empty() || times.size() != values.size())
    throw InputError("guess of " + what + " needs as many values as times, at least one");
  for (std::size_t k = 0; k < times.size(); ++k)
    if (!std::isfinite(times[k]) || (k > 0 && times[k] < times[k - 1]))
      throw InputError("guess of " + what + ": times must be finite and in order");
  for (const auto& value : values)
    if (!value.allFinite()) throw InputError("guess of " + what + ": values must be finite");
}

}  // namespace

TrajectoryProblem::TrajectoryProblem(Vehicle vehicle, Horizon horizon, Environment environment)
    : impl_(std::make_unique<Impl>()) {
  if (horizon.stages < 2 || !(horizon.step > 0) || !std::isfinite(horizon.duration()))
    throw InputError("a trajectory needs at least 2 stages and a positive step");
  int intervals = 0;
  for (const Leg& leg : horizon.legs) intervals += leg.intervals;
  if (!horizon.legs.empty() && intervals != horizon.stages - 1)
    throw Error("a horizon's legs do not make its stages: use Horizon::of_legs");
  impl_->vehicle = std::move(vehicle);
  impl_->environment = std::move(environment);
  impl_->columns.horizon = horizon;
}
TrajectoryProblem::~TrajectoryProblem() = default;
TrajectoryProblem::TrajectoryProblem(TrajectoryProblem&&) noexcept = default;

void TrajectoryProblem::add_model(std::string name, std::unique_ptr<VehicleModel> model) {
  impl_->expect_unfinished();
  StageColumns& columns = impl_->columns;
  in_plugin(*model, "bind", [&] { model->bind(impl_->vehicle); });
  BoundModel bound;
  bound.name = std::move(name);
  for (const BlockSpec& block : in_plugin(*model, "blocks", [&] { return model->blocks(); })) {
    if (block.role != BlockRole::state && block.role != BlockRole::input)
      throw Error(bound.name + ": block '" + block.name + "' is neither state nor input");
    const bool state = block.role == BlockRole::state;
    (state ? bound.state_blocks : bound.input_blocks).push_back(columns.layout.add(block));
    (state ? bound.states : bound.inputs) += block.size;
    if (state) bound.state_tangents += block.tangent_size();
    if (block.topology == Topology::quaternion && model->affine())
      throw Error(bound.name + ": no model of an orientation is affine");
  }
  auto conditions = in_plugin(*model, "conditions", [&] { return model->conditions(); });
  for (auto& [condition, constraint] : conditions) {
    constraint->set_plugin_name(model->plugin_name());
    add_constraint(bound.name + "." + condition, std::move(constraint));
  }
  impl_->rests &= in_plugin(*model, "rests", [&] { return model->rests(); });
  bound.model = std::move(model);
  columns.models.push_back(std::move(bound));
}

void TrajectoryProblem::add_block(BlockSpec block) {
  impl_->expect_unfinished();
  block.role = BlockRole::free;
  impl_->columns.layout.add(std::move(block));
}

void TrajectoryProblem::add_cost(std::string name, double weight, std::unique_ptr<CostTerm> term) {
  impl_->expect_unfinished();
  if (!(weight >= 0) || !std::isfinite(weight))
    throw InputError(name + ": a weight is at least 0 and finite");
  impl_->costs.push_back({std::move(name), weight, std::move(term), nullptr, {}});
}

void TrajectoryProblem::add_constraint(std::string name, std::unique_ptr<Constraint> constraint) {
  impl_->expect_unfinished();
  ConstraintEntry entry;
  entry.name = std::move(name);
  entry.constraint = std::move(constraint);
  impl_->constraints.push_back(std::move(entry));
}

void TrajectoryProblem::set_path_guess(std::vector<double> times,
                                       std::vector<Eigen::Vector3d> positions,
                                       std::vector<double> yaws) {
  BlockGuess yaw_guess{"yaw", times, {}};
  for (const double yaw : yaws) yaw_guess.values.push_back(Eigen::VectorXd::Constant(1, yaw));
  check_guess(times, positions, "path");
  check_guess(times, yaw_guess.values, "path");
  impl_->path_positions = {"position", times, {positions.begin(), positions.end()}};
  impl_->path_yaws = std::move(yaw_guess);
}

void TrajectoryProblem::set_block_guess(const std::string& block, std::vector<double> times,
                                        std::vector<Eigen::VectorXd> values) {
  const BlockSpec& spec = impl_->columns.layout.block(impl_->columns.layout.index(block));
  check_guess(times, values, block);
  for (Eigen::VectorXd& value : values) {
    if (value.size() != spec.size)
      throw InputError("guess of " + block + " needs " + std::to_string(spec.size) + " numbers");
    if (spec.topology == Topology::line) continue;
    if (!(value.norm() > 0)) throw InputError("guess of " + block + ": a quaternion of length 0");
    value.normalize();
  }
  impl_->guesses.push_back({block, std::move(times), std::move(values)});
}

void TrajectoryProblem::set_motion_guess(Trajectory motion, Horizon legs) {
  if (legs.leg_count() != impl_->columns.horizon.leg_count() ||
      static_cast<int>(motion.samples.size()) != legs.stages)
    throw Error("the motion of the guess has other legs");
  impl_->motion = std::move(motion);
  impl_->motion_legs = std::move(legs);
}

Sample TrajectoryProblem::Impl::motion_sample(int stage) const {
  const Horizon& here = columns.horizon;
  const int leg = here.leg_of(stage), first = here.end_of_leg(leg),
            after = here.end_of_leg(leg + 1);
  const double share = static_cast<double>(stage - first) / (after - first);
  const double begin = motion.samples[motion_legs.end_of_leg(leg)].time;
  const double end = motion.samples[motion_legs.end_of_leg(leg + 1)].time;
  return sample_at(motion, begin + share * (end - begin));
}

void TrajectoryProblem::finish(const TrajectoryProblem* like) {
  impl_->expect_unfinished();
  if (impl_->columns.models.empty()) throw InputError("a trajectory problem needs a vehicle model");
  impl_->add_clock();
  impl_->list_closure();
  impl_->bind_terms();
  impl_->hold_stages();
  impl_->build_patterns(like ? like->impl_.get() : nullptr);
  impl_->finished = true;
}

void TrajectoryProblem::Impl::expect_unfinished() const {
  if (finished) throw Error("a trajectory problem does not change once it is finished");
}

// Blocks `time` and `step`, then the columns: every number but the constants.
void TrajectoryProblem::Impl::add_clock() {
  StageLayout& layout = columns.layout;
  columns.time_block =
      layout.add({.name = "time", .size = 1, .unit = "s", .role = BlockRole::clock});
  columns.step_block =
      layout.add({.name = "step", .size = 1, .unit = "s", .role = BlockRole::clock});
  for (int b = 0; b < layout.count(); ++b) {
    const bool constant = layout.block(b).role == BlockRole::clock && !columns.horizon.step_free;
    for (int i = 0; i < layout.block(b).tangent_size(); ++i)
      columns.column_in_stage.push_back(constant ? -1 : columns.per_stage++);
  }
  bounds.resize(columns.total());
  model_bounds();
  if (!columns.horizon.step_free) return;
  bound_owners.push_back("clock");
  const int owner = static_cast<int>(bound_owners.size()) - 1;
  const double begin = columns.horizon.begin;
  tighten(columns.column(0, layout.tangent_offset(columns.time_block)), begin, begin, owner);
  for (int i = 0; i < columns.horizon.stages; ++i) {
    const int column = columns.column(i, layout.tangent_offset(columns.step_block));
    tighten(column, kShortestStep, kInfinity, owner);
    if (columns.horizon.legs.empty()) continue;
    const Leg& leg = columns.horizon.legs[columns.horizon.leg_of(i)];
    if (leg.free)
      tighten(column, leg.shortest / leg.intervals, leg.longest / leg.intervals, owner);
    else
      tighten(column, leg.step, leg.step, owner);
  }
}

void TrajectoryProblem::Impl::model_bounds() {
  for (const BoundModel& model : columns.models) {
    const int owner = static_cast<int>(bound_owners.size());
    bound_owners.push_back(model.name);
    std::vector<double> lower(model.states + model.inputs), upper(lower.size());
    in_plugin(*model.model, "bounds", [&] { model.model->bounds(lower.data(), upper.data()); });
    int number = 0;
    for (const auto* blocks : {&model.state_blocks, &model.input_blocks})
      for (const int index : *blocks) {
        const BlockSpec& block = columns.layout.block(index);
        for (int i = 0; i < block.size; ++i, ++number)
          if (block.topology == Topology::line)
            for (int stage = 0; stage < columns.horizon.stages; ++stage)
              tighten(columns.column(stage, columns.layout.tangent_offset(index) + i),
                      lower[number], upper[number], owner);
      }
  }
}

void TrajectoryProblem::Impl::tighten(int column, double lower, double upper, int owner) {
  ColumnBound& bound = bounds[column];
  if (lower > bound.lower) bound.lower = lower, bound.lower_owner = owner;
  if (upper < bound.upper) bound.upper = upper, bound.upper_owner = owner;
}

void TrajectoryProblem::Impl::bind_terms() {
  const ProblemSetting setting{columns.layout, columns.horizon, vehicle, environment};
  for (CostEntry& cost : costs) {
    cost.bound = std::make_unique<BoundFunction>(cost.name, *cost.term, columns, setting);
    quadratic &= !cost.bound->curved();
  }
  for (const BoundModel& model : columns.models)
    affine_rows &= model.model->affine() && !columns.horizon.step_free;
  for (const int b : closed_blocks)
    affine_rows &= columns.layout.block(b).topology == Topology::line;
  for (ConstraintEntry& entry : constraints) {
    entry.bound = std::make_unique<BoundFunction>(entry.name, *entry.constraint, columns, setting);
    const BoundFunction& bound = *entry.bound;
    const int numbers = bound.instances() * bound.rows();
    entry.lower.resize(numbers);
    entry.upper.resize(numbers);
    in_plugin(*entry.constraint, "bounds", [&] {
      entry.constraint->bounds({0, bound.instances()}, entry.lower.data(), entry.upper.data());
    });
    for (int r = 0; r < numbers; ++r)
      if (std::isnan(entry.lower[r]) || std::isnan(entry.upper[r]))
        throw Error(entry.name + ": a bound is not a number");
    bool lines = true;
    for (const int block : bound.shape().blocks)
      lines &= columns.layout.block(block).topology == Topology::line &&
               columns.layout.block(block).role != BlockRole::clock;
    entry.is_bounds = bound.shape().identity && bound.shape().times.empty() && lines;
    if (entry.is_bounds) {
      bound_owners.push_back(entry.name);
      take_bounds(entry, static_cast<int>(bound_owners.size()) - 1);
    } else {
      affine_rows &= !bound.curved();
    }
  }
  quadratic &= affine_rows;
}

void TrajectoryProblem::Impl::take_bounds(ConstraintEntry& entry, int owner) {
  const BoundFunction& bound = *entry.bound;
  if (bound.rows() != bound.width())
    throw Error(entry.name + ": an identity has as many rows as inputs");
  for (int k = 0; k < bound.instances(); ++k)
    for (int r = 0; r < bound.rows(); ++r)
      tighten(bound.columns(k)[r], entry.lower[k * bound.rows() + r],
              entry.upper[k * bound.rows() + r], owner);
}

bool TrajectoryProblem::rests() const {
  return impl_->rests;
}
const Vehicle& TrajectoryProblem::vehicle() const {
  return impl_->vehicle;
}
const Horizon& TrajectoryProblem::horizon() const {
  return impl_->columns.horizon;
}
const Environment& TrajectoryProblem::environment() const {
  return impl_->environment;
}
const StageLayout& TrajectoryProblem::layout() const {
  return impl_->columns.layout;
}
int TrajectoryProblem::columns() const {
  return impl_->columns.total();
}
int TrajectoryProblem::rows() const {
  return impl_->rows;
}
int TrajectoryProblem::dynamics_rows() const {
  return impl_->dynamics_rows;
}
bool TrajectoryProblem::quadratic() const {
  return impl_->quadratic;
}

std::pair<double, double> TrajectoryProblem::bounds(int column) const {
  const ColumnBound& bound = impl_->bounds.at(column);
  return {bound.lower, bound.upper};
}

double TrajectoryProblem::time(const Stages& at, int stage) const {
  return at(impl_->columns.layout.offset(impl_->columns.time_block), stage);
}

Stages TrajectoryProblem::initial_guess() const {
  const StageColumns& columns = impl_->columns;
  const int count = columns.horizon.stages;
  const Horizon& horizon = columns.horizon;
  Stages at = Stages::Zero(columns.layout.size(), count);
  std::vector<Sample> samples(count);
  for (int i = 0; i < count; ++i) {
    samples[i].time = horizon.time(i);
    if (!impl_->motion.samples.empty()) samples[i] = impl_->motion_sample(i);
    samples[i].time = horizon.time(i);
    if (impl_->path_positions.times.empty()) continue;
    samples[i].position = interpolate(kPathPosition, impl_->path_positions, samples[i].time);
    samples[i].yaw = interpolate(kPathYaw, impl_->path_yaws, samples[i].time)(0);
  }
  for (int i = 0; i + 1 < count && impl_->motion.samples.empty(); ++i) {
    const double step = horizon.step_after(i);
    samples[i].velocity = (samples[i + 1].position - samples[i].position) / step;
    samples[i].yaw_rate = (samples[i + 1].yaw - samples[i].yaw) / step;
  }
  for (int i = 0; i < count; ++i) {
    for (const BoundModel& model : columns.models) {
      std::vector<double> numbers(model.states + model.inputs);
      in_plugin(*model.model, "from_sample",
                [&] { model.model->from_sample(samples[i], numbers.data()); });
      const double* from = numbers.data();
      for (const auto* blocks : {&model.state_blocks, &model.input_blocks})
        for (const int b : *blocks) {
          const int size = columns.layout.block(b).size;
          std::copy_n(from, size, at.col(i).data() + columns.layout.offset(b));
          from += size;
        }
    }
    at(columns.layout.offset(columns.time_block), i) = samples[i].time;
    at(columns.layout.offset(columns.step_block), i) = horizon.step_after(i);
    for (int b = 0; b < columns.layout.count(); ++b)
      if (columns.layout.block(b).role == BlockRole::free &&
          columns.layout.block(b).topology == Topology::quaternion)
        at(columns.layout.offset(b), i) = 1.0;
    for (const BlockGuess& guess : impl_->guesses) {
      const int b = columns.layout.index(guess.block);
      at.col(i).segment(columns.layout.offset(b), columns.layout.block(b).size) =
          interpolate(columns.layout.block(b), guess, samples[i].time);
    }
  }
  impl_->begin_as_before(at);
  return at;
}

Stages TrajectoryProblem::retract(const Stages& at, const Eigen::VectorXd& step) const {
  const StageColumns& columns = impl_->columns;
  const StageLayout& layout = columns.layout;
  Stages result = at;
  std::vector<double> delta(layout.tangent_size());
  for (int i = 0; i < columns.horizon.stages; ++i) {
    for (int t = 0; t < layout.tangent_size(); ++t) {
      const int column = columns.column(i, t);
      delta[t] = column < 0 ? 0.0 : step(column);
    }
    for (int b = 0; b < layout.count(); ++b)
      block_retract(layout.block(b), at.col(i).data() + layout.offset(b),
                    delta.data() + layout.tangent_offset(b),
                    result.col(i).data() + layout.offset(b));
  }
  return result;
}

Trajectory TrajectoryProblem::trajectory(const Stages& at) const {
  const StageColumns& columns = impl_->columns;
  Trajectory result;
  for (const BoundModel& model : columns.models)
    in_plugin(*model.model, "describe", [&] { model.model->describe(result); });
  const int target = columns.layout.find("target");
  result.has_target = target >= 0 && columns.layout.block(target).size == 3;
  result.samples.resize(columns.horizon.stages);
  for (int i = 0; i < columns.horizon.stages; ++i) {
    Sample& sample = result.samples[i];
    // Of free steps the sum: whatever a solver leaves behind, times increase.
    const bool sum = columns.horizon.step_free && i > 0;
    sample.time = sum ? result.samples[i - 1].time + columns.step(at, i - 1) : time(at, i);
    for (const BoundModel& model : columns.models) {
      std::vector<double> numbers(model.arguments());
      columns.gather_model(model, at, i, 0.0, numbers.data());
      in_plugin(*model.model, "to_sample", [&] { model.model->to_sample(numbers.data(), sample); });
    }
    if (result.has_target) sample.target = at.col(i).segment<3>(columns.layout.offset(target));
    // A heading read off an orientation, on the turn of the sample before.
    constexpr double kTurn = 2 * std::numbers::pi;
    if (result.motion.column("orientation") && i > 0)
      sample.yaw += kTurn * std::round((result.samples[i - 1].yaw - sample.yaw) / kTurn);
  }
  return result;
}

}  // namespace lapwing
