// SPDX-License-Identifier: Apache-2.0
// The point that a camera term looks at: the free block `target`, or a subject of the environment
// on its track.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "framework/core/parameters.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/stage_function.h"

namespace lapwing {

// InputError naming the known subjects and the nearest.
const Subject& subject_named(const Environment& environment, const std::string& name);

// Where a subject is; time may be a dual number. At a corner of the track, the way it goes on.
template <class T>
Eigen::Matrix<T, 3, 1> subject_position(const Subject& subject, const T& time) {
  const auto& times = subject.times;
  const auto next = std::upper_bound(times.begin(), times.end(), value_of(time));
  const auto k = static_cast<std::size_t>(next - times.begin());
  const Eigen::Vector3d& from = subject.positions[k == 0 ? 0 : k - 1];
  Eigen::Matrix<T, 3, 1> result(T(from.x()), T(from.y()), T(from.z()));
  if (k == 0 || k == times.size()) return result;
  const Eigen::Vector3d velocity = (subject.positions[k] - from) / (times[k] - times[k - 1]);
  for (int i = 0; i < 3; ++i) result(i) += (time - times[k - 1]) * velocity(i);
  return result;
}

class FilmedPoint {
 public:
  // Adds the parameters `subject` and, for functions of the size, `height`.
  enum class Has { place, place_and_height };
  static ParameterTable table(Has has);
  FilmedPoint(const Parameters& parameters, Has has);

  // Adds the block that it reads to the shape. InputError when there is none.
  void bind(const ProblemSetting& setting, FunctionShape& shape);
  // From foot to top, m: as given, else the subject's. InputError, beginning with `what`, when
  // neither says.
  double height(const std::string& what) const;

  template <class T>
  Eigen::Matrix<T, 3, 1> at(const Stage<T>& stage) const {
    if (subject_) return subject_position<T>(*subject_, stage(time_));
    return stage(target_);
  }

 private:
  std::optional<std::string> name_;
  std::optional<double> height_;
  std::optional<Subject> subject_;
  NumberHandle time_;  // one of both is read
  VectorHandle target_;
};

}  // namespace lapwing
