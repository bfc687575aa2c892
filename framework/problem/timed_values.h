// SPDX-License-Identifier: Apache-2.0
// Values that a block is to have at given times: what the terms of keyframes share.
#pragma once

#include <string>
#include <vector>

#include "framework/core/parameters.h"
#include "framework/problem/blocks_read.h"
#include "framework/problem/stage_function.h"

namespace lapwing {

class TimedValues {
 public:
  // One entry of `keyframes`: time and value. A term may add parameters of its own.
  static ParameterTable entry();
  // The block that is `treated` ("penalised"), and the list of `entries`.
  static ParameterTable table(const std::string& treated, ParameterTable entries);
  // InputError where there are no entries.
  explicit TimedValues(const Parameters& parameters);

  // Adds block and times to the shape. InputError where the block is an orientation, which entries
  // cannot be ("pulled"), or has another size than a value.
  AnyHandle bind(const ProblemSetting& setting, FunctionShape& shape,
                 const std::string& treatment) const;

  const std::string& block() const { return block_; }
  // Of the entry of that number, in the block's unit.
  const std::vector<double>& value(int number) const {
    return values_[static_cast<std::size_t>(number)];
  }

 private:
  std::string block_;
  std::vector<double> times_;
  std::vector<std::vector<double>> values_;
};

}  // namespace lapwing
