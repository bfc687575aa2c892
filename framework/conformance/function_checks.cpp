#include "framework/conformance/function_checks.h"

#include <cmath>
#include <thread>

#include "framework/conformance/differences.h"
#include "framework/conformance/sample_parameters.h"

namespace lapwing {
namespace {

constexpr double kFirst = 1e-6, kSecond = 1e-5;  // relative, of derivatives against differences
constexpr double kRounding = 1e-12;
constexpr int kPoints = 3;  // inputs of every instance are drawn this often

bool all_finite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

bool nearly(double a, double b, double scale = 1.0) {
  return std::abs(a - b) <= kRounding * std::max({scale, std::abs(a), std::abs(b)}) ||
         (std::isnan(a) && std::isnan(b));
}

// What a function answers for a range of instances.
struct Answer {
  std::vector<double> values, jacobian, curvature;
  bool operator==(const Answer&) const = default;
};

class FunctionCheck {
 public:
  FunctionCheck(const BoundSubject& subject, const CheckOptions& options, Findings& findings)
      : subject_(subject),
        options_(options),
        findings_(findings),
        random_(options.seed),
        places_(input_places(subject.shape, subject.standard.layout)),
        n_(static_cast<int>(places_.size())),
        m_(subject.shape.rows) {}

  void run() {
    for (int point = 0; point < kPoints; ++point) {
      const std::vector<double> x = inputs(InputKind::random);
      if (wants("values") || wants("derivatives")) values_and_derivatives(x);
      if (!subject_.shape.affine && wants("curvature")) curvature(x);
      if (wants("ranges")) ranges(x);
    }
    if (wants("degenerate input")) degenerate();
    const std::vector<double> x = inputs(InputKind::random);
    if (wants("repeatable")) repeatable(x);
    if (wants("threads")) threads(x);
    if (wants("allocations")) allocations(x);
    if (subject_.shape.affine && wants("affine")) affine();
    if (subject_.shape.identity && wants("identity")) identity(x);
  }

 private:
  bool wants(const char* check) const { return options_.wants(check); }

  std::vector<double> inputs(InputKind kind) {
    return make_inputs(subject_.standard, subject_.shape, kind, random_);
  }
  std::vector<double> multipliers(int count) const {
    std::vector<double> result(static_cast<std::size_t>(count) * m_);
    for (std::size_t k = 0; k < result.size(); ++k) result[k] = std::sin(1.0 + 2.0 * k);
    return result;
  }

  // Buffers start full of a number that no answer holds: what is not written shows.
  Answer ask(InstanceRange range, const double* x, Workspace& workspace) const {
    const std::size_t count = range.count;
    Answer answer{std::vector<double>(count * m_, kUntouched),
                  std::vector<double>(count * m_ * n_, kUntouched),
                  std::vector<double>(count * n_ * n_, 0.0)};
    subject_.function.evaluate(range, x, answer.values.data(), answer.jacobian.data(), workspace);
    if (!subject_.shape.affine)
      subject_.function.curvature(range, x, multipliers(range.count).data(),
                                  answer.curvature.data(), workspace);
    return answer;
  }
  Answer ask_all(const std::vector<double>& x) const {
    Workspace workspace;
    return ask({0, subject_.count}, x.data(), workspace);
  }

  std::string input_name(int input) const {
    const InputPlace& place = places_[input];
    return component_text(place) + " of stage " + std::to_string(place.stage) + " of the window";
  }
  std::string component_text(const InputPlace& place) const {
    const BlockSpec& block = subject_.standard.layout.block(place.block);
    return block.size == 1 ? block.name : block.name + "[" + std::to_string(place.component) + "]";
  }
  std::string row_name(int row) const {
    const auto& names = subject_.shape.row_names;
    return names.empty() ? "row " + std::to_string(row) : "row '" + names[row] + "'";
  }

  void values_and_derivatives(const std::vector<double>& x) {
    const Answer answer = ask_all(x);
    Workspace workspace;
    std::vector<double> alone(answer.values.size(), kUntouched);
    subject_.function.evaluate({0, subject_.count}, x.data(), alone.data(), nullptr, workspace);
    for (int k = 0; k < subject_.count; ++k)
      for (int r = 0; r < m_; ++r) {
        const double value = answer.values[k * m_ + r], without = alone[k * m_ + r];
        const auto at = [&] { return row_name(r) + " of instance " + std::to_string(k); };
        findings_.expect("values", std::isfinite(value) && value != kUntouched,
                         [&] { return at() + " is " + std::to_string(value); });
        findings_.expect("values", nearly(value, without), [&] {
          return at() + " is " + std::to_string(without) + ", but " + std::to_string(value) +
                 " when derivatives are asked too";
        });
      }
    for (int k = 0; wants("derivatives") && k < subject_.count; ++k) derivatives_of(x, answer, k);
  }

