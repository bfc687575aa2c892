// SPDX-License-Identifier: Apache-2.0
// Evaluates a stage function of a plugin in the columns of a problem.
//
// How: the constructor lists the instances and, for each, the columns of its inputs. An evaluation
// gathers the inputs of up to 64 instances and calls the plugin once for them. The plugin returns
// values and derivatives J with respect to its inputs x. The chain rule gives derivatives with
// respect to the columns d:
//   plain, only line blocks     x = columns                       J is copied (`direct_`)
//   plain, with quaternions     x = q (+) d                       J E(q)
//   at a time between stages    x = flow of the stage before,     J dx/d(both stages)
//                                   free blocks interpolated
// An integral cost is multiplied by sqrt(h). Where h is free, h is one more column.
//
// Second derivatives of lambda' value have up to four parts: the plugin's own, C' H C with the
// chain C; those of the flow (add_flow_curvature); those of q (+) d = q + E d - |d|^2 q / 8
// (add_retraction_curvature); and those of sqrt(h). A function that is affine in the columns has
// one Jacobian, computed at the start.
#include "framework/problem/bound_function.h"

#include <cmath>
#include <cstdio>

#include "framework/core/active_call.h"

namespace lapwing {
namespace {

constexpr double kOnStage = 1e-9;  // s, nearer to a stage than this is on it
constexpr double kOnLeg = 1e-6;    // s, nearer to a leg's end than this names it

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g s", std::round(seconds * 1e6) / 1e6);
  return text;
}

}  // namespace

BoundFunction::BoundFunction(std::string name, StageFunction& function, const StageColumns& columns,
                             const ProblemSetting& setting)
    : name_(std::move(name)), function_(&function), written_at_(function.written_at()) {
  try {
    shape_ = in_plugin(function, "bind", [&] { return function.bind(setting); });
  } catch (const InputError& error) {
    throw InputError(name_ + ": " + error.what());
  }
  if (shape_.rows == 0) return;
  if (shape_.rows < 0 || shape_.window < 1 || shape_.window > columns.horizon.stages)
    throw InputError(name_ + ": needs " + std::to_string(shape_.window) +
                     " neighbouring stages, the problem has " +
                     std::to_string(columns.horizon.stages));
  if (shape_.blocks.empty()) throw Error(name_ + ": reads no block");
  if (!shape_.row_names.empty() && static_cast<int>(shape_.row_names.size()) != shape_.rows)
    throw Error(name_ + ": names " + std::to_string(shape_.row_names.size()) + " of " +
                std::to_string(shape_.rows) + " rows");
  if (!shape_.times.empty() && (shape_.window != 1 || !shape_.stages.empty()))
    throw Error(name_ + ": a function at given times reads one stage and lists no others");
  for (int w = 0; w < shape_.window; ++w)
    for (const int block : shape_.blocks) inputs_ += columns.layout.block(block).size;
  row_names_ = shape_.row_names;
  time_offset_ = columns.layout.offset(columns.time_block);
  list_instances(columns);
  for (const int block : shape_.blocks) {
    const BlockSpec& spec = columns.layout.block(block);
    if (sampled_ && spec.topology == Topology::quaternion && spec.role != BlockRole::state)
      throw Error(name_ + ": '" + spec.name +
                  "' is a free orientation, which cannot be read between two stages");
  }
  list_columns(columns);

  bool models_affine = true;
  for (const BoundModel& model : columns.models) models_affine &= model.model->affine();
  bool lines = true;
  for (const int block : shape_.blocks)
    lines &= columns.layout.block(block).topology == Topology::line;
  const bool weighted = shape_.integral && columns.horizon.step_free;  // by a step that may change
  const bool constant = shape_.affine && lines && !weighted && (!sampled_ || models_affine);
  if (constant) {
    Stages at = Stages::Zero(columns.layout.size(), columns.horizon.stages);
    for (int i = 0; i < columns.horizon.stages; ++i) {
      at(columns.layout.offset(columns.time_block), i) = columns.horizon.time(i);
      at(columns.layout.offset(columns.step_block), i) = columns.horizon.step_after(i);
    }
    std::vector<double> values(instances() * rows()), jacobian(values.size() * width_);
    Workspace workspace;
    evaluate(columns, at, values.data(), &jacobian, workspace);
    constant_ = std::move(jacobian);
  }
}

