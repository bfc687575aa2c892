// SPDX-License-Identifier: Apache-2.0
// The checks catch what authors get wrong: subjects broken on purpose, one mistake each.
#include <atomic>

#include "framework/app/allocation_counter.h"
#include "framework/conformance/check.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

enum class Mistake {
  none,
  derivative,
  curvature,
  range,
  affine,
  allocates,
  nan_at_zero,
  forgetful,    // answers differ from call to call
  shared_data,  // scratch in the object
  differs_without_derivatives,
  identity,
  throws,
  unwritten,  // leaves zeros of the Jacobian unwritten
  crossed_bounds,
  refuses,
};

// By hand, through the virtual layer:  y = (p.x^2 + yaw, 3 p.z) per stage.
template <class Base>
class Handmade final : public Base {
 public:
  explicit Handmade(Mistake mistake) : mistake_(mistake) {
    if (mistake == Mistake::refuses) throw InputError("not even its own defaults will do");
  }

  FunctionShape bind(const ProblemSetting& setting) override {
    return {.blocks = setting.layout.indices({"position", "yaw"}),
            .rows = 2,
            .affine = mistake_ == Mistake::affine,
            .identity = mistake_ == Mistake::identity};
  }

  void evaluate(InstanceRange range, const double* inputs, double* values, double* jacobian,
                Workspace&) const override {
    if (mistake_ == Mistake::throws) throw std::runtime_error("no");
    for (int k = 0; k < range.count; ++k) {
      const int read = mistake_ == Mistake::range ? 0 : k;
      const double* x = inputs + 4 * read;
      values[2 * k] = x[0] * x[0] + x[3];
      values[2 * k + 1] = 3 * x[2];
      if (mistake_ == Mistake::nan_at_zero) values[2 * k] *= x[1] / x[1];
      if (mistake_ == Mistake::forgetful) values[2 * k] += 1e-6 * calls_++;
      if (mistake_ == Mistake::differs_without_derivatives && !jacobian) values[2 * k] += 1e-3;
      if (mistake_ == Mistake::shared_data) values[2 * k] = through_the_object(values[2 * k]);
      if (mistake_ == Mistake::allocates) values[2 * k] += std::vector<double>(100, 0.0)[k];
      if (!jacobian) continue;
      double* j = jacobian + 8 * k;
      if (mistake_ != Mistake::unwritten) std::fill_n(j, 8, 0.0);
      j[0] = (mistake_ == Mistake::derivative ? 1.99 : 2.0) * x[0];
      j[3] = 1;
      j[6] = 3;
    }
  }

  void curvature(InstanceRange range, const double*, const double* multipliers, double* hessian,
                 Workspace&) const override {
    for (int k = 0; k < range.count; ++k)
      hessian[16 * k] += (mistake_ == Mistake::curvature ? 1.0 : 2.0) * multipliers[2 * k];
  }

  void bounds(InstanceRange range, double* lower, double* upper) const {
    std::fill_n(lower, 2 * range.count, mistake_ == Mistake::crossed_bounds ? 2.0 : -1.0);
    std::fill_n(upper, 2 * range.count, 1.0);
  }

 private:
  double through_the_object(double value) const {
    scratch_.store(value);
    for (int i = 0; i < 2000; ++i) std::atomic_thread_fence(std::memory_order_seq_cst);
    return scratch_.load();
  }

  Mistake mistake_;
  mutable std::atomic<double> scratch_{0};
  mutable std::atomic<int> calls_{0};
};

CheckOptions counting() {
  CheckOptions options;
  options.allocations = allocation_counter();
  return options;
}

std::vector<std::string> failures(const std::vector<CheckResult>& results) {
  std::vector<std::string> names;
  for (const CheckResult& result : results)
    if (result.outcome == Outcome::failed) {
      names.push_back(result.name);
      EXPECT_FALSE(result.message.empty());
    }
  return names;
}

std::vector<std::string> failures_of_term(Mistake mistake) {
  return failures(check_cost_term(
      {"handmade", {}, [=](const Value&) { return std::make_unique<Handmade<CostTerm>>(mistake); }},
      counting()));
}

