// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/invariance.h"

#include <cmath>

#include "framework/conformance/differences.h"
#include "framework/conformance/function_checks.h"

namespace lapwing {
namespace {

constexpr int kMoves = 6;        // of every instance, for each that is declared
constexpr double kMoved = 1e-9;  // of the numbers that go into a result

// One way to move all inputs of an instance together.
struct Move {
  Eigen::Vector3d aside = Eigen::Vector3d::Zero();  // m
  double turn = 0;                                  // rad, about z
  double later = 0;                                 // s
};

class InvarianceCheck {
 public:
  InvarianceCheck(const BoundSubject& subject, std::uint64_t seed, Findings& findings)
      : subject_(subject),
        findings_(findings),
        random_(seed),
        places_(input_places(subject.shape, subject.standard.layout)),
        n_(static_cast<int>(places_.size())),
        m_(subject.shape.rows) {}

  void try_moves(const std::string& id) {
    for (int turn = 0; turn < kMoves; ++turn)
      for (int k = 0; k < subject_.count(); ++k) {
        const std::vector<double> x = make_inputs(subject_.standard, subject_.shape,
                                                  {subject_.times[k]}, InputKind::random, random_);
        Move move;
        int other = k;
        if (id == kInvariantToTranslation)
          for (double& d : move.aside) d = random_.uniform(-50, 50);
        if (id == kInvariantToRotationAboutZ) move.turn = random_.uniform(-3, 3);
        if (id == kInvariantToTime) {
          other = static_cast<int>(random_.integer(0, subject_.count() - 1));
          move.later = subject_.times[other] - subject_.times[k] + random_.uniform(0, 20);
        }
        compare(id, k, x, other, moved(x, move));
      }
  }

 private:
  struct Size {
    double value = 0;  // length of the residuals, or distance from what is allowed
    double scale = 0;  // of all that goes into it
  };

  Size size_of(int k, const std::vector<double>& x) {
    std::vector<double> values(m_), jacobian(m_ * n_), lower(m_), upper(m_);
    subject_.function.evaluate({k, 1}, x.data(), values.data(), jacobian.data(), workspace_);
    Size size;
    for (int r = 0; r < m_; ++r) {
      double scale = std::abs(values[r]);
      for (int c = 0; c < n_; ++c) scale += std::abs(jacobian[r * n_ + c] * x[c]);
      size.scale = std::max(size.scale, scale);
    }
    if (!subject_.constraint) {
      size.value = Eigen::Map<const Eigen::VectorXd>(values.data(), m_).norm();
      return size;
    }
    static_cast<const Constraint&>(subject_.function).bounds({k, 1}, lower.data(), upper.data());
    size.value = -HUGE_VAL;
    for (int r = 0; r < m_; ++r)
      size.value = std::max({size.value, lower[r] - values[r], values[r] - upper[r]});
    return size;
  }

  std::vector<double> moved(std::vector<double> x, const Move& move) const {
    const double c = std::cos(move.turn), s = std::sin(move.turn);
    const auto rotate = [&](double* v) {
      const double a = c * v[0] - s * v[1], b = s * v[0] + c * v[1];
      v[0] = a;
      v[1] = b;
    };
    for (int i = 0; i < n_; ++i) {
      if (places_[i].component != 0) continue;
      const std::string& name = subject_.standard.layout.block(places_[i].block).name;
      const bool place = name == "position" || name == "target";
      if (place || name == "velocity" || name == "force") rotate(&x[i]);
      for (int a = 0; a < 3 && place; ++a) x[i + a] += move.aside[a];
      if (name == "yaw") x[i] += move.turn;
      if (name == "time") x[i] += move.later;
      if (name == "orientation") {
        const Eigen::Quaterniond turned =
            Eigen::Quaterniond(Eigen::AngleAxisd(move.turn, Eigen::Vector3d::UnitZ())) *
            Eigen::Quaterniond(x[i], x[i + 1], x[i + 2], x[i + 3]);
        x[i] = turned.w();
        for (int a = 0; a < 3; ++a) x[i + 1 + a] = turned.vec()[a];
      }
    }
    return x;
  }

  void compare(const std::string& id, int k, const std::vector<double>& x, int other,
               const std::vector<double>& y) {
    const Size before = size_of(k, x), after = size_of(other, y);
    const double allowed = kMoved * std::max(before.scale, after.scale);
    findings_.expect("invariance", std::abs(before.value - after.value) <= allowed, [&] {
      return "declares " + id + ", but " +
             (subject_.constraint ? "its distance from what is allowed"
                                  : "the length of its residuals") +
             " changes from " + text_of(before.value) + " to " + text_of(after.value) +
             ", instance " + std::to_string(k) + " at " + text_of(subject_.times[k]) + " s";
    });
  }

  const BoundSubject& subject_;
  Findings& findings_;
  Random random_;
  std::vector<InputPlace> places_;
  int n_, m_;
  Workspace workspace_;
};

}  // namespace

void check_invariance(const BoundSubject& subject, const std::vector<std::string>& declares,
                      std::uint64_t seed, Findings& findings) {
  InvarianceCheck check(subject, seed, findings);
  for (const char* id : {kInvariantToTranslation, kInvariantToRotationAboutZ, kInvariantToTime})
    if (std::find(declares.begin(), declares.end(), id) != declares.end()) check.try_moves(id);
}

}  // namespace lapwing
