// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/sample_columns.h"

#include <algorithm>

#include "framework/core/error.h"

namespace lapwing {
namespace {

void expect_size(std::string_view name, std::size_t size, std::size_t asked) {
  if (size == asked) return;
  throw Error("the column '" + std::string(name) + "' of a sample has " + std::to_string(size) +
              " numbers, not " + std::to_string(asked));
}

}  // namespace

std::span<const double> SampleColumns::find(std::string_view name) const {
  for (const Column& column : columns_)
    if (column.name == name) return {values_.data() + column.first, column.size};
  return {};
}

void SampleColumns::copy(std::string_view name, std::span<double> into) const {
  const std::span<const double> from = find(name);
  if (from.empty()) return;
  expect_size(name, from.size(), into.size());
  std::copy(from.begin(), from.end(), into.begin());
}

Eigen::Quaterniond SampleColumns::quaternion(std::string_view name) const {
  if (!has(name)) return Eigen::Quaterniond::Identity();
  const Eigen::Vector4d q = vector<4>(name);
  return {q[0], q[1], q[2], q[3]};
}

void SampleColumns::set(std::string_view name, std::span<const double> values) {
  for (const Column& column : columns_) {
    if (column.name != name) continue;
    expect_size(name, column.size, values.size());
    std::copy(values.begin(), values.end(),
              values_.begin() + static_cast<std::ptrdiff_t>(column.first));
    return;
  }
  columns_.push_back({std::string(name), values_.size(), values.size()});
  values_.insert(values_.end(), values.begin(), values.end());
}

}  // namespace lapwing
