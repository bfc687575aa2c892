// SPDX-License-Identifier: Apache-2.0
#include "framework/study/stratified_sample.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace lapwing {
namespace {

// The 97.5 % quantile of Student's t.
double student(std::size_t freedom) {
  const boost::math::students_t distribution(static_cast<double>(freedom));
  return boost::math::quantile(distribution, 0.975);
}

// About the first value: exact where all are equal.
double middle_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value - values.front();
  return values.front() + sum / static_cast<double>(values.size());
}

double squares_about(const std::vector<double>& values, double middle) {
  double sum = 0;
  for (const double value : values) sum += (value - middle) * (value - middle);
  return sum;
}

}  // namespace

void StratifiedSample::add(double value) {
  if (groups_.empty()) groups_.emplace_back();
  groups_.front().push_back(value);
}

void StratifiedSample::join(const StratifiedSample& other) {
  groups_.insert(groups_.end(), other.groups_.begin(), other.groups_.end());
}

std::size_t StratifiedSample::count() const {
  std::size_t sum = 0;
  for (const auto& group : groups_) sum += group.size();
  return sum;
}

double StratifiedSample::mean() const {
  double mean = groups_.empty() ? std::nan("") : 0;
  for (const auto& group : groups_)
    mean += middle_of(group) * static_cast<double>(group.size()) / static_cast<double>(count());
  return mean;
}

double StratifiedSample::deviation() const {
  if (count() < 2) return std::nan("");
  double squares = 0;
  for (const auto& group : groups_) squares += squares_about(group, mean());
  return std::sqrt(squares / static_cast<double>(count() - 1));
}

double StratifiedSample::interval() const {
  double variance = 0;
  std::size_t freedom = 0;
  for (const auto& group : groups_) {
    if (group.size() < 2) return std::nan("");
    const double size = static_cast<double>(group.size());
    const double share = size / static_cast<double>(count());
    variance += share * share * squares_about(group, middle_of(group)) / (size - 1) / size;
    freedom += group.size() - 1;
  }
  return freedom > 0 ? student(freedom) * std::sqrt(variance) : std::nan("");
}

}  // namespace lapwing
