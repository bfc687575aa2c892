// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/filmed_point.h"

namespace lapwing {

const Subject& subject_named(const Environment& environment, const std::string& name) {
  std::vector<std::string> known;
  for (const Subject& subject : environment.subjects) {
    if (subject.name == name) return subject;
    known.push_back(subject.name);
  }
  std::string message = "no subject '" + name + "' in the environment";
  if (known.empty()) throw InputError(message + ", which has none");
  message += "; there is ";
  for (std::size_t k = 0; k < known.size(); ++k) message += (k ? ", '" : "'") + known[k] + "'";
  const std::string nearest = nearest_name(name, known);
  throw InputError(message + (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

ParameterTable FilmedPoint::table(Has has) {
  ParameterTable table;
  table.optional_text("subject", "name of the subject; absent: the block 'target'");
  if (has == Has::place_and_height)
    table.optional_number("height", "m", "height; absent: that of the subject", above(0));
  return table;
}

FilmedPoint::FilmedPoint(const Parameters& parameters, Has has) {
  if (parameters.has("subject")) name_ = parameters.text("subject");
  if (has == Has::place_and_height && parameters.has("height"))
    height_ = parameters.number("height");
}

void FilmedPoint::bind(const ProblemSetting& setting, FunctionShape& shape) {
  if (name_) subject_ = subject_named(setting.environment, *name_);
  BlocksRead reads(setting.layout, shape.blocks);
  if (subject_)
    time_ = reads.add("time");
  else
    target_ = reads.add<3>("target");
}

double FilmedPoint::height(const std::string& what) const {
  if (height_) return *height_;
  if (subject_ && subject_->height > 0) return subject_->height;
  throw InputError(what + " needs a height, which " +
                   (subject_ ? "subject '" + subject_->name + "' lacks" : "a target lacks") +
                   ": give 'height', in m");
}

}  // namespace lapwing
