// SPDX-License-Identifier: Apache-2.0
#include "framework/path/free_space.h"

#include "framework/core/error.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

class MeshSpace final : public FreeSpace {
 public:
  explicit MeshSpace(std::shared_ptr<const MeshScene> scene) : scene_(std::move(scene)) {
    if (!scene_) throw Error("free_space_of: no scene");
  }
  bool point_free(const Vector3d& p) const override {
    const auto nearest = scene_->nearest(p, 1e-6);
    return !nearest || nearest->distance > 0;
  }
  bool segment_free(const Vector3d& from, const Vector3d& to) const override {
    return !scene_->box_blocked(from, to, Vector3d::Zero());
  }
  bool swept_box_free(const Vector3d& from, const Vector3d& to,
                      const Vector3d& half) const override {
    return !scene_->box_blocked(from, to, half);
  }
  Eigen::AlignedBox3d bounds() const override { return scene_->mesh().bounds(); }

 private:
  std::shared_ptr<const MeshScene> scene_;
};

class MapSpace final : public FreeSpace {
 public:
  explicit MapSpace(std::shared_ptr<const Map> map) : map_(std::move(map)) {
    if (!map_) throw Error("free_space_of: no map");
  }
  bool point_free(const Vector3d& p) const override { return map_->box_free(p, p); }
  bool segment_free(const Vector3d& from, const Vector3d& to) const override {
    return map_->swept_box_free(from, to, Vector3d::Zero());
  }
  bool swept_box_free(const Vector3d& from, const Vector3d& to,
                      const Vector3d& half) const override {
    return map_->swept_box_free(from, to, half);
  }
  Eigen::AlignedBox3d bounds() const override {
    const auto box = map_->bounds();
    if (!box) return {};
    const VoxelGrid& grid = map_->grid();
    return {grid.corner(box->lower),
            grid.corner(box->upper) + Vector3d::Constant(grid.resolution())};
  }

 private:
  std::shared_ptr<const Map> map_;
};

class BothSpaces final : public FreeSpace {
 public:
  BothSpaces(std::unique_ptr<FreeSpace> a, std::unique_ptr<FreeSpace> b)
      : a_(std::move(a)), b_(std::move(b)) {
    if (!a_ || !b_) throw Error("free_in_both: a space is missing");
  }
  bool point_free(const Vector3d& p) const override {
    return a_->point_free(p) && b_->point_free(p);
  }
  bool segment_free(const Vector3d& from, const Vector3d& to) const override {
    return a_->segment_free(from, to) && b_->segment_free(from, to);
  }
  bool swept_box_free(const Vector3d& from, const Vector3d& to,
                      const Vector3d& half) const override {
    return a_->swept_box_free(from, to, half) && b_->swept_box_free(from, to, half);
  }
  Eigen::AlignedBox3d bounds() const override { return a_->bounds().merged(b_->bounds()); }

 private:
  std::unique_ptr<FreeSpace> a_, b_;
};

class RoomySpace final : public FreeSpace {
 public:
  RoomySpace(std::unique_ptr<FreeSpace> space, double more)
      : space_(std::move(space)), more_(Vector3d::Constant(more)) {
    if (!space_ || !(more >= 0)) throw Error("with_room: no space, or less than no room");
  }
  bool point_free(const Vector3d& p) const override { return space_->swept_box_free(p, p, more_); }
  bool segment_free(const Vector3d& from, const Vector3d& to) const override {
    return space_->swept_box_free(from, to, more_);
  }
  bool swept_box_free(const Vector3d& from, const Vector3d& to,
                      const Vector3d& half) const override {
    return space_->swept_box_free(from, to, half + more_);
  }
  Eigen::AlignedBox3d bounds() const override { return space_->bounds(); }

 private:
  std::unique_ptr<FreeSpace> space_;
  Vector3d more_;
};

}  // namespace

std::unique_ptr<FreeSpace> free_space_of(std::shared_ptr<const MeshScene> scene) {
  return std::make_unique<MeshSpace>(std::move(scene));
}

std::unique_ptr<FreeSpace> free_space_of(std::shared_ptr<const Map> map) {
  return std::make_unique<MapSpace>(std::move(map));
}

std::unique_ptr<FreeSpace> free_in_both(std::unique_ptr<FreeSpace> a,
                                        std::unique_ptr<FreeSpace> b) {
  return std::make_unique<BothSpaces>(std::move(a), std::move(b));
}

std::unique_ptr<FreeSpace> with_room(std::unique_ptr<FreeSpace> space, double more) {
  return std::make_unique<RoomySpace>(std::move(space), more);
}

}  // namespace lapwing
