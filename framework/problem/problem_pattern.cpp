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

// visit(row, column) in the lower triangle, the row -1 where there is no entry.
template <class Visit>
void hessian_entries(const BoundFunction& bound, const std::vector<double>& jacobian, Visit visit) {
  for (int k = 0; k < bound.instances(); ++k)
    visit_pairs(bound, jacobian, k, [&](int a, int b, bool meets) {
      const int row = std::max(bound.columns(k)[a], bound.columns(k)[b]);
      visit(meets ? row : -1, std::min(bound.columns(k)[a], bound.columns(k)[b]));
    });
}

// Whether slots in a pattern are those of the entries that `each` visits.
class KnownSlots {
 public:
  explicit KnownSlots(const SparseMatrix& pattern) : pattern_(pattern) {
    column_of_.reserve(pattern.nonZeros());
    for (int c = 0; c < pattern.outerSize(); ++c)
      column_of_.resize(pattern.outerIndexPtr()[c + 1], c);
  }
  template <class Each>
  bool are(const std::vector<int>& slots, Each each) const {
    std::size_t visited = 0;
    bool same = true;
    each([&](int row, int column) {
      if (!same || visited >= slots.size()) {
        same = false;
        return;
      }
      const int slot = slots[visited++];
      same = row < 0 || column < 0
                 ? slot < 0
                 : slot >= 0 && pattern_.innerIndexPtr()[slot] == row && column_of_[slot] == column;
    });
    return same && visited == slots.size();
  }

 private:
  const SparseMatrix& pattern_;
  std::vector<int> column_of_;
};

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

void TrajectoryProblem::Impl::build_patterns(const Impl* like) {
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

  std::vector<std::vector<double>> cost_jacobians, constraint_jacobians;
  for (const CostEntry& cost : costs)
    cost_jacobians.push_back(constant_jacobian(columns, *cost.bound));
  for (const ConstraintEntry& entry : constraints)
    constraint_jacobians.push_back(constant_jacobian(columns, *entry.bound));
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
  const auto each_entry_of = [&](std::size_t e, auto visit) {  // of a constraint, column may be -1
    const ConstraintEntry& entry = constraints[e];
    if (entry.is_bounds) return;
    const int m = entry.bound->rows(), width = entry.bound->width();
    for (int k = 0; k < entry.bound->instances(); ++k)
      for (int r = 0; r < m; ++r)
        for (int c = 0; c < width; ++c) {
          const bool zero = !constraint_jacobians[e].empty() &&
                            constraint_jacobians[e][(k * m + r) * width + c] == 0.0;
          visit(entry.first_row + k * m + r, zero ? -1 : entry.bound->columns(k)[c]);
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

  // Every list of slots, with its pattern and the entries that it is of: take(slots of a problem,
  // hessian?, each entry).
  const auto each_list = [&](auto take) {
    take(
        [](auto& p) -> auto& { return p.model_slots; }, false, each_model_entry);
    take(
        [](auto& p) -> auto& { return p.fixed_slots; }, false, each_fixed_entry);
    take(
        [](auto& p) -> auto& { return p.closure_slots; }, false,
        [&](auto visit) { each_closure_entry(visit); });
    take(
        [](auto& p) -> auto& { return p.closure_hessian_slots; }, true,
        [&](auto visit) { each_closure_pair(visit); });
    take(
        [](auto& p) -> auto& { return p.model_hessian_slots; }, true, curved_models);
    for (std::size_t k = 0; k < costs.size(); ++k)
      take(
          [k](auto& p) -> auto& { return p.costs[k].hessian_slots; }, true,
          [&, k](auto visit) { hessian_entries(*costs[k].bound, cost_jacobians[k], visit); });
    for (std::size_t e = 0; e < constraints.size(); ++e) {
      take(
          [e](auto& p) -> auto& { return p.constraints[e].jacobian_slots; }, false,
          [&, e](auto visit) { each_entry_of(e, visit); });
      if (!constraints[e].is_bounds && constraints[e].bound->curved())
        take(
            [e](auto& p) -> auto& { return p.constraints[e].hessian_slots; }, true,
            [&, e](auto visit) { hessian_entries(*constraints[e].bound, {}, visit); });
    }
  };
  bool known = like && like->rows == rows && like->columns.total() == columns.total() &&
               like->costs.size() == costs.size() && like->constraints.size() == constraints.size();
  if (known) {
    const KnownSlots of_jacobian(like->jacobian_pattern), of_hessian(like->hessian_pattern);
    each_list([&](auto slots, bool hessian, auto each) {
      known = known && (hessian ? of_hessian : of_jacobian).are(slots(*like), each);
    });
    for (std::size_t e = 0; e < constraints.size(); ++e)
      known = known && (like->constraints[e].hessian_slots.empty() ==
                        (constraints[e].is_bounds || !constraints[e].bound->curved()));
  }
  if (known) {
    jacobian_pattern = like->jacobian_pattern;
    hessian_pattern = like->hessian_pattern;
    each_list([&](auto slots, bool, auto) { slots(*this) = slots(*like); });
  } else {
    SparsePattern j(rows, columns.total()), h(columns.total(), columns.total());
    for (int c = 0; c < columns.total(); ++c) h.add(c, c);
    each_list([&](auto, bool hessian, auto each) {
      each([&](int row, int column) {
        if (row >= 0 && column >= 0) (hessian ? h : j).add(row, column);
      });
    });
    jacobian_pattern = j.finish();
    hessian_pattern = h.finish();
    each_list([&](auto slots, bool hessian, auto each) {
      std::vector<int>& list = slots(*this);
      each([&](int row, int column) {
        list.push_back(row < 0 || column < 0 ? -1 : (hessian ? h : j).slot(row, column));
      });
    });
  }

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