  void derivatives_of(const std::vector<double>& x, const Answer& answer, int k) {
    const std::vector<double> at(x.begin() + k * n_, x.begin() + (k + 1) * n_);
    const Eigen::Map<const RowMajorMatrix> stated(answer.jacobian.data() + k * m_ * n_, m_, n_);
    if (!findings_finite("derivatives", answer.jacobian)) return;
    Workspace workspace;
    const auto function = [&](const double* inputs, double* values) {
      subject_.function.evaluate({k, 1}, inputs, values, nullptr, workspace);
    };
    const WorstEntry worst = compare_derivatives(function, at, stated, kFirst);
    findings_.expect("derivatives", worst.excess <= 1, [&] {
      return "d " + row_name(worst.row) + " / d " + input_name(worst.column) + ", instance " +
             std::to_string(k) + ": says " + std::to_string(worst.stated) + ", differences give " +
             std::to_string(worst.expected);
    });
  }

  bool findings_finite(const std::string& check, const std::vector<double>& numbers) {
    bool fine = all_finite(numbers);
    for (const double x : numbers) fine &= x != kUntouched;
    findings_.expect(check, fine, [] { return "an entry is not finite, or was never written"; });
    return fine;
  }

  void curvature(const std::vector<double>& x) {
    for (int k = 0; k < subject_.count; ++k) {
      const std::vector<double> at(x.begin() + k * n_, x.begin() + (k + 1) * n_);
      const std::vector<double> lambda = multipliers(1);
      Workspace workspace;
      RowMajorMatrix stated = RowMajorMatrix::Constant(n_, n_, 0.5);  // must be added to
      subject_.function.curvature({k, 1}, at.data(), lambda.data(), stated.data(), workspace);
      stated.array() -= 0.5;
      std::vector<double> values(m_);
      RowMajorMatrix jacobian(m_, n_);
      const auto slope = [&](const double* inputs, double* result) {
        subject_.function.evaluate({k, 1}, inputs, values.data(), jacobian.data(), workspace);
        Eigen::Map<Eigen::VectorXd>(result, n_) =
            jacobian.transpose() * Eigen::Map<const Eigen::VectorXd>(lambda.data(), m_);
      };
      if (!stated.allFinite()) return findings_.fail("curvature", "an entry is not finite");
      const WorstEntry worst = compare_derivatives(slope, at, stated, kSecond);
      findings_.expect("curvature", worst.excess <= 1, [&] {
        return "d2 / d " + input_name(worst.row) + " d " + input_name(worst.column) +
               ", instance " + std::to_string(k) + ": says " + std::to_string(worst.stated) +
               ", differences give " + std::to_string(worst.expected);
      });
    }
  }

  // A range answers as its instances do one by one.
  void ranges(const std::vector<double>& x) {
    const Answer whole = ask_all(x);
    Workspace workspace;
    for (int k = 0; k < subject_.count; ++k) {
      const Answer one = ask({k, 1}, x.data() + k * n_, workspace);
      bool same = true;
      for (int r = 0; r < m_; ++r) same &= nearly(one.values[r], whole.values[k * m_ + r]);
      for (int e = 0; e < m_ * n_; ++e)
        same &= nearly(one.jacobian[e], whole.jacobian[k * m_ * n_ + e]);
      findings_.expect("ranges", same, [&] {
        return "instance " + std::to_string(k) + " alone differs from the same in a range of " +
               std::to_string(subject_.count);
      });
    }
  }

  void degenerate() {
    for (const auto& [kind, text] : {std::pair{InputKind::zero, "all inputs zero"},
                                     {InputKind::coincident, "all stages equal"}}) {
      const Answer answer = ask_all(inputs(kind));
      const bool finite =
          all_finite(answer.values) && all_finite(answer.jacobian) && all_finite(answer.curvature);
      findings_.expect("degenerate input", finite, [&, what = text] {
        return std::string("a value or derivative is not finite with ") + what;
      });
    }
  }

  void repeatable(const std::vector<double>& x) {
    const Answer first = ask_all(x);
    findings_.expect("repeatable", first == ask_all(x),
                     [] { return "the same inputs give two answers"; });
  }

  void threads(const std::vector<double>& x) {
    const Answer first = ask_all(x);
    std::array<bool, 4> same{};
    std::vector<std::thread> running;
    for (bool& fine : same)
      running.emplace_back([&] {
        try {
          Workspace workspace;
          fine = true;
          for (int turn = 0; turn < 20; ++turn)
            fine &= ask({0, subject_.count}, x.data(), workspace) == first;
        } catch (...) {
          fine = false;
        }
      });
    for (std::thread& thread : running) thread.join();
    findings_.expect("threads", same[0] && same[1] && same[2] && same[3],
                     [] { return "four threads at once get other answers than one alone"; });
  }

