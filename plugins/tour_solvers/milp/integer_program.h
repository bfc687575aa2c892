// SPDX-License-Identifier: Apache-2.0
// A mixed-integer linear program, and its search by CBC.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace lapwing {

// Maximises objective . x over rows lower <= a . x <= upper and column bounds.
struct IntegerProgram {
  struct Entry {
    int column;
    double factor;
  };
  int columns() const { return static_cast<int>(objective.size()); }
  int rows() const { return static_cast<int>(row_lower.size()); }
  // Returns its number; at least 0.
  int add_column(double gain, double upper, bool whole);
  void add_row(double lower, const std::vector<Entry>& entries, double upper);
  // The largest violation of rows and bounds.
  double violation(const std::vector<double>& x) const;

  std::vector<double> objective, column_upper;
  std::vector<char> integer;
  std::vector<double> row_lower, row_upper;
  std::vector<std::size_t> row_start{0};
  std::vector<Entry> entries;
};
inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

struct IntegerSearch {
  int nodes = 1000;  // of branch and bound
  int seed = 1;
  std::vector<double> start;                // a feasible point, or empty
  std::function<bool(std::int64_t)> ended;  // asked with the nodes so far, often
  std::optional<double> seconds_left = {};  // wall clock, for what cannot be asked
};

struct IntegerResult {
  std::vector<double> x;  // the best point; empty where none was found
  bool optimal = false, infeasible = false;
  double bound = kUnbounded;  // no point has more
  int nodes = 0;
};

// One thread. The same program and search, not ended from outside, give the same result.
IntegerResult solve_program(const IntegerProgram& program, const IntegerSearch& search);

}  // namespace lapwing
