// SPDX-License-Identifier: Apache-2.0
#include "plugins/controllers/predictive/horizon.h"

#include <algorithm>
#include <cmath>

#include "framework/vehicle/planned_attitude.h"

namespace lapwing {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Eigen::VectorXd;

namespace {

constexpr double kSubstep = 0.02;    // s, of the motion and its linearisation
constexpr double kTolerance = 1e-5;  // of the quadratic programme
constexpr int kIterations = 25;      // of the interior point, at most
constexpr double kNearPi = 3.0;      // rad: beyond, the derivative of the rotation vector is held
constexpr int kErrors = 12;          // position, velocity, attitude, rates

constexpr double kTurned = 1.2;  // rad, of a guess from the plan, at most
constexpr double kSpun = 30.0;   // rad/s, likewise

Matrix3d cross(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// d log(exp(e) exp(x)) / dx at x = 0.
Matrix3d inverse_right_jacobian(Vector3d e) {
  double angle = e.norm();
  if (angle > kNearPi) e *= kNearPi / angle, angle = kNearPi;
  const double factor =
      angle < 1e-4 ? 1.0 / 12
                   : 1 / (angle * angle) - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
  const Matrix3d x = cross(e);
  return Matrix3d::Identity() + x / 2 + factor * x * x;
}

bool is_near(const BodyState& guess, const BodyState& plan) {
  return guess.orientation.angularDistance(plan.orientation) < kTurned &&
         (guess.body_rates - plan.body_rates).norm() < kSpun;
}

BodyState interpolated(const BodyState& from, const BodyState& to, double share) {
  const auto between = [&](const auto& a, const auto& b) { return (a + share * (b - a)).eval(); };
  return {between(from.position, to.position), between(from.velocity, to.velocity),
          from.orientation.slerp(share, to.orientation), between(from.body_rates, to.body_rates),
          between(from.rotor_thrusts, to.rotor_thrusts)};
}

// What a state differs from another, and its inverse: rows as the linearised motion counts them.
template <int n>
Eigen::Matrix<double, n, 1> difference(const BodyState& a, const BodyState& b) {
  Eigen::Matrix<double, n, 1> d;
  d.template segment<3>(0) = a.position - b.position;
  d.template segment<3>(3) = a.velocity - b.velocity;
  d.template segment<3>(6) = rotation_vector(b.orientation.conjugate() * a.orientation);
  d.template segment<3>(9) = a.body_rates - b.body_rates;
  if constexpr (n > kErrors) d.template segment<4>(12) = a.rotor_thrusts - b.rotor_thrusts;
  return d;
}

template <int n>
BodyState moved_by(const BodyState& state, const Eigen::Matrix<double, n, 1>& d) {
  BodyState next = state;
  next.position += d.template segment<3>(0);
  next.velocity += d.template segment<3>(3);
  const Vector3d turn = d.template segment<3>(6);
  if (const double angle = turn.norm(); angle > 0)
    next.orientation =
        (state.orientation * Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)))
            .normalized();
  next.body_rates += d.template segment<3>(9);
  if constexpr (n > kErrors) next.rotor_thrusts += d.template segment<4>(12);
  return next;
}

}  // namespace

Horizon::Horizon(const Vehicle& vehicle, const BodyReference& reference,
                 const HorizonSettings& settings)
    : vehicle_(vehicle), reference_(reference), s_(settings) {
  const int count = s_.stages;
  const double period = std::min(s_.period, s_.length / count);
  const double growth = count > 1 ? 2 * (s_.length - count * period) / (count * (count - 1.0)) : 0;
  double end = 0;
  for (int k = 0; k < count; ++k) {
    lengths_.push_back(period + growth * k);
    guess_.ends.push_back(end += lengths_.back());
  }
  const int per = s_.paced ? 5 : 4, all = per * count;
  hessian_.resize(all, all);
  MatrixXd lower = MatrixXd::Ones(all, all);
  lower.triangularView<Eigen::StrictlyUpper>().setZero();
  program_.hessian = lower.sparseView();
  program_.jacobian.resize(0, all);
  program_.gradient.resize(all);
  program_.row_lower.resize(0);
  program_.row_upper.resize(0);
  program_.x_lower.resize(all);
  program_.x_upper.resize(all);
  sensitivities_.resize(count);
}

