// SPDX-License-Identifier: Apache-2.0
// What every vehicle model must pass.
#include <cmath>
#include <thread>

#include "framework/conformance/differences.h"
#include "framework/conformance/findings.h"
#include "framework/conformance/sample_parameters.h"
#include "framework/conformance/standard_setting.h"
#include "framework/verify/verify.h"

namespace lapwing {
namespace {

constexpr double kModelStep = 0.1;  // s
constexpr int kModelPoints = 5;

// A model with the sizes that its blocks give it.
class ModelCheck {
 public:
  ModelCheck(const VehicleModel& model, const CheckOptions& options, Findings& findings)
      : model_(model), options_(options), findings_(findings), random_(options.seed) {
    for (const BlockSpec& block : model.blocks()) {
      (block.role == BlockRole::state ? n_ : m_) += block.size;
      (block.role == BlockRole::state ? states_ : inputs_).push_back(block);
    }
    width_ = n_ + m_ + 1;
  }

  void run() {
    if (!blocks()) return;
    if (options_.wants("bounds")) bounds();
    if (options_.wants("motion")) motion();
    for (int point = 0; point < kModelPoints; ++point) {
      const std::vector<double> x = arguments(kModelStep);
      if (options_.wants_any({"flow", "degenerate input"})) flow(x);
      if (options_.wants("derivatives")) derivatives(x);
      if (options_.wants("curvature")) curvature(x);
      if (options_.wants("halves")) halves(x);
      if (options_.wants("samples")) samples(x);
    }
    for (int point = 0; point < kModelPoints; ++point) {
      const std::vector<double> x = arguments(kModelStep, 40);
      if (options_.wants("derivatives")) derivatives(x);
      if (options_.wants("curvature")) curvature(x);
    }
    if (options_.wants("ranges")) ranges();
    if (options_.wants_any({"repeatable", "threads", "allocations"})) threads_and_allocations();
    if (model_.affine() && options_.wants("affine")) affine();
  }

 private:
  bool blocks() {
    StageLayout layout;
    bool fits = findings_.survives("blocks", "its list of blocks", [&] {
      for (const BlockSpec& block : model_.blocks()) layout.add(block);
    });
    bool order = true, input_seen = false, orientation = false;
    for (const BlockSpec& block : model_.blocks()) {
      order &= block.role == BlockRole::input || (block.role == BlockRole::state && !input_seen);
      input_seen |= block.role == BlockRole::input;
      orientation |= block.topology == Topology::quaternion;
    }
    findings_.expect("blocks", n_ > 0, [] { return "has no state"; });
    findings_.expect("blocks", order, [] { return "states come first, then inputs"; });
    findings_.expect("blocks", !(orientation && model_.affine()),
                     [] { return "no model of an orientation is affine"; });
    return fits && order && n_ > 0;
  }

  std::vector<double> arguments(double step, double spread = 2) {
    std::vector<double> x;
    for (const auto* blocks : {&states_, &inputs_})
      for (const BlockSpec& block : *blocks) {
        const std::size_t first = x.size();
        for (int i = 0; i < block.size; ++i) x.push_back(random_.uniform(-spread, spread));
        if (block.topology == Topology::quaternion)
          Eigen::Map<Eigen::VectorXd>(x.data() + first, block.size).normalize();
      }
    x.push_back(step);
    return x;
  }

  std::vector<double> next(const std::vector<double>& x) const {
    std::vector<double> result(n_, std::nan(""));
    Workspace workspace;
    model_.flow({0, 1}, x.data(), result.data(), nullptr, workspace);
    return result;
  }

  std::string name_of(int number) const {
    for (const auto* blocks : {&states_, &inputs_})
      for (const BlockSpec& block : *blocks) {
        if (number < block.size)
          return block.size == 1 ? block.name : block.name + "[" + std::to_string(number) + "]";
        number -= block.size;
      }
    return "step";
  }