// Where steps are free a time names the end of a leg by its first guess.
int BoundFunction::end_of_leg(const Horizon& horizon, double time) const {
  for (int leg = 0; leg <= horizon.leg_count(); ++leg) {
    const int stage = horizon.end_of_leg(leg);
    if (std::abs(horizon.time(stage) - time) <= kOnLeg) return stage;
  }
  throw InputError(name_ + ": given times need a fixed step, or must be the ends of legs; " +
                   seconds_text(time) + " is neither");
}

void BoundFunction::list_instances(const StageColumns& columns) {
  const Horizon& horizon = columns.horizon;
  const int last = horizon.stages - shape_.window;
  if (!shape_.times.empty()) {
    const double begin = horizon.begin, end = horizon.end();
    for (const double time : shape_.times) {
      if (horizon.step_free) {
        stage_.push_back(end_of_leg(horizon, time));
        offset_.push_back(0.0);
        nominal_.push_back(horizon.time(stage_.back()));
        continue;
      }
      if (!(time >= begin - kOnStage && time <= end + kOnStage))
        throw InputError(name_ + ": time " + seconds_text(time) + " lies outside the " +
                         (begin == 0 ? "duration of " : "part that ends at ") + seconds_text(end));
      int stage = std::min(horizon.stage_at(time), last);
      double offset = time - horizon.time(stage);
      if (horizon.step_after(stage) - offset < kOnStage && stage < last) ++stage, offset = 0;
      if (std::abs(offset) < kOnStage || stage == last) offset = 0;
      sampled_ |= offset > 0;
      stage_.push_back(stage);
      offset_.push_back(offset);
      nominal_.push_back(time);
    }
    return;
  }
  std::vector<int> stages = shape_.stages;
  if (stages.empty())
    for (int i = 0; i <= last; ++i) stages.push_back(i);
  for (const int stage : stages) {
    if (stage < 0 || stage > last) throw Error(name_ + ": asks for a stage outside the horizon");
    stage_.push_back(stage);
    offset_.push_back(0.0);
    nominal_.push_back(horizon.time(stage));
  }
}

void BoundFunction::list_columns(const StageColumns& columns) {
  direct_ = !sampled_;
  for (const int block : shape_.blocks)
    direct_ &= columns.layout.block(block).topology == Topology::line;
  step_column_ = shape_.integral && columns.horizon.step_free;
  for (int k = 0; k < instances(); ++k) {
    if (sampled_) {
      for (const int stage : {stage_[k], stage_[k] + 1})
        for (int i = 0; i < columns.per_stage; ++i)
          columns_.push_back(stage < columns.horizon.stages ? stage * columns.per_stage + i : -1);
    } else {
      for (int w = 0; w < shape_.window; ++w)
        for (const int block : shape_.blocks)
          for (int i = 0; i < columns.layout.block(block).tangent_size(); ++i)
            columns_.push_back(
                columns.column(stage_[k] + w, columns.layout.tangent_offset(block) + i));
    }
    if (step_column_)
      columns_.push_back(
          columns.column(stage_[k], columns.layout.tangent_offset(columns.step_block)));
  }
  width_ = instances() ? static_cast<int>(columns_.size()) / instances() : 0;
}

double BoundFunction::time(const Stages& at, int instance) const {
  if (at.size() == 0) return nominal_[instance];
  return at.col(stage_[instance])(time_offset_) + offset_[instance];
}

std::string BoundFunction::row_name(int instance, int row) const {
  std::string part;
  if (!row_names_.empty())
    part = "." + row_names_[row];
  else if (rows() > 1)
    part = "." + std::to_string(row);
  return name_ + part + " at " + seconds_text(nominal_[instance]);
}

void BoundFunction::gather(const StageColumns& columns, const Stages& at, int instance,
                           double* inputs, RowMajor* chain) const {
  if (sampled_) return gather_sampled(columns, at, instance, inputs, chain);
  if (chain) chain->setZero(inputs_, width_);
  int row = 0, column = 0;
  for (int w = 0; w < shape_.window; ++w) {
    const double* stage = at.col(stage_[instance] + w).data();
    for (const int index : shape_.blocks) {
      const BlockSpec& block = columns.layout.block(index);
      const double* value = stage + columns.layout.offset(index);
      std::copy_n(value, block.size, inputs + row);
      if (chain)
        chain->block(row, column, block.size, block.tangent_size()) =
            retraction_jacobian(block, value);
      row += block.size;
      column += block.tangent_size();
    }
  }
}