BodyPoint Horizon::wanted(double time) const {
  BodyPoint point = reference_.at(time);
  const double beyond = time - reference_.finish();
  if (beyond > 0) {
    point.position += beyond * point.velocity;
    point.acceleration.setZero();
    point.body_rates.setZero();
    point.body_accelerations.setZero();
  }
  return point;
}

Vector4d Horizon::fed_forward(double time) const {
  const Rotors& rotors = vehicle_.rotors;
  Vector4d thrusts = reference_.at(time).rotor_thrusts;
  if (rotors.lag > 0) {
    constexpr double kAround = 0.005;
    thrusts += rotors.lag *
               (reference_.at(time + kAround).rotor_thrusts -
                reference_.at(time - kAround).rotor_thrusts) /
               (2 * kAround);
  }
  return thrusts.cwiseMax(rotors.thrust_min).cwiseMin(rotors.thrust_max);
}

BodyState Horizon::planned(double time) const {
  const BodyPoint p = wanted(time);
  return {p.position, p.velocity, p.orientation, p.body_rates, p.rotor_thrusts};
}

// The last solution at the times of this call; what it does not reach to, from the plan.
void Horizon::shift(double time, double elapsed, const BodyState& state) {
  const Prediction last = guess_;
  const std::size_t count = lengths_.size();
  const bool any = last.states.size() == last.ends.size();
  guess_.thrusts.resize(count);
  guess_.paces.assign(count, 1.0);
  guess_.states.resize(count);
  double plan = time;
  for (std::size_t j = 0; j < count; ++j) {
    const double end = guess_.ends[j] + elapsed, middle = end - lengths_[j] / 2;
    const auto stage = [&](double at) {
      return static_cast<std::size_t>(
          std::lower_bound(last.ends.begin(), last.ends.end(), at - 1e-9) - last.ends.begin());
    };
    const std::size_t k = stage(middle), e = stage(end);
    const bool known = any && k < count;
    if (known && s_.paced) guess_.paces[j] = last.paces[k];
    const double pace = guess_.paces[j];
    guess_.thrusts[j] = known ? last.thrusts[k] : fed_forward(plan + pace * lengths_[j] / 2);
    plan += pace * lengths_[j];
    guess_.states[j] = planned(plan);
    if (!any || e >= count) continue;
    // Between the last state that is passed and the next one.
    const double begin = e > 0 ? last.ends[e - 1] : 0;
    const BodyState& from = e > 0 ? last.states[e - 1] : state;
    const double share = (end - begin) / (last.ends[e] - begin);
    const BodyState between = e > 0 ? interpolated(from, last.states[e], share) : last.states[e];
    if (is_near(between, guess_.states[j])) guess_.states[j] = between;
  }
}

const Prediction& Horizon::solve(double time, double elapsed, const BodyState& state,
                                 const ModelError& error) {
  shift(time, elapsed, state);
  return vehicle_.rotors.lag > 0 ? solve<16>(time, state, error) : solve<12>(time, state, error);
}

