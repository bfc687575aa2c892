#include "framework/app/stratified_sample.h"

#include <cmath>
#include <iterator>

namespace lapwing {
namespace {

// Student's t of 97.5 %: of 1 degree of freedom, of 2, ...
constexpr double kStudent[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306,
                               2.262,  2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120,
                               2.110,  2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064,
                               2.060,  2.056, 2.052, 2.048, 2.045, 2.042};

// Beyond the table by the first terms of its expansion about the normal distribution's quantile
// (Abramowitz and Stegun 26.7.5), right to 1e-4 there.
double student(std::size_t freedom) {
  if (freedom <= std::size(kStudent)) return kStudent[freedom - 1];
  constexpr double z = 1.959964;
  const double n = static_cast<double>(freedom);
  return z + (z * z * z + z) / (4 * n) +
         (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / (96 * n * n);
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