  // Distance of two states, block by block in its own topology.
  double distance(const double* a, const double* b) const {
    double worst = 0;
    for (const BlockSpec& block : states_) {
      std::vector<double> delta(block.tangent_size());
      block_difference(block, a, b, delta.data());
      for (const double d : delta) worst = std::max(worst, std::isnan(d) ? HUGE_VAL : std::abs(d));
      a += block.size;
      b += block.size;
    }
    return worst;
  }

  void bounds() {
    std::vector<double> lower(n_ + m_, std::nan("")), upper(lower);
    model_.bounds(lower.data(), upper.data());
    for (int i = 0; i < n_ + m_; ++i)
      findings_.expect("bounds",
                       lower[i] <= upper[i] && lower[i] < HUGE_VAL && upper[i] > -HUGE_VAL,
                       [&] { return name_of(i) + " has bounds without anything between them"; });
  }

  // What the trajectory says of its motion, and whether samples have what it says.
  void motion() {
    Trajectory trajectory;
    trajectory.motion = {};
    model_.describe(trajectory);
    const MotionRecord& motion = trajectory.motion;
    if (motion.name.empty()) {  // a model beside another, such as a gimbal, says nothing
      const bool whole = std::any_of(states_.begin(), states_.end(), [](const BlockSpec& block) {
        return block.name == "position";
      });
      findings_.expect("motion", !whole, [] {
        return "it has a block 'position', and `describe` names no motion of the trajectory";
      });
      return;
    }
    for (const std::string& problem : motion_faults(motion)) findings_.fail("motion", problem);
    Sample sample;
    model_.to_sample(arguments(kModelStep).data(), sample);
    for (const MotionColumn& column : motion.columns)
      findings_.expect(
          "motion",
          sample.columns.find(column.name).size() == static_cast<std::size_t>(column.size), [&] {
            return "samples lack the column '" + column.name + "' of " +
                   std::to_string(column.size) + " numbers, which the motion '" + motion.name +
                   "' states";
          });
    findings_.expect("motion", true, {});
  }

  void flow(std::vector<double> x) {
    for (const double value : next(x))
      findings_.expect("flow", std::isfinite(value), [] { return "the next state is not finite"; });
    x.back() = 0;
    findings_.expect("flow", distance(next(x).data(), x.data()) < 1e-12,
                     [] { return "a step of no length moves the state"; });
    std::fill(x.begin(), x.end() - 1, 0.0);
    x.back() = kModelStep;
    int at = 0;
    for (const BlockSpec& block : states_) {
      if (block.topology == Topology::quaternion) x[at] = 1;
      at += block.size;
    }
    std::vector<double> jacobian(n_ * width_), values(n_);
    Workspace workspace;
    model_.flow({0, 1}, x.data(), values.data(), jacobian.data(), workspace);
    bool finite = true;
    for (const auto* numbers : {&values, &jacobian})
      for (const double value : *numbers) finite &= std::isfinite(value);
    findings_.expect("degenerate input", finite,
                     [] { return "the flow or its derivative is not finite at zero"; });
  }

  void derivatives(const std::vector<double>& x) {
    RowMajorMatrix stated = RowMajorMatrix::Constant(n_, width_, std::nan(""));
    std::vector<double> with(n_);
    Workspace workspace;
    model_.flow({0, 1}, x.data(), with.data(), stated.data(), workspace);
    findings_.expect("flow", distance(with.data(), next(x).data()) < 1e-12,
                     [] { return "the next state depends on whether derivatives are asked"; });
    if (!stated.allFinite()) return findings_.fail("derivatives", "an entry is not finite");
    const WorstEntry worst = compare_derivatives(
        [&](const double* at, double* y) {
          model_.flow({0, 1}, at, y, nullptr, workspace);
        },
        x, stated, 1e-6);
    findings_.expect("derivatives", worst.excess <= 1, [&] {
      return "d " + name_of(worst.row) + " / d " + name_of(worst.column) + ": says " +
             text_of(worst.stated) + ", differences give " + text_of(worst.expected);
    });
  }

