// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/tape_operation.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

// A function of one number and its derivatives.
struct Curve {
  double value, slope, bend;
};

Curve rounded_curve(double x, double width) {
  const double size = std::abs(x);
  if (!(size < width)) return {size, x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0, 0.0};
  const double t = x / width;
  return {rounded_absolute(x, width), t * (1.5 - 0.5 * t * t), 1.5 * (1 - t * t) / width};
}

Curve root_curve(double x) {
  const double root = std::sqrt(x);
  if (!(x > 0)) return {root, 0.0, 0.0};
  return {root, 0.5 / root, -0.25 / (x * root)};
}

// Of a sum of squares.
Curve norm_curve(double x, double width) {
  if (!(x < width * width)) return root_curve(x);
  const double u = x / (width * width);
  return {width * (0.375 + u * (0.75 - 0.125 * u)), (0.75 - 0.25 * u) / width,
          -0.25 / (width * width * width)};
}

Curve power_curve(double x, double p) {
  const double value = std::pow(x, p);
  if (x == 0 && p < 2) return {value, p == 1 ? 1.0 : 0.0, 0.0};
  return {value, p * std::pow(x, p - 1), p * (p - 1) * std::pow(x, p - 2)};
}

LocalValue of_curve(const Curve& curve) {
  LocalValue result{.value = curve.value};
  result.slope[0] = curve.slope;
  result.bend[0] = curve.bend;
  return result;
}

LocalValue local_product(double a, double b) {
  LocalValue result{.value = a * b};
  result.slope[0] = b;
  result.slope[1] = a;
  result.bend[1] = 1;
  return result;
}

LocalValue local_quotient(double a, double b) {
  LocalValue result{.value = a / b};
  result.slope[0] = 1 / b;
  result.slope[1] = -result.value / b;
  result.bend[1] = -1 / (b * b);
  result.bend[2] = 2 * result.value / (b * b);
  return result;
}

LocalValue local_angle(double y, double x) {
  LocalValue result{.value = std::atan2(y, x)};
  const double squared = x * x + y * y;
  if (squared == 0) return result;
  result.slope[0] = x / squared;
  result.slope[1] = -y / squared;
  result.bend[0] = -2 * result.slope[0] * (y / squared);
  result.bend[1] = (y * y - x * x) / (squared * squared);
  result.bend[2] = -result.bend[0];
  return result;
}

LocalValue local_maximum(double a, double b, double width) {
  LocalValue result;
  const double apart = a - b;
  if (apart >= width || -apart >= width) {
    result.value = apart >= width ? a : b;
    result.slope[apart >= width ? 0 : 1] = 1;
    return result;
  }
  const Curve curve = rounded_curve(apart, width);
  result.value = 0.5 * (a + b + curve.value);
  result.slope[0] = 0.5 * (1 + curve.slope);
  result.slope[1] = 0.5 * (1 - curve.slope);
  result.bend[0] = result.bend[2] = 0.5 * curve.bend;
  result.bend[1] = -result.bend[0];
  return result;
}

// As subject_position of filmed_point.h: straight between the times of the track.
LocalValue local_track(const Subject& subject, int component, double time) {
  const auto& times = subject.times;
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  const auto k = static_cast<std::size_t>(next - times.begin());
  const double from = subject.positions[k == 0 ? 0 : k - 1](component);
  LocalValue result{.value = from};
  if (k == 0 || k == times.size()) return result;
  const double speed = (subject.positions[k](component) - from) / (times[k] - times[k - 1]);
  result.value = from + (time - times[k - 1]) * speed;
  result.slope[0] = speed;
  return result;
}

LocalValue local_distance(const DistanceField& field, const double* x, int order) {
  const Eigen::Vector3d p(x[0], x[1], x[2]);
  Eigen::Vector3d gradient;
  LocalValue result{.value = field.distance(p, order > 0 ? &gradient : nullptr)};
  if (order > 0) std::copy_n(gradient.data(), 3, result.slope);
  if (order > 1) {
    const Eigen::Matrix3d bend = field.curvature(p);
    const double packed[] = {bend(0, 0), bend(0, 1), bend(1, 1),
                             bend(0, 2), bend(1, 2), bend(2, 2)};
    std::copy_n(packed, 6, result.bend);
  }
  return result;
}

}  // namespace

int operand_count(TapeOp op) {
  switch (op) {
    case TapeOp::constant:
    case TapeOp::input:
    case TapeOp::parameter:
      return 0;
    case TapeOp::add:
    case TapeOp::subtract:
    case TapeOp::multiply:
    case TapeOp::divide:
    case TapeOp::atan2:
    case TapeOp::maximum:
      return 2;
    case TapeOp::select:
    case TapeOp::distance:
      return 3;
    default:
      return 1;
  }
}

LocalValue local_value(const TapeCall& call, const double* x, const TapeSources& sources,
                       int order) {
  LocalValue result;
  switch (call.op) {
    case TapeOp::constant:
      result.value = call.number;
      return result;
    case TapeOp::input:
    case TapeOp::parameter:
      return result;
    case TapeOp::add:
      result.value = x[0] + x[1];
      result.slope[0] = result.slope[1] = 1;
      return result;
    case TapeOp::subtract:
      result.value = x[0] - x[1];
      result.slope[0] = 1;
      result.slope[1] = -1;
      return result;
    case TapeOp::multiply:
      return local_product(x[0], x[1]);
    case TapeOp::divide:
      return local_quotient(x[0], x[1]);
    case TapeOp::negate:
      return of_curve({-x[0], -1, 0});
    case TapeOp::sin: {
      const double value = std::sin(x[0]);
      return of_curve({value, order > 0 ? std::cos(x[0]) : 0.0, -value});
    }
    case TapeOp::cos: {
      const double value = std::cos(x[0]);
      return of_curve({value, order > 0 ? -std::sin(x[0]) : 0.0, -value});
    }
    case TapeOp::tan: {
      const double value = std::tan(x[0]), slope = 1 + value * value;
      return of_curve({value, slope, 2 * value * slope});
    }
    case TapeOp::exp: {
      const double value = std::exp(x[0]);
      return of_curve({value, value, value});
    }
    case TapeOp::log:
      return of_curve({std::log(x[0]), 1 / x[0], -1 / (x[0] * x[0])});
    case TapeOp::sqrt:
      return of_curve(root_curve(x[0]));
    case TapeOp::power:
      return of_curve(power_curve(x[0], call.number));
    case TapeOp::atan2:
      return local_angle(x[0], x[1]);
    case TapeOp::absolute:
      return of_curve(rounded_curve(x[0], call.number));
    case TapeOp::norm:
      return of_curve(norm_curve(x[0], call.number));
    case TapeOp::maximum:
      return local_maximum(x[0], x[1], call.number);
    case TapeOp::select:
      result.value = x[0] > 0 ? x[1] : x[2];
      result.slope[x[0] > 0 ? 1 : 2] = 1;
      return result;
    case TapeOp::track:
      return local_track(sources.subjects[call.data / 3], call.data % 3, x[0]);
    case TapeOp::distance:
      return local_distance(*sources.fields[call.data], x, order);
  }
  return result;
}

}  // namespace lapwing
