// SPDX-License-Identifier: Apache-2.0
// Sparsity and slots of the local model, computed once.
//
// How: each source of entries (models, held inputs and clock, closure, constraints, costs) is a
// loop that calls visit(row, column). Every loop runs twice. The first run collects the entries in
// a SparsePattern. The second run, after `finish`, lists the slot of each entry: its place in the
// value array of the compressed matrix. Evaluations run through the same entries in the same order,
// and write through the slots. A slot of -1 stands for an entry that is left out: a column that is
// constant, or a zero of a Jacobian that never changes.
//
// Rows: for each model the flow of every interval, then its held inputs; the clock; the closure;
// the constraints that are not bounds. The Hessian always has its whole diagonal.
#include "framework/problem/trajectory_problem_impl.h"

namespace lapwing {
namespace {

// Pairs (a, b), a >= b, of an instance's columns that may meet in the Hessian of a cost: all, or
// where the Jacobian is constant those with a row in common.
template <class Visit>
void visit_pairs(const BoundFunction& bound, const std::vector<double>& jacobian, int instance,
                 Visit visit) {
  const int width = bound.width(), rows = bound.rows();
  const int* columns = bound.columns(instance);
  const double* j = jacobian.empty()
                        ? nullptr
                        : jacobian.data() + static_cast<std::size_t>(instance) * rows * width;
  for (int a = 0; a < width; ++a)
    for (int b = 0; b <= a; ++b) {
      bool meets = columns[a] >= 0 && columns[b] >= 0;
      if (meets && j) {
        meets = false;
        for (int r = 0; r < rows && !meets; ++r)
          meets = j[r * width + a] != 0.0 && j[r * width + b] != 0.0;
      }
      visit(a, b, meets);
    }
}

// Any point serves where Jacobians are constant, as long as its step is the step, times a factor
// where that is free.
Stages constant_stages(const StageColumns& columns, double factor = 1.0) {
  Stages at = Stages::Zero(columns.layout.size(), columns.horizon.stages);
  for (int i = 0; i < columns.horizon.stages; ++i)
    at(columns.layout.offset(columns.step_block), i) = factor * columns.horizon.step_after(i);
  return at;
}

// Whether the derivatives of a model's step never depend on more than the step: 1 for those that
// may differ from zero, [row][column of model_step_columns]; empty where they depend on more.
std::vector<char> step_pattern(const StageColumns& columns, const BoundModel& model) {
  if (!model.model->affine()) return {};
  for (const auto* blocks : {&model.state_blocks, &model.input_blocks})
    for (const int b : *blocks)
      if (columns.layout.block(b).topology == Topology::quaternion) return {};
  std::vector<char> entries;
  ModelStep sample;
  for (const double factor : {1.0, 0.6180339887, 1.7724538509}) {  // no step is special
    if (!columns.horizon.step_free && factor != 1.0) continue;
    evaluate_model_step(columns, model, constant_stages(columns, factor), 0, true, sample);
    entries.resize(sample.jacobian.size());
    for (std::size_t k = 0; k < entries.size(); ++k) entries[k] |= sample.jacobian.data()[k] != 0.0;
    if (!columns.horizon.step_free) continue;
    const int step = model.arguments() - 1;
    for (int r = 0; r < model.state_tangents; ++r) entries[r * sample.jacobian.cols() + step] = 1;
  }
  return entries;
}

std::vector<double> constant_jacobian(const StageColumns& columns, const BoundFunction& bound) {
  if (!bound.constant_jacobian()) return {};
  std::vector<double> values(bound.instances() * bound.rows()), unused;
  Workspace workspace;
  const double* j =
      bound.evaluate(columns, constant_stages(columns), values.data(), &unused, workspace);
  return {j, j + values.size() * bound.width()};
}

// Calls add(row, column) for each entry of the lower triangle, or fills the slots.
void hessian_entries(const BoundFunction& bound, const std::vector<double>& jacobian,
                     SparsePattern& pattern, std::vector<int>* slots) {
  for (int k = 0; k < bound.instances(); ++k)
    visit_pairs(bound, jacobian, k, [&](int a, int b, bool meets) {
      const int row = std::max(bound.columns(k)[a], bound.columns(k)[b]);
      const int column = std::min(bound.columns(k)[a], bound.columns(k)[b]);
      if (slots)
        slots->push_back(meets ? pattern.slot(row, column) : -1);
      else if (meets)
        pattern.add(row, column);
    });
}

}  // namespace

std::vector<int> model_step_columns(const StageColumns& columns, const BoundModel& model,
                                    int stage) {
  std::vector<int> result = columns.model_columns(model, stage);
  for (const int b : model.state_blocks)
    for (int i = 0; i < columns.layout.block(b).tangent_size(); ++i)
      result.push_back(columns.column(stage + 1, columns.layout.tangent_offset(b) + i));
  return result;
}

bool TrajectoryProblem::Impl::constant_flow(const BoundModel& model) const {
  bool lines = true;
  for (const int b : model.state_blocks)
    lines &= columns.layout.block(b).topology == Topology::line;
  return lines && model.model->affine() && !columns.horizon.step_free;
}

void TrajectoryProblem::Impl::build_patterns() {
  const int stages = columns.horizon.stages;
  // Row numbers: per model and stage, held last inputs, clock, constraints.
  for (BoundModel& model : columns.models) {
    model.first_row = rows;
    rows += model.state_tangents * (stages - 1) + model.inputs;
  }
  const int clock_row = rows;
  for (int i = 0; columns.horizon.step_free && i + 1 < stages; ++i) {
    clock.push_back({i, false});
    if (columns.horizon.chained(i)) clock.push_back({i, true});
  }
  rows += static_cast<int>(clock.size());
  closure_row = rows;
  rows += closure_rows();
  dynamics_rows = rows;
  for (ConstraintEntry& entry : constraints) {
    if (entry.is_bounds) continue;
    entry.first_row = rows;
    rows += entry.bound->instances() * entry.bound->rows();
  }

  SparsePattern j(rows, columns.total()), h(columns.total(), columns.total());
  for (int c = 0; c < columns.total(); ++c) h.add(c, c);
  std::vector<std::vector<double>> cost_jacobians, constraint_jacobians;
  for (const CostEntry& cost : costs) {
    cost_jacobians.push_back(constant_jacobian(columns, *cost.bound));
    hessian_entries(*cost.bound, cost_jacobians.back(), h, nullptr);
  }
  for (const ConstraintEntry& entry : constraints) {
    constraint_jacobians.push_back(constant_jacobian(columns, *entry.bound));
    if (!entry.is_bounds && entry.bound->curved()) hessian_entries(*entry.bound, {}, h, nullptr);
  }
  const auto each_model_entry = [&](auto visit) {  // visit(row, column), column may be -1
    for (const BoundModel& model : columns.models) {
      const std::vector<char> entries = step_pattern(columns, model);
      for (int i = 0; i + 1 < stages; ++i) {
        const std::vector<int> step = model_step_columns(columns, model, i);
        for (int r = 0; r < model.state_tangents; ++r)
          for (std::size_t c = 0; c < step.size(); ++c) {
            const bool zero = !entries.empty() && !entries[r * step.size() + c];
            visit(model.first_row + i * model.state_tangents + r, zero ? -1 : step[c]);
          }
      }
    }
  };
  const auto each_fixed_entry = [&](auto visit) {  // visit(row, column): held inputs, clock
    for (const BoundModel& model : columns.models) {
      int row = model.first_row + model.state_tangents * (stages - 1);
      for (const int b : model.input_blocks)
        for (int i = 0; i < columns.layout.block(b).size; ++i, ++row)
          for (const int stage : {stages - 2, stages - 1})
            visit(row, columns.column(stage, columns.layout.tangent_offset(b) + i));
    }
    if (!columns.horizon.step_free) return;
    const int time = columns.layout.tangent_offset(columns.time_block);
    const int step = columns.layout.tangent_offset(columns.step_block);
    for (std::size_t k = 0; k < clock.size(); ++k) {
      const int row = clock_row + static_cast<int>(k), i = clock[k].stage;
      const int number = clock[k].step ? step : time;
      visit(row, columns.column(i, number));
      visit(row, columns.column(i + 1, number));
      if (!clock[k].step) visit(row, columns.column(i, step));
    }
  };
  const auto each_constraint_entry = [&](auto visit) {  // visit(entry, row, column or -1)
    for (std::size_t e = 0; e < constraints.size(); ++e) {
      ConstraintEntry& entry = constraints[e];
      if (entry.is_bounds) continue;
      const int m = entry.bound->rows(), width = entry.bound->width();
      for (int k = 0; k < entry.bound->instances(); ++k)
        for (int r = 0; r < m; ++r)
          for (int c = 0; c < width; ++c) {
            const bool zero = !constraint_jacobians[e].empty() &&
                              constraint_jacobians[e][(k * m + r) * width + c] == 0.0;
            visit(entry, entry.first_row + k * m + r, zero ? -1 : entry.bound->columns(k)[c]);
          }
    }
  };
  const auto curved_models = [&](auto visit) {  // visit(row, column) in the Hessian, or (-1, -1)
    for (const BoundModel& model : columns.models) {
      if (model.model->affine() && !columns.horizon.step_free) continue;
      const bool by_step = !step_pattern(columns, model).empty();  // only with it, the last column
      for (int i = 0; i + 1 < stages; ++i) {
        const std::vector<int> c = curvature_columns(columns, model, i);
        for (std::size_t a = 0; a < c.size(); ++a)
          for (std::size_t b = 0; b <= a; ++b) {
            const bool none = c[a] < 0 || c[b] < 0 || (by_step && a + 1 < c.size());
            visit(none ? -1 : std::max(c[a], c[b]), std::min(c[a], c[b]));
          }
      }
    }
  };

  const auto add_to = [](SparsePattern& pattern) {
    return [&pattern](int row, int column) {
      if (row >= 0 && column >= 0) pattern.add(row, column);
    };
  };
  each_model_entry(add_to(j));
  each_fixed_entry(add_to(j));
  each_closure_entry(add_to(j));
  each_constraint_entry([&](ConstraintEntry&, int row, int c) { add_to(j)(row, c); });
  curved_models(add_to(h));
  each_closure_pair(add_to(h));
  jacobian_pattern = j.finish();
  hessian_pattern = h.finish();

  each_model_entry([&](int row, int c) { model_slots.push_back(c < 0 ? -1 : j.slot(row, c)); });
  each_fixed_entry([&](int row, int c) { fixed_slots.push_back(j.slot(row, c)); });
  each_closure_entry([&](int row, int c) { closure_slots.push_back(j.slot(row, c)); });
  each_closure_pair([&](int row, int c) { closure_hessian_slots.push_back(h.slot(row, c)); });
  each_constraint_entry([&](ConstraintEntry& entry, int row, int c) {
    entry.jacobian_slots.push_back(c < 0 ? -1 : j.slot(row, c));
  });
  curved_models([&](int row, int c) {
    model_hessian_slots.push_back(row < 0 || c < 0 ? -1 : h.slot(row, c));
  });
  for (std::size_t k = 0; k < costs.size(); ++k)
    hessian_entries(*costs[k].bound, cost_jacobians[k], h, &costs[k].hessian_slots);
  for (ConstraintEntry& entry : constraints)
    if (!entry.is_bounds && entry.bound->curved())
      hessian_entries(*entry.bound, {}, h, &entry.hessian_slots);

  // Gauss-Newton part of the costs that never changes.
  constant_hessian.assign(hessian_pattern.nonZeros(), 0.0);
  for (std::size_t k = 0; k < costs.size(); ++k)
    if (!cost_jacobians[k].empty())
      add_gauss_newton(costs[k], cost_jacobians[k].data(), constant_hessian.data());
}

// values += 2 w J'J of one cost.
void TrajectoryProblem::Impl::add_gauss_newton(const CostEntry& cost, const double* jacobian,
                                               double* values) const {
  const int m = cost.bound->rows(), width = cost.bound->width();
  const int* slot = cost.hessian_slots.data();
  for (int k = 0; k < cost.bound->instances(); ++k) {
    const double* j = jacobian + static_cast<std::size_t>(k) * m * width;
    const int* columns_of = cost.bound->columns(k);
    for (int a = 0; a < width; ++a)
      for (int b = 0; b <= a; ++b, ++slot) {
        if (*slot < 0) continue;
        double sum = 0;
        for (int r = 0; r < m; ++r) sum += j[r * width + a] * j[r * width + b];
        const bool twice = a != b && columns_of[a] == columns_of[b];
        values[*slot] += (twice ? 4.0 : 2.0) * cost.weight * sum;
      }
  }
}

}  // namespace lapwing