  void curvature(const std::vector<double>& x) {
    std::vector<double> lambda(n_), values(n_);
    for (double& l : lambda) l = random_.uniform(-1, 1);
    RowMajorMatrix stated = RowMajorMatrix::Constant(width_, width_, 0.5), jacobian(n_, width_);
    Workspace workspace;
    model_.curvature({0, 1}, x.data(), lambda.data(), stated.data(), workspace);
    stated.array() -= 0.5;
    if (!stated.allFinite()) return findings_.fail("curvature", "an entry is not finite");
    const WorstEntry worst = compare_derivatives(
        [&](const double* at, double* y) {
          model_.flow({0, 1}, at, values.data(), jacobian.data(), workspace);
          Eigen::Map<Eigen::VectorXd>(y, width_) =
              jacobian.transpose() * Eigen::Map<const Eigen::VectorXd>(lambda.data(), n_);
        },
        x, stated, 1e-5);
    findings_.expect("curvature", worst.excess <= 1, [&] {
      return "d2 / d " + name_of(worst.row) + " d " + name_of(worst.column) + ": says " +
             text_of(worst.stated) + ", differences give " + text_of(worst.expected);
    });
  }

  // Held inputs: two halves of a step make the step. Exact where the model is affine; an integrator
  // may differ by its error.
  void halves(std::vector<double> x) {
    const std::vector<double> whole = next(x);
    x.back() = kModelStep / 2;
    for (int half = 0; half < 2; ++half) {
      const std::vector<double> half_way = next(x);
      std::copy(half_way.begin(), half_way.end(), x.begin());
    }
    const double error = distance(whole.data(), x.data());
    findings_.expect("halves", error < (model_.affine() ? 1e-9 : 1e-3), [&] {
      return "one step and two of half its length end " + std::to_string(error) + " apart";
    });
  }

  void samples(const std::vector<double>& x) {
    Sample sample;
    model_.to_sample(x.data(), sample);
    std::vector<double> back(n_ + m_, std::nan(""));
    model_.from_sample(sample, back.data());
    double worst = distance(x.data(), back.data());
    for (int i = n_; i < n_ + m_; ++i)
      worst = std::max(worst, std::isnan(back[i]) ? HUGE_VAL : std::abs(back[i] - x[i]));
    findings_.expect("samples", worst < 1e-12,
                     [&] { return "a sample read back differs by " + std::to_string(worst); });
  }

  struct Answer {
    std::vector<double> next, jacobian, hessian;
    bool operator==(const Answer&) const = default;
  };
  Answer ask(const std::vector<double>& x, int count, Workspace& workspace) const {
    Answer answer{std::vector<double>(count * n_), std::vector<double>(count * n_ * width_),
                  std::vector<double>(count * width_ * width_)};
    const std::vector<double> lambda(count * n_, 0.7);
    call(x, lambda, answer, count, workspace);
    return answer;
  }
  void call(const std::vector<double>& x, const std::vector<double>& lambda, Answer& answer,
            int count, Workspace& workspace) const {
    model_.flow({0, count}, x.data(), answer.next.data(), answer.jacobian.data(), workspace);
    model_.curvature({0, count}, x.data(), lambda.data(), answer.hessian.data(), workspace);
  }

  std::vector<double> many(int count) {
    std::vector<double> result;
    for (int k = 0; k < count; ++k) {
      const std::vector<double> x = arguments(kModelStep * (1 + k));
      result.insert(result.end(), x.begin(), x.end());
    }
    return result;
  }