void BoundFunction::gather_sampled(const StageColumns& columns, const Stages& at, int instance,
                                   double* inputs, RowMajor* chain) const {
  const StageLayout& layout = columns.layout;
  const int stage = stage_[instance];
  const int next = std::min(stage + 1, columns.horizon.stages - 1);
  const double fraction = offset_[instance] / columns.horizon.step_after(stage);
  // The whole stage between the two, and its derivative with respect to both.
  Eigen::VectorXd between = at.col(stage);
  RowMajor derivative;
  const auto tangent = [&](int block) { return layout.tangent_offset(block); };
  const auto inside = [&](int number) { return columns.column_in_stage[number]; };
  if (chain) derivative.setZero(layout.size(), width_);
  for (int b = 0; b < layout.count(); ++b) {
    const BlockSpec& block = layout.block(b);
    const int at_row = layout.offset(b);
    if (block.role == BlockRole::free && block.topology == Topology::line)
      between.segment(at_row, block.size) +=
          fraction * (at.col(next) - at.col(stage)).segment(at_row, block.size);
    if (!chain || block.role == BlockRole::state || block.role == BlockRole::clock) continue;
    if (block.topology == Topology::quaternion) continue;  // never read here
    for (int i = 0; i < block.size; ++i) {
      const double later = block.role == BlockRole::free ? fraction : 0.0;
      derivative(at_row + i, inside(tangent(b) + i)) = 1.0 - later;
      if (later > 0) derivative(at_row + i, columns.per_stage + inside(tangent(b) + i)) = later;
    }
  }
  between(time_offset_) = nominal_[instance];
  for (const BoundModel& model : columns.models)
    flow_between(columns, model, at, instance, between, chain ? &derivative : nullptr);
  int row = 0;
  for (const int b : shape_.blocks) {
    const int size = layout.block(b).size;
    std::copy_n(between.data() + layout.offset(b), size, inputs + row);
    row += size;
  }
  if (!chain) return;
  chain->setZero(inputs_, width_);
  row = 0;
  for (const int b : shape_.blocks) {
    const int size = layout.block(b).size;
    chain->middleRows(row, size) = derivative.middleRows(layout.offset(b), size);
    row += size;
  }
}

void BoundFunction::flow_between(const StageColumns& columns, const BoundModel& model,
                                 const Stages& at, int instance, Eigen::VectorXd& between,
                                 RowMajor* derivative) const {
  const StageLayout& layout = columns.layout;
  const int arguments = model.arguments(), stage = stage_[instance];
  std::vector<double> x(arguments), next(model.states), jacobian(model.states * arguments);
  columns.gather_model(model, at, stage, offset_[instance], x.data());
  Workspace workspace;
  model.flow(x.data(), next.data(), derivative ? jacobian.data() : nullptr, workspace);
  int state = 0;
  for (const int b : model.state_blocks) {
    const int size = layout.block(b).size;
    std::copy_n(next.data() + state, size, between.data() + layout.offset(b));
    if (derivative) {
      int argument = 0;
      for (const auto* blocks : {&model.state_blocks, &model.input_blocks})
        for (const int from : *blocks) {
          const BlockSpec& block = layout.block(from);
          const int column = columns.column_in_stage[layout.tangent_offset(from)];
          columns.to_tangent(block, at.col(stage).data() + layout.offset(from),
                             jacobian.data() + state * arguments + argument, size, arguments,
                             derivative->data() + layout.offset(b) * width_ + column, width_);
          argument += block.size;
        }
    }
    state += size;
  }
}

// The function's own name stands for a plugin's where no registry made it.
const char* BoundFunction::plugin_name() const {
  return function_->plugin_name() ? function_->plugin_name() : name_.c_str();
}

