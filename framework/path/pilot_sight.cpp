// SPDX-License-Identifier: Apache-2.0
#include "framework/path/pilot_sight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

class SightSpace final : public FreeSpace {
 public:
  SightSpace(std::shared_ptr<const Map> map, const PilotPlace& pilot)
      : map_(std::move(map)), pilot_(pilot) {
    if (!map_) throw Error("in_sight_of: no map");
  }
  bool point_free(const Vector3d& p) const override { return seen(p); }
  bool segment_free(const Vector3d& from, const Vector3d& to) const override {
    const double length = (to - from).norm(), most = map_->grid().resolution() / 2;
    const int steps = std::max(1, static_cast<int>(std::ceil(length / most)));
    for (int k = 0; k <= steps; ++k)
      if (!seen(from + static_cast<double>(k) / steps * (to - from))) return false;
    return true;
  }
  bool swept_box_free(const Vector3d& from, const Vector3d& to, const Vector3d&) const override {
    return from == to ? seen(from) : segment_free(from, to);
  }
  Eigen::AlignedBox3d bounds() const override {
    const Vector3d range = Vector3d::Constant(pilot_.range);
    return {pilot_.eye - range, pilot_.eye + range};
  }

 private:
  bool seen(const Vector3d& p) const {
    const Vector3d line = p - pilot_.eye;
    const double distance = line.norm();
    if (distance > pilot_.range - kSightRoom) return false;
    if (distance <= pilot_.beside) return true;
    return map_->swept_box_free(pilot_.eye + pilot_.beside / distance * line, p,
                                Vector3d::Constant(kSightRoom));
  }

  std::shared_ptr<const Map> map_;
  PilotPlace pilot_;
};

}  // namespace

std::unique_ptr<FreeSpace> in_sight_of(std::shared_ptr<const Map> map, const PilotPlace& pilot) {
  return std::make_unique<SightSpace>(std::move(map), pilot);
}

}  // namespace lapwing
