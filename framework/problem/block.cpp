// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/block.h"

#include <cmath>

#include <Eigen/Geometry>

#include "framework/core/error.h"
#include "framework/core/parameters.h"

namespace lapwing {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Quaterniond read_quaternion(const double* q) {
  return Quaterniond(q[0], q[1], q[2], q[3]);
}

Vector3d rotation_vector(const Quaterniond& q) {
  const double sign = q.w() < 0 ? -1.0 : 1.0;  // q and -q are one rotation
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2.0 * sign * q.vec();
  return q.vec() * (2.0 * std::atan2(sine, sign * q.w()) * sign / sine);
}

Quaterniond exponential(const Vector3d& rotation) {
  const double half = 0.5 * rotation.norm();
  const double scale = half < 1e-8 ? 0.5 - half * half / 12.0 : 0.5 * std::sin(half) / half;
  const Vector3d vector = scale * rotation;
  return Quaterniond(std::cos(half), vector.x(), vector.y(), vector.z());
}

Matrix3d skew(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Inverse right Jacobian of SO(3): Log(exp(e) exp(d)) = e + inverse_right_jacobian(e) d + ...
Matrix3d inverse_right_jacobian(const Vector3d& e) {
  const double angle = e.norm();
  const Matrix3d s = skew(e);
  const double squared = angle * angle;
  const double second = angle < 1e-2 ? 1.0 / 12.0 + squared / 720.0 + squared * squared / 30240.0
                                     : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / squared;
  return Matrix3d::Identity() + 0.5 * s + second * s * s;
}

}  // namespace

void block_difference(const BlockSpec& block, const double* from, const double* to, double* delta) {
  if (block.topology == Topology::line) {
    for (int i = 0; i < block.size; ++i) delta[i] = to[i] - from[i];
    return;
  }
  Eigen::Map<Vector3d>(delta, 3) =
      rotation_vector(read_quaternion(from).conjugate() * read_quaternion(to));
}

void block_retract(const BlockSpec& block, const double* at, const double* delta, double* result) {
  if (block.topology == Topology::line) {
    for (int i = 0; i < block.size; ++i) result[i] = at[i] + delta[i];
    return;
  }
  const Quaterniond q =
      (read_quaternion(at) * exponential(Eigen::Map<const Vector3d>(delta))).normalized();
  result[0] = q.w();
  result[1] = q.x();
  result[2] = q.y();
  result[3] = q.z();
}

Eigen::MatrixXd retraction_jacobian(const BlockSpec& block, const double* at) {
  if (block.topology == Topology::line)
    return Eigen::MatrixXd::Identity(block.size, block.tangent_size());
  Eigen::MatrixXd jacobian(4, 3);
  jacobian << -at[1], -at[2], -at[3],  //
      at[0], -at[3], at[2],            //
      at[3], at[0], -at[1],            //
      -at[2], at[1], at[0];
  return 0.5 * jacobian;
}

DifferenceJacobians difference_jacobians(const BlockSpec& block, const double* from,
                                         const double* to) {
  const int n = block.tangent_size();
  if (block.topology == Topology::line)
    return {-Eigen::MatrixXd::Identity(n, n), Eigen::MatrixXd::Identity(n, n)};
  Vector3d e;
  block_difference(block, from, to, e.data());
  return {-inverse_right_jacobian(-e), inverse_right_jacobian(e)};
}

std::string component_name(const BlockSpec& block, int component) {
  if (block.size == 1) return block.name;
  static const char* const kAxes[] = {"x", "y", "z"};
  if (block.tangent_size() == 3) return block.name + "." + kAxes[component];
  return block.name + "." + std::to_string(component);
}

int StageLayout::add(BlockSpec block) {
  if (block.name.empty() || block.size < 1)
    throw Error("block '" + block.name + "' needs a name and a size of at least 1");
  if (block.topology == Topology::quaternion && block.size != 4)
    throw Error("block '" + block.name + "' is a quaternion and needs size 4");
  if (find(block.name) >= 0) throw Error("two blocks are named '" + block.name + "'");
  offsets_.push_back(size_);
  tangent_offsets_.push_back(tangent_size_);
  size_ += block.size;
  tangent_size_ += block.tangent_size();
  blocks_.push_back(std::move(block));
  return count() - 1;
}

int StageLayout::find(std::string_view name) const {
  for (int i = 0; i < count(); ++i)
    if (blocks_[i].name == name) return i;
  return -1;
}

int StageLayout::index(std::string_view name) const {
  const int found = find(name);
  if (found >= 0) return found;
  std::vector<std::string> names;
  std::string known;
  for (const BlockSpec& block : blocks_) {
    known += (names.empty() ? "" : ", ") + block.name;
    names.push_back(block.name);
  }
  const std::string near = nearest_name(name, names);
  throw InputError("no block '" + std::string(name) + "' in this problem" +
                   (near.empty() ? "" : ", did you mean '" + near + "'") + "; it has " + known);
}

std::vector<int> StageLayout::indices(std::initializer_list<std::string_view> names) const {
  std::vector<int> result;
  for (const std::string_view name : names) result.push_back(index(name));
  return result;
}

}  // namespace lapwing