// What goes wrong in the function's own code is told with its name.
template <class Body>
void BoundFunction::guarded_call(const char* call, const Body& body) const {
  if (!written_at_.empty()) {  // a tape: none but the kernel's code
    show_activity();
    return body();
  }
  const char* const plugin = plugin_name();
  const ActiveCall mark(plugin, call);
  call_plugin(plugin, call, body);
}

const double* BoundFunction::evaluate(const StageColumns& columns, const Stages& at, double* values,
                                      std::vector<double>* jacobian, Workspace& workspace) const {
  constexpr int kChunk = 64;
  const bool compute = jacobian && constant_.empty();
  const int m = rows();
  if (compute) jacobian->resize(static_cast<std::size_t>(instances()) * m * width_);
  double* const x = workspace.doubles(2, static_cast<std::size_t>(kChunk) * inputs_);
  double* const j = workspace.doubles(3, static_cast<std::size_t>(kChunk) * m * inputs_);
  RowMajor chain;
  for (int first = 0; first < instances(); first += kChunk) {
    const int count = std::min(kChunk, instances() - first);
    for (int k = 0; k < count; ++k) gather(columns, at, first + k, x + k * inputs_, nullptr);
    double* const v = values + first * m;
    const bool in_place = compute && direct_ && !step_column_;
    double* const out =
        compute ? jacobian->data() + static_cast<std::size_t>(first) * m * width_ : nullptr;
    double* const derivatives = !compute ? nullptr : in_place ? out : j;
    guarded_call("evaluate", [&] {
      function_->evaluate({first, count}, x, v, derivatives, workspace);
    });
    if (jacobian) expect_finite(columns.layout, {first, count}, x, v, derivatives);
    for (int k = 0; k < count; ++k) {
      double* const row = compute ? out + static_cast<std::size_t>(k) * m * width_ : nullptr;
      if (compute && !in_place) {
        Eigen::Map<RowMajor> target(row, m, width_);
        const Eigen::Map<const RowMajor> source(j + k * m * inputs_, m, inputs_);
        if (direct_) {
          target.leftCols(inputs_) = source;
        } else {
          gather(columns, at, first + k, x + k * inputs_, &chain);
          target = source.lazyProduct(chain);
        }
        if (step_column_) target.rightCols(1).setZero();
      }
      if (shape_.integral) weight_rows(columns, at, first + k, v + k * m, row);
    }
  }
  if (!jacobian) return nullptr;
  return compute ? jacobian->data() : constant_.data();
}

// Multiplies by the root of the step, with its derivative where the step is free.
void BoundFunction::weight_rows(const StageColumns& columns, const Stages& at, int instance,
                                double* values, double* jacobian) const {
  const double root = std::sqrt(columns.step(at, stage_[instance]));
  if (jacobian) {
    Eigen::Map<RowMajor> j(jacobian, rows(), width_);
    j *= root;
    if (step_column_)
      for (int r = 0; r < rows(); ++r) j(r, width_ - 1) += 0.5 / root * values[r];
  }
  for (int r = 0; r < rows(); ++r) values[r] *= root;
}

void BoundFunction::curvature(const StageColumns& columns, const Stages& at,
                              const double* multipliers, std::vector<double>& hessian,
                              Workspace& workspace) const {
  const int m = rows(), n = inputs_;
  hessian.assign(static_cast<std::size_t>(instances()) * width_ * width_, 0.0);
  std::vector<double> x(n), v(m), j(m * n), h(n * n), scaled(m);
  RowMajor chain;
  for (int k = 0; k < instances(); ++k) {
    const double* own = multipliers + k * m;
    if (std::all_of(own, own + m, [](double weight) { return weight == 0; })) continue;
    gather(columns, at, k, x.data(), &chain);
    const double step = columns.step(at, stage_[k]);
    const double root = shape_.integral ? std::sqrt(step) : 1.0;
    for (int r = 0; r < m; ++r) scaled[r] = root * multipliers[k * m + r];
    std::fill(h.begin(), h.end(), 0.0);
    if (!shape_.affine)
      guarded_call("curvature", [&] {
        function_->curvature({k, 1}, x.data(), scaled.data(), h.data(), workspace);
      });
    Eigen::Map<RowMajor> result(hessian.data() + static_cast<std::size_t>(k) * width_ * width_,
                                width_, width_);
    const RowMajor bent = Eigen::Map<RowMajor>(h.data(), n, n).lazyProduct(chain);
    result = chain.transpose().lazyProduct(bent);
    if (direct_ && !step_column_) continue;
    guarded_call("evaluate", [&] {
      function_->evaluate({k, 1}, x.data(), v.data(), j.data(), workspace);
    });
    const Eigen::Map<const Eigen::VectorXd> lambda(multipliers + k * m, m);
    const Eigen::VectorXd slope =
        Eigen::Map<const RowMajor>(j.data(), m, n).transpose() * lambda;  // d(lambda.v)/d inputs
    if (sampled_)
      add_flow_curvature(columns, at, k, root * slope, result);
    else
      add_retraction_curvature(columns, at, k, root * slope, result);
    if (step_column_) {
      // root(h) v: cross terms between the root and v, and the root's own curvature.
      const Eigen::VectorXd cross = (0.5 / root) * (chain.transpose() * slope);
      result.col(width_ - 1) += cross;
      result.row(width_ - 1) += cross.transpose();
      const double value = lambda.dot(Eigen::Map<const Eigen::VectorXd>(v.data(), m));
      result(width_ - 1, width_ - 1) -= 0.25 / (step * root) * value;
    }
  }
}

