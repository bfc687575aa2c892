// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/depth_source.h"

namespace lapwing {
namespace {

class FolderDepth final : public DepthSource {
 public:
  explicit FolderDepth(DepthFolder folder) : folder_(std::move(folder)) {}
  std::size_t size() const override { return folder_.size(); }
  std::string name(std::size_t image) const override { return folder_.name(image); }
  Pose camera(std::size_t image) const override { return folder_.pose(image); }
  Pinhole pinhole(std::size_t) const override { return folder_.pinhole(); }
  PosedDepthImage read(std::size_t image) const override { return folder_.read(image); }

 private:
  DepthFolder folder_;
};

class PlacedDepth final : public DepthSource {
 public:
  PlacedDepth(std::shared_ptr<const DepthSource> source, const Similarity& to_world)
      : source_(std::move(source)), to_world_(to_world) {}
  std::size_t size() const override { return source_->size(); }
  std::string name(std::size_t image) const override { return source_->name(image); }
  Pose camera(std::size_t image) const override { return to_world_.apply(source_->camera(image)); }
  Pinhole pinhole(std::size_t image) const override { return source_->pinhole(image); }
  PosedDepthImage read(std::size_t image) const override {
    PosedDepthImage read = source_->read(image);
    read.camera = to_world_.apply(read.camera);
    if (to_world_.scale != 1) {
      for (float& depth : read.image.depth)
        depth = static_cast<float>(to_world_.scale * static_cast<double>(depth));
    }
    return read;
  }

 private:
  std::shared_ptr<const DepthSource> source_;
  Similarity to_world_;
};

}  // namespace

std::shared_ptr<const DepthSource> depth_of_folder(DepthFolder folder) {
  return std::make_shared<FolderDepth>(std::move(folder));
}

std::shared_ptr<const DepthSource> placed(std::shared_ptr<const DepthSource> source,
                                          const Similarity& to_world) {
  return std::make_shared<PlacedDepth>(std::move(source), to_world);
}

}  // namespace lapwing