template <int n>
const Prediction& Horizon::solve(double time, const BodyState& state, const ModelError& error) {
  using Square = Eigen::Matrix<double, n, n>;
  using Column = Eigen::Matrix<double, n, 4>;
  const Rotors& rotors = vehicle_.rotors;
  const double gain = 1 + error.thrust, mass = vehicle_.mass / gain;
  const RotorBody body(vehicle_, 1 / gain, gain);
  const Eigen::Matrix4d mixer = body.mixer();
  const Vector3d& inertia = vehicle_.inertia;
  const Vector3d inverse = inertia.cwiseInverse();
  const auto linearise = [&](const BodyState& from, const BodyState& to, double h, Square& a,
                             Column& b) {
    const Matrix3d r = from.orientation.slerp(0.5, to.orientation).toRotationMatrix();
    const Vector3d w = (from.body_rates + to.body_rates) / 2;
    const double thrust = (from.rotor_thrusts + to.rotor_thrusts).sum() / 2;
    Square rate = Square::Zero();
    rate.template block<3, 3>(0, 3).setIdentity();
    rate.template block<3, 3>(3, 3).diagonal().setConstant(-vehicle_.drag / mass);
    rate.template block<3, 3>(3, 6) = -thrust / mass * r * cross(Vector3d::UnitZ());
    rate.template block<3, 3>(6, 6) = -cross(w);
    rate.template block<3, 3>(6, 9).setIdentity();
    const Vector3d spin = inertia.cwiseProduct(w);
    rate.template block<3, 3>(9, 9) =
        inverse.asDiagonal() * (cross(spin) - cross(w) * Matrix3d(inertia.asDiagonal()));
    Eigen::Matrix<double, 12, 4> by_thrusts = Eigen::Matrix<double, 12, 4>::Zero();
    by_thrusts.block<3, 4>(3, 0) = r.col(2) / mass * mixer.row(0);
    by_thrusts.block<3, 4>(9, 0) = inverse.asDiagonal() * mixer.bottomRows<3>();
    Column input = Column::Zero();
    if constexpr (n > kErrors) {
      rate.template block<12, 4>(0, 12) = by_thrusts;
      rate.template block<4, 4>(12, 12).diagonal().setConstant(-1 / rotors.lag);
      input.template block<4, 4>(12, 0).diagonal().setConstant(1 / rotors.lag);
    } else {
      input = by_thrusts;
    }
    // exp(rate h) and its integral times the input, by series.
    const Square ah = h * rate;
    const Square second = ah * ah, third = second * ah, fourth = second * second;
    a = Square::Identity() + ah + second / 2 + third / 6 + fourth / 24;
    const Square integral = Square::Identity() + ah / 2 + second / 6 + third / 24 + fourth / 120;
    b = h * integral * input;
  };

  const int per = s_.paced ? 5 : 4, count = s_.stages, all = per * count;
  const auto weight = [&](double worth) { return 1 / worth; };
  Eigen::Matrix<double, kErrors, 1> worth;
  worth << Vector3d::Constant(weight(s_.position)), Vector3d::Constant(weight(s_.velocity)),
      Vector3d::Constant(weight(s_.attitude)), Vector3d::Constant(weight(s_.rates));
  hessian_.setZero();
  program_.gradient.setZero();
  MatrixXd moved = MatrixXd::Zero(n, all);  // of the state by the inputs so far
  MatrixXd off(kErrors, all);
  VectorXd plan_moved = VectorXd::Zero(all);              // of the plan's time
  std::vector<Eigen::Matrix<double, n, 1>> drift(count);  // of the states, without other inputs
  Eigen::Matrix<double, n, 1> left = Eigen::Matrix<double, n, 1>::Zero();
  std::vector<MatrixXd> all_moved(count);
  double plan = time;
  for (int k = 0; k < count; ++k) {
    const double length = lengths_[k], pace = guess_.paces[k];
    const int substeps = std::max(1, static_cast<int>(std::ceil(length / kSubstep - 1e-9)));
    const double h = length / substeps;
    const Vector4d u = guess_.thrusts[k];
    BodyState at = k > 0 ? guess_.states[k - 1] : state;
    Square a = Square::Identity();
    Column b = Column::Zero();
    for (int i = 0; i < substeps; ++i) {
      BodyState next = body.after(at, u, Vector3d::Zero(), h);
      next.velocity += h * error.acceleration;
      next.position += h * h / 2 * error.acceleration;
      Square a_sub;
      Column b_sub;
      linearise(at, next, h, a_sub, b_sub);
      a = (a_sub * a).eval();
      b = (a_sub * b + b_sub).eval();
      at = next;
    }
    const int done = per * k;
    moved.leftCols(done) = (a * moved.leftCols(done)).eval();
    moved.middleCols(done, 4) = b;
    const Vector4d needed = fed_forward(plan + pace * length / 2);
    plan += pace * length;
    if (s_.paced) plan_moved(done + 4) = length;
    left = (a * left + difference<n>(at, guess_.states[k])).eval();
    at = guess_.states[k];
    drift[k] = left;
    all_moved[k] = moved.leftCols(per * (k + 1));
    if (kept_) sensitivities_[k] = moved;

    const int now = done + per;
    const BodyPoint point = wanted(plan);
    Eigen::Matrix<double, kErrors, 1> e;
    const Vector3d turn = rotation_vector(point.orientation.conjugate() * at.orientation);
    const Matrix3d jacobian = inverse_right_jacobian(turn);
    e << at.position - point.position, at.velocity - point.velocity, turn,
        at.body_rates - point.body_rates;
    e += left.template head<kErrors>();
    e.template segment<3>(6) += (jacobian - Matrix3d::Identity()) * left.template segment<3>(6);
    off.leftCols(now) = moved.topRows<kErrors>().leftCols(now);
    off.middleRows<3>(6).leftCols(now) = (jacobian * moved.middleRows<3>(6).leftCols(now)).eval();
    if (s_.paced) {
      Eigen::Matrix<double, kErrors, 1> by_time;
      by_time << point.velocity, point.acceleration, jacobian.transpose() * point.body_rates,
          point.body_accelerations;
      off.leftCols(now) -= by_time * plan_moved.head(now).transpose();
    }
    const double share = std::sqrt(length + (k + 1 == count ? s_.terminal : 0.0));
    e = share * worth.cwiseProduct(e).eval();
    off.leftCols(now) = (share * worth).asDiagonal() * off.leftCols(now);
    const auto block = off.leftCols(now);
    hessian_.topLeftCorner(now, now).selfadjointView<Eigen::Lower>().rankUpdate(block.transpose());
    program_.gradient.head(now) += block.transpose() * e;
    const double cost = length / std::pow(s_.thrust * rotors.thrust_max, 2);
    for (int i = 0; i < 4; ++i) {
      hessian_(done + i, done + i) += cost;
      program_.gradient(done + i) += cost * (u(i) - needed(i));
      program_.x_lower(done + i) = rotors.thrust_min - u(i);
      program_.x_upper(done + i) = rotors.thrust_max - u(i);
    }
    if (s_.paced) {
      const double price = length / (s_.pace * s_.pace);
      hessian_(done + 4, done + 4) += price;
      program_.gradient(done + 4) += price * (pace - 1);
      program_.x_lower(done + 4) = s_.slowest - pace;
      program_.x_upper(done + 4) = s_.quickest - pace;
    }
  }
  double* value = program_.hessian.valuePtr();
  for (int j = 0; j < all; ++j)
    for (int i = j; i < all; ++i) *value++ = hessian_(i, j);
  solved_ = false;
  iterations_ = 0;
  if (!hessian_.allFinite() || !program_.gradient.allFinite()) return guess_;
  const QuadraticResult result =
      solver_.solve(program_, {.iteration_limit = kIterations, .tolerance = kTolerance});
  iterations_ = result.iterations;
  solved_ = result.status == QuadraticStatus::optimal;
  if (!result.x.allFinite()) return guess_;
  for (int k = 0; k < count; ++k) {
    const Eigen::Matrix<double, n, 1> step =
        drift[k] + all_moved[k] * result.x.head(all_moved[k].cols());
    guess_.states[k] = moved_by<n>(guess_.states[k], step);
    guess_.thrusts[k] += result.x.segment<4>(per * k);
    guess_.thrusts[k] = guess_.thrusts[k].cwiseMax(rotors.thrust_min).cwiseMin(rotors.thrust_max);
    if (s_.paced)
      guess_.paces[k] =
          std::clamp(guess_.paces[k] + result.x(per * k + 4), s_.slowest, s_.quickest);
  }
  return guess_;
}

}  // namespace lapwing