  void ranges() {
    const int count = 5;
    const std::vector<double> x = many(count);
    Workspace workspace;
    const Answer whole = ask(x, count, workspace);
    for (int k = 0; k < count; ++k) {
      const Answer one = ask({x.begin() + k * width_, x.begin() + (k + 1) * width_}, 1, workspace);
      double worst = 0;
      const auto compare = [&](const std::vector<double>& a, const std::vector<double>& b) {
        for (std::size_t i = 0; i < a.size(); ++i) {
          const double scale = std::max(1.0, std::abs(a[i]));
          worst = std::max(worst, std::abs(a[i] - b[k * a.size() + i]) / scale);
        }
      };
      compare(one.next, whole.next);
      compare(one.jacobian, whole.jacobian);
      compare(one.hessian, whole.hessian);
      findings_.expect("ranges", worst < 1e-12, [&] {
        return "stage " + std::to_string(k) + " alone differs from the same in a range";
      });
    }
  }

  void threads_and_allocations() {
    const int count = 5;
    const std::vector<double> x = many(count), lambda(count * n_, 0.7);
    Workspace workspace;
    Answer first = ask(x, count, workspace);
    findings_.expect("repeatable", first == ask(x, count, workspace),
                     [] { return "the same inputs give two answers"; });
    std::array<bool, 4> same{};
    std::vector<std::thread> threads;
    for (bool& fine : same)
      threads.emplace_back([&] {
        Workspace own;
        fine = true;
        for (int turn = 0; turn < 20; ++turn) fine &= ask(x, count, own) == first;
      });
    for (std::thread& thread : threads) thread.join();
    findings_.expect("threads", same[0] && same[1] && same[2] && same[3],
                     [] { return "four threads at once get other answers than one alone"; });
    if (!options_.allocations)
      return findings_.skip("allocations", "this program does not count them");
    const auto expect_none = [&](const std::vector<double>& at, int stages, const char* what) {
      const std::int64_t before = options_.allocations();
      call(at, lambda, first, stages, workspace);
      const std::int64_t made = options_.allocations() - before;
      findings_.expect("allocations", made == 0, [&] {
        return std::to_string(made) +
               " heap allocations in calls that come again and again: " + what;
      });
    };
    expect_none(x, count, "the same inputs twice");
    expect_none(many(count), count, "inputs that it was not asked before");
    expect_none(arguments(kModelStep), 1, "one stage alone");
  }

  void affine() {
    Workspace workspace;
    const Answer first = ask(arguments(kModelStep), 1, workspace);
    for (int point = 0; point < kModelPoints; ++point) {
      const Answer other = ask(arguments(kModelStep), 1, workspace);
      double worst = 0;
      for (int r = 0; r < n_; ++r)
        for (int c = 0; c + 1 < width_; ++c)
          worst = std::max(
              worst, std::abs(first.jacobian[r * width_ + c] - other.jacobian[r * width_ + c]));
      findings_.expect("affine", worst < 1e-9, [&] {
        return "declared affine, but its Jacobian changes by " + std::to_string(worst);
      });
    }
  }

  const VehicleModel& model_;
  const CheckOptions& options_;
  Findings& findings_;
  Random random_;
  std::vector<BlockSpec> states_, inputs_;
  int n_ = 0, m_ = 0, width_ = 0;
};

}  // namespace

std::vector<CheckResult> check_vehicle_model(const Specimen<VehicleModel>& subject,
                                             const CheckOptions& options) {
  Findings findings(options);
  const StandardSetting standard(false);
  for (const ParameterCase& parameter_case : parameter_cases(subject.parameters, standard)) {
    findings.set_case(parameter_case.description);
    try {
      const std::unique_ptr<VehicleModel> model = subject.create(parameter_case.parameters);
      model->bind(standard.vehicle);
      findings.expect("creation", true, {});
      if (!options.wants_answers()) continue;
      findings.survives("exceptions", "an evaluation",
                        [&] { ModelCheck(*model, options, findings).run(); });
    } catch (const InputError& error) {
      findings.expect("creation", !parameter_case.must_work,
                      [&] { return std::string("refused: ") + error.what(); });
    } catch (const std::exception& error) {
      findings.fail("creation", std::string("throws: ") + error.what());
    }
  }
  findings.set_case("");
  return std::move(findings).results();
}

}  // namespace lapwing
