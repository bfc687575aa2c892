// SPDX-License-Identifier: Apache-2.0
// The columns of a sample beyond those that every motion has, by name: force, bank rate, jerk.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace lapwing {

// A few names with one or more numbers each, in the order in which they were first set. SI,
// radians.
class SampleColumns {
 public:
  bool has(std::string_view name) const { return !find(name).empty(); }
  // The numbers of a column; empty where the sample lacks it. Valid until the next `set`.
  std::span<const double> find(std::string_view name) const;

  // A column that the sample lacks reads as zeros. The size must be that of the column: Error.
  double scalar(std::string_view name) const { return vector<1>(name)[0]; }
  template <int Size>
  Eigen::Matrix<double, Size, 1> vector(std::string_view name) const {
    Eigen::Matrix<double, Size, 1> result = Eigen::Matrix<double, Size, 1>::Zero();
    copy(name, {result.data(), Size});
    return result;
  }
  Eigen::Vector3d vector3(std::string_view name) const { return vector<3>(name); }
  // Of a column w, x, y, z; where the sample lacks it, no rotation.
  Eigen::Quaterniond quaternion(std::string_view name) const;

  // Adds the column or replaces its numbers. A column keeps its size: Error.
  void set(std::string_view name, std::span<const double> values);
  void set(std::string_view name, double value) { set(name, {&value, 1}); }
  template <int Size>
  void set(std::string_view name, const Eigen::Matrix<double, Size, 1>& values) {
    set(name, {values.data(), Size});
  }
  void set(std::string_view name, const Eigen::Quaterniond& q) {
    set(name, Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
  }

  bool operator==(const SampleColumns&) const = default;

 private:
  void copy(std::string_view name, std::span<double> into) const;

  struct Column {
    std::string name;
    std::size_t first = 0, size = 0;
    bool operator==(const Column&) const = default;
  };
  std::vector<Column> columns_;
  std::vector<double> values_;
};

}  // namespace lapwing