// A sampled state is the model's flow, which may bend; `slope` is the derivative of the bent
// quantity with respect to the instance's inputs.
void BoundFunction::add_flow_curvature(const StageColumns& columns, const Stages& at, int instance,
                                       const Eigen::VectorXd& slope,
                                       Eigen::Ref<RowMajor> result) const {
  const StageLayout& layout = columns.layout;
  const int stage = stage_[instance];
  for (const BoundModel& model : columns.models) {
    if (model.model->affine()) continue;
    const int n = model.arguments();
    std::vector<double> x(n), next(model.states);
    RowMajor jacobian(model.states, n), bend = RowMajor::Zero(n, n);
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(model.states);
    int state = 0;
    for (const int b : model.state_blocks) {
      const int size = layout.block(b).size;
      int input = 0;
      for (const int read : shape_.blocks) {
        if (read == b) multipliers.segment(state, size) += slope.segment(input, size);
        input += layout.block(read).size;
      }
      state += size;
    }
    columns.gather_model(model, at, stage, offset_[instance], x.data());
    Workspace workspace;
    model.flow(x.data(), next.data(), jacobian.data(), workspace);
    model.curvature(x.data(), multipliers.data(), bend.data(), workspace);
    const Eigen::VectorXd pull = jacobian.transpose() * multipliers;
    RowMajor chain = RowMajor::Zero(n, width_);
    int argument = 0;
    for (const auto* blocks : {&model.state_blocks, &model.input_blocks})
      for (const int b : *blocks) {
        const BlockSpec& block = layout.block(b);
        const double* value = at.col(stage).data() + layout.offset(b);
        const int column = columns.column_in_stage[layout.tangent_offset(b)];
        chain.block(argument, column, block.size, block.tangent_size()) =
            retraction_jacobian(block, value);
        if (block.topology == Topology::quaternion)
          result.diagonal().segment<3>(column).array() -=
              0.25 * Eigen::Map<const Eigen::Vector4d>(value).dot(pull.segment<4>(argument));
        argument += block.size;
      }
    const RowMajor bent = bend.lazyProduct(chain);
    result += chain.transpose().lazyProduct(bent);
  }
}

// A quaternion moved by d is q + E d - |d|^2 q / 8 + ...: curvature of its own.
void BoundFunction::add_retraction_curvature(const StageColumns& columns, const Stages& at,
                                             int instance, const Eigen::VectorXd& slope,
                                             Eigen::Ref<RowMajor> result) const {
  int row = 0, column = 0;
  for (int w = 0; w < shape_.window; ++w)
    for (const int index : shape_.blocks) {
      const BlockSpec& block = columns.layout.block(index);
      if (block.topology == Topology::quaternion) {
        const auto q = at.col(stage_[instance] + w).segment<4>(columns.layout.offset(index));
        const double bend = -0.25 * q.dot(slope.segment<4>(row));
        result.diagonal().segment<3>(column).array() += bend;
      }
      row += block.size;
      column += block.tangent_size();
    }
}

}  // namespace lapwing