  void allocations(const std::vector<double>& x) {
    if (!options_.allocations)
      return findings_.skip("allocations", "this program does not count them");
    Workspace workspace;
    Answer answer = ask({0, subject_.count}, x.data(), workspace);
    const std::vector<double> lambda = multipliers(subject_.count);
    const InstanceRange all{0, subject_.count};
    const std::int64_t before = options_.allocations();
    subject_.function.evaluate(all, x.data(), answer.values.data(), nullptr, workspace);
    subject_.function.evaluate(all, x.data(), answer.values.data(), answer.jacobian.data(),
                               workspace);
    if (!subject_.shape.affine)
      subject_.function.curvature(all, x.data(), lambda.data(), answer.curvature.data(), workspace);
    const std::int64_t made = options_.allocations() - before;
    findings_.expect("allocations", made == 0, [&] {
      return std::to_string(made) + " heap allocations in calls that come again and again";
    });
  }

  // With a fixed step the clock stands still: nothing is differentiated by it.
  bool constant(int block) const {
    return subject_.standard.layout.block(block).role == BlockRole::clock &&
           !subject_.standard.horizon.step_free;
  }

  // A Jacobian that is the same wherever it is taken has no curvature.
  void affine() {
    const Answer first = ask_all(inputs(InputKind::random));
    for (int point = 0; point < kPoints; ++point) {
      const Answer other = ask_all(inputs(InputKind::random));
      double worst = 0, scale = 1;
      for (std::size_t e = 0; e < first.jacobian.size(); ++e) {
        if (constant(places_[e % n_].block)) continue;
        worst = std::max(worst, std::abs(first.jacobian[e] - other.jacobian[e]));
        scale = std::max(scale, std::abs(first.jacobian[e]));
      }
      findings_.expect("affine", worst <= 1e-9 * scale, [&] {
        return "declared affine, but its Jacobian changes by " + std::to_string(worst) +
               " from point to point";
      });
    }
  }

  void identity(const std::vector<double>& x) {
    findings_.expect("identity", m_ == n_, [&] {
      return "declared an identity, but reads " + std::to_string(n_) + " numbers and returns " +
             std::to_string(m_);
    });
    if (m_ == n_)
      findings_.expect("identity", ask_all(x).values == x,
                       [] { return "declared an identity, but returns other numbers"; });
  }

  static constexpr double kUntouched = 1.2345678901234567e300;
  const BoundSubject& subject_;
  const CheckOptions& options_;
  Findings& findings_;
  Random random_;
  std::vector<InputPlace> places_;
  int n_, m_;
};

// What the kernel relies on before the first evaluation.
bool shape_fits(const FunctionShape& shape, const StandardSetting& standard, Findings& findings) {
  const auto need = [&](bool ok, const std::string& message) {
    findings.expect("shape", ok, [&] { return message; });
    return ok;
  };
  bool blocks = !shape.blocks.empty();
  for (const int b : shape.blocks) blocks &= b >= 0 && b < standard.layout.count();
  bool fits = need(blocks, "reads no block, or one that does not exist");
  fits &= need(shape.rows >= 1, "returns no rows");
  fits &= need(shape.window >= 1 && shape.window <= standard.horizon.stages,
               "a window of " + std::to_string(shape.window) + " stages");
  fits &= need(shape.times.empty() || (shape.window == 1 && shape.stages.empty()),
               "given times need a window of one stage and no list of stages");
  fits &= need(shape.row_names.empty() || static_cast<int>(shape.row_names.size()) == shape.rows,
               "names another number of rows than it returns");
  for (const int stage : shape.stages)
    fits &= need(stage >= 0 && stage + shape.window <= standard.horizon.stages,
                 "asks for a stage outside the horizon");
  for (const double time : shape.times)
    fits &= need(std::isfinite(time), "asks for a time that is no number");
  return fits;
}

}  // namespace

void check_stage_function(const ParameterTable& parameters,
                          const std::function<std::unique_ptr<StageFunction>(const Value&)>& create,
                          const CheckOptions& options, Findings& findings,
                          const std::function<void(const BoundSubject&)>& also) {
  for (const bool step_free : {false, true}) {
    const StandardSetting standard(step_free);
    for (const ParameterCase& parameter_case : parameter_cases(parameters, standard)) {
      findings.set_case(parameter_case.description + (step_free ? ", free step" : ""));
      try {
        const std::unique_ptr<StageFunction> function = create(parameter_case.parameters);
        const FunctionShape shape = function->bind(standard.setting());
        findings.expect("creation", function != nullptr, [] { return "creates nothing"; });
        // A case may leave nothing to ask: a cut over all stages.
        if (shape.rows == 0 && !parameter_case.must_work) continue;
        if (!shape_fits(shape, standard, findings)) continue;
        const BoundSubject subject{*function, shape, standard,
                                   instances_of(shape, standard.horizon).count()};
        findings.survives("exceptions", "an evaluation", [&] {
          FunctionCheck(subject, options, findings).run();
          also(subject);
        });
      } catch (const InputError& error) {
        const bool said = std::string(error.what()).size() > 10;
        findings.expect("creation", !parameter_case.must_work && said, [&] {
          return said ? std::string("refused: ") + error.what() : "refused without a reason";
        });
      } catch (const std::exception& error) {
        findings.fail("creation", std::string("throws: ") + error.what());
      }
    }
  }
  findings.set_case("");
}

}  // namespace lapwing