std::vector<std::string> failures_of_constraint(Mistake mistake) {
  return failures(check_constraint(
      {"handmade",
       {},
       [=](const Value&) { return std::make_unique<Handmade<Constraint>>(mistake); }},
      counting()));
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

TEST(BrokenTerm, TheSoundOnePasses) {
  EXPECT_EQ(failures_of_term(Mistake::none), std::vector<std::string>{});
  EXPECT_EQ(failures_of_constraint(Mistake::none), std::vector<std::string>{});
}

TEST(BrokenTerm, IsCaught) {
  EXPECT_TRUE(contains(failures_of_term(Mistake::derivative), "derivatives"));
  EXPECT_EQ(failures_of_term(Mistake::curvature), std::vector<std::string>{"curvature"});
  EXPECT_TRUE(contains(failures_of_term(Mistake::range), "ranges"));
  EXPECT_EQ(failures_of_term(Mistake::affine), std::vector<std::string>{"affine"});
  EXPECT_EQ(failures_of_term(Mistake::nan_at_zero), std::vector<std::string>{"degenerate input"});
  EXPECT_TRUE(contains(failures_of_term(Mistake::forgetful), "repeatable"));
  EXPECT_TRUE(contains(failures_of_term(Mistake::differs_without_derivatives), "values"));
  EXPECT_TRUE(contains(failures_of_term(Mistake::identity), "identity"));
  EXPECT_TRUE(contains(failures_of_term(Mistake::throws), "exceptions"));
  EXPECT_TRUE(contains(failures_of_term(Mistake::unwritten), "derivatives"));
  EXPECT_TRUE(contains(failures_of_term(Mistake::refuses), "creation"));
  EXPECT_EQ(failures_of_constraint(Mistake::crossed_bounds), std::vector<std::string>{"bounds"});
}

TEST(BrokenTerm, IsCaughtSharingDataBetweenThreads) {
  bool caught = false;  // a race shows when threads meet, which a busy machine may delay
  for (int turn = 0; turn < 20 && !caught; ++turn)
    caught = contains(failures_of_term(Mistake::shared_data), "threads");
  EXPECT_TRUE(caught);
}

TEST(BrokenTerm, IsCaughtAllocating) {
  if (allocation_counter() == nullptr) {
    const auto results =
        check_cost_term({"handmade", {}, [](const Value&) {
                           return std::make_unique<Handmade<CostTerm>>(Mistake::allocates);
                         }});
    for (const CheckResult& result : results) {
      if (result.name != "allocations") continue;
      EXPECT_EQ(result.outcome, Outcome::skipped);
    }
    return;
  }
  EXPECT_EQ(failures_of_term(Mistake::allocates), std::vector<std::string>{"allocations"});
}

TEST(BrokenTerm, MessagesNameTheEntry) {
  const auto results =
      check_cost_term({"handmade", {}, [](const Value&) {
                         return std::make_unique<Handmade<CostTerm>>(Mistake::derivative);
                       }});
  for (const CheckResult& result : results)
    if (result.name == "derivatives") {
      EXPECT_NE(result.message.find("row 0"), std::string::npos) << result.message;
      EXPECT_NE(result.message.find("position[0] of stage 0"), std::string::npos) << result.message;
      EXPECT_NE(result.message.find("defaults"), std::string::npos) << result.message;
    }
}

// Words that are held to must be known ones, on plugins that they speak of.
TEST(BrokenDescription, IsCaught) {
  const auto judged = [](const std::string& kind, const std::string& word) {
    PluginEntry entry;
    entry.kind = kind;
    entry.name = "handmade";
    entry.version = "1.0.0";
    entry.summary = "says one word of itself";
    entry.extensions = {word};
    return failures(check_description(entry));
  };
  const std::vector<std::string> wrong{"description"};
  EXPECT_TRUE(judged("cost_term", "invariant_to_translation").empty());
  EXPECT_TRUE(judged("utility", "monotone").empty());
  EXPECT_TRUE(judged("utility", "needs_ground_truth").empty());
  EXPECT_EQ(judged("cost_term", "invariant_to_translaton"), wrong);
  EXPECT_EQ(judged("map", "invariant_to_time"), wrong);
  EXPECT_EQ(judged("constraint", "monotone"), wrong);
}

// Parameters that the table allows and the plugin cannot bear.
class Picky final : public DifferentiableCost<Picky> {
 public:
  static ParameterTable parameters() {
    return ParameterTable{}.number("reach", 1.0, "m", "divides by it", between(0, 10));
  }
  explicit Picky(const Parameters& parameters) : reach_(parameters.number("reach")) {}
  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks = setting.layout.indices({"yaw"}), .rows = 1};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    rows[0] = stage.scalar(0) / reach_;
  }

 private:
  double reach_;
};

