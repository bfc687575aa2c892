// SPDX-License-Identifier: Apache-2.0
// Names of rows and columns, and violations by name.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "framework/problem/trajectory_problem_impl.h"

namespace lapwing {
namespace {

std::string at_time(double seconds) {
  char text[40];
  std::snprintf(text, sizeof text, " at %.10g s", std::round(seconds * 1e6) / 1e6);
  return text;
}

// The worst so far of each name.
class Worst {
 public:
  template <class Row>
  void add(const std::string& name, double amount, double time, Row row) {
    auto [found, inserted] = index_.try_emplace(name, entries_.size());
    if (inserted) entries_.push_back({name, "", 0.0, 0.0});
    Violation& entry = entries_[found->second];
    if (std::isnan(amount)) amount = std::numeric_limits<double>::infinity();
    if (!(amount > entry.amount)) return;
    entry.amount = amount;
    entry.time = time;
    entry.row = row();
  }
  std::vector<Violation> sorted() && {
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const Violation& a, const Violation& b) { return a.amount > b.amount; });
    return std::move(entries_);
  }

 private:
  std::map<std::string, std::size_t> index_;
  std::vector<Violation> entries_;
};

}  // namespace

std::string TrajectoryProblem::column_name(int column) const {
  const StageColumns& c = impl_->columns;
  if (column < 0 || column >= c.total()) throw Error("no such column");
  const int stage = column / c.per_stage, inside = column % c.per_stage;
  for (int b = 0; b < c.layout.count(); ++b)
    for (int i = 0; i < c.layout.block(b).tangent_size(); ++i)
      if (c.column_in_stage[c.layout.tangent_offset(b) + i] == inside)
        return component_name(c.layout.block(b), i) + at_time(c.horizon.time(stage));
  throw Error("no such column");
}

std::string TrajectoryProblem::bound_name(int column, bool lower) const {
  const ColumnBound& bound = impl_->bounds.at(column);
  const int owner = lower ? bound.lower_owner : bound.upper_owner;
  return (owner < 0 ? "" : impl_->bound_owners[owner] + ": ") + column_name(column);
}

std::string TrajectoryProblem::row_name(int row) const {
  if (row < impl_->dynamics_rows) return impl_->dynamics_row_name(row);
  for (const ConstraintEntry& entry : impl_->constraints) {
    if (entry.is_bounds) continue;
    const int inside = row - entry.first_row, m = entry.bound->rows();
    if (inside >= 0 && inside < entry.bound->instances() * m)
      return entry.bound->row_name(inside / m, inside % m);
  }
  throw Error("no such row");
}

std::string TrajectoryProblem::Impl::dynamics_row_name(int row) const {
  const int intervals = columns.horizon.stages - 1;
  for (const BoundModel& model : columns.models) {
    int inside = row - model.first_row;
    const int flow_rows = model.state_tangents * intervals;
    if (inside < 0 || inside >= flow_rows + model.inputs) continue;
    const bool flow = inside < flow_rows;
    const double time = columns.horizon.time(flow ? inside / model.state_tangents : intervals);
    inside = flow ? inside % model.state_tangents : inside - flow_rows;
    for (const int b : flow ? model.state_blocks : model.input_blocks) {
      const BlockSpec& block = columns.layout.block(b);
      if (inside < block.tangent_size())
        return model.name + (flow ? ".flow." : ".held.") + component_name(block, inside) +
               at_time(time);
      inside -= block.tangent_size();
    }
  }
  if (row >= closure_row) return closure_row_name(row - closure_row);
  const ClockRow& entry = clock[row - (closure_row - static_cast<int>(clock.size()))];
  return std::string("clock.") + (entry.step ? "step" : "time") +
         at_time(columns.horizon.time(entry.stage));
}

std::vector<Violation> TrajectoryProblem::violations(const Stages& at) const {
  const Impl& p = *impl_;
  const Eigen::VectorXd values = row_values(at);
  Worst worst;
  for (int row = 0; row < p.dynamics_rows; ++row) {
    const auto name = [&] { return p.dynamics_row_name(row); };
    const int intervals = p.columns.horizon.stages - 1;
    const int tick = row - (p.closure_row - static_cast<int>(p.clock.size()));
    std::string owner = row >= p.closure_row ? "closure" : "clock";
    const bool ticks = tick >= 0 && row < p.closure_row;
    double time = this->time(at, ticks ? p.clock[tick].stage : intervals);
    for (const BoundModel& model : p.columns.models) {
      const int inside = row - model.first_row;
      const int flow_rows = model.state_tangents * (p.columns.horizon.stages - 1);
      if (inside < 0 || inside >= flow_rows + model.inputs) continue;
      owner = model.name;
      time = this->time(at, std::min(inside / model.state_tangents, p.columns.horizon.stages - 1));
    }
    worst.add(owner, std::abs(values(row)), time, name);
  }
  for (const ConstraintEntry& entry : p.constraints) {
    if (entry.is_bounds) continue;
    const int m = entry.bound->rows();
    for (std::size_t r = 0; r < entry.lower.size(); ++r) {
      const double value = values(entry.first_row + static_cast<int>(r));
      const int instance = static_cast<int>(r) / m;
      worst.add(entry.name, std::max(entry.lower[r] - value, value - entry.upper[r]),
                entry.bound->time(at, instance),
                [&] { return entry.bound->row_name(instance, static_cast<int>(r) % m); });
    }
  }
  for (int c = 0; c < columns(); ++c) {
    const ColumnBound& bound = p.bounds[c];
    const double number = p.stage_number(at, c);
    const double time = this->time(at, c / p.columns.per_stage);
    const auto name = [&](int owner) {
      return [&, owner] { return p.bound_owners[owner] + ": " + column_name(c); };
    };
    if (bound.lower_owner >= 0)
      worst.add(p.bound_owners[bound.lower_owner], bound.lower - number, time,
                name(bound.lower_owner));
    if (bound.upper_owner >= 0)
      worst.add(p.bound_owners[bound.upper_owner], number - bound.upper, time,
                name(bound.upper_owner));
  }
  return std::move(worst).sorted();
}

std::string TrajectoryProblem::script_fault(const Stages& at) const {
  for (const CostEntry& cost : impl_->costs) {
    const std::string fault = cost.bound->fault_at(impl_->columns, at);
    if (!fault.empty()) return fault;
  }
  for (const ConstraintEntry& entry : impl_->constraints) {
    const std::string fault = entry.bound->fault_at(impl_->columns, at);
    if (!fault.empty()) return fault;
  }
  return "";
}

}  // namespace lapwing
