// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/timed_values.h"

#include "framework/core/error.h"

namespace lapwing {

ParameterTable TimedValues::entry() {
  return ParameterTable{}
      .required_number("time", "s", "time from the start, also between stages", at_least(0))
      .required_numbers("value", 0, "", "value, in the block's unit");
}

ParameterTable TimedValues::table(const std::string& treated, ParameterTable entries) {
  return ParameterTable{}
      .text("block", "position", treated + " block: position, yaw, target, ...")
      .tables("keyframes", std::move(entries), "times and values; at least one", true);
}

TimedValues::TimedValues(const Parameters& parameters) : block_(parameters.text("block")) {
  for (const Parameters& given : parameters.tables("keyframes")) {
    const auto value = given.numbers("value");
    times_.push_back(given.number("time"));
    values_.emplace_back(value.begin(), value.end());
  }
  if (times_.empty())
    throw InputError(parameters.origin("keyframes"), "keyframes: expected at least one");
}

AnyHandle TimedValues::bind(const ProblemSetting& setting, FunctionShape& shape,
                            const std::string& treatment) const {
  const BlockSpec& block = setting.layout.block(setting.layout.index(block_));
  if (block.topology != Topology::line)
    throw InputError("block '" + block_ + "' is an orientation, which keyframes cannot " +
                     treatment);
  for (std::size_t j = 0; j < values_.size(); ++j)
    if (static_cast<int>(values_[j].size()) != block.size)
      throw InputError("keyframe " + std::to_string(j + 1) + " has " +
                       std::to_string(values_[j].size()) + " numbers, block '" + block_ + "' has " +
                       std::to_string(block.size));
  shape.times = times_;
  return BlocksRead(setting.layout, shape.blocks).add<Eigen::Dynamic>(block_);
}

}  // namespace lapwing