TEST(BrokenTerm, IsCaughtAtTheEndsOfItsParameters) {
  const auto results =
      check_cost_term({"picky", Picky::parameters(), [](const Value& given) {
                         return std::make_unique<Picky>(check(Picky::parameters(), given));
                       }});
  const auto names = failures(results);
  EXPECT_TRUE(contains(names, "values"));
  for (const CheckResult& result : results) {
    if (result.name != "values") continue;
    EXPECT_NE(result.message.find("reach = 0"), std::string::npos) << result.message;
  }
}

// A model whose halves do not make a whole, and that forgets its input in samples.
class Sloppy final : public DifferentiableModel<Sloppy, 2, 1> {
 public:
  explicit Sloppy(bool sloppy) : sloppy_(sloppy) {}
  void bind(const Vehicle&) override {}
  std::vector<BlockSpec> blocks() const override {
    return {{.name = "place"}, {.name = "rate"}, {.name = "push", .role = BlockRole::input}};
  }
  bool affine() const override { return true; }
  template <class T>
  void next_state(const T* state, const T* input, const T& step, T* next) const {
    next[0] = state[0] + step * state[1] + (sloppy_ ? 0.4 : 0.5) * step * step * input[0];
    next[1] = state[1] + step * input[0];
  }
  void to_sample(const double* numbers, Sample& sample) const override {
    sample.position.x() = numbers[0];
    sample.velocity.x() = numbers[1];
    if (!sloppy_) sample.acceleration.x() = numbers[2];
  }
  void from_sample(const Sample& sample, double* numbers) const override {
    numbers[0] = sample.position.x();
    numbers[1] = sample.velocity.x();
    numbers[2] = sample.acceleration.x();
  }
  void bounds(double* lower, double* upper) const override {
    std::fill_n(lower, 3, sloppy_ ? 1.0 : -HUGE_VAL);
    std::fill_n(upper, 3, sloppy_ ? -1.0 : HUGE_VAL);
  }
  void describe(Trajectory&) const override {}

 private:
  bool sloppy_;
};

TEST(BrokenModel, IsCaught) {
  const auto names_of = [](bool sloppy) {
    return failures(check_vehicle_model(
        {"sloppy", {}, [=](const Value&) { return std::make_unique<Sloppy>(sloppy); }},
        counting()));
  };
  EXPECT_EQ(names_of(false), std::vector<std::string>{});
  EXPECT_EQ(names_of(true), (std::vector<std::string>{"bounds", "halves", "samples"}));
}

// Returns where it began and calls it the optimum.
class Boaster final : public TrajectorySolver {
 public:
  SolveResult solve(const TrajectoryProblem& problem, const SolveRequest&) const override {
    SolveResult result;
    result.point.stages = problem.initial_guess();
    result.report.status = SolveStatus::optimal;
    result.report.iterations = 3;
    result.report.cost = problem.cost(result.point.stages);
    return result;
  }
};

TEST(BrokenSolver, IsCaught) {
  const auto names = failures(check_trajectory_solver(
      {"boaster", {}, [](const Value&) { return std::make_unique<Boaster>(); }}));
  for (const char* name :
       {"optimum", "infeasible", "status", "reported violations", "work limit", "cancellation"})
    EXPECT_TRUE(contains(names, name)) << name;
}

}  // namespace
}  // namespace lapwing
