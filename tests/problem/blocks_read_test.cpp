// SPDX-License-Identifier: Apache-2.0
// Blocks read by name: places, sizes, mistakes, and the numbers that come of them.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

StageLayout layout_of_four() {
  StageLayout layout;
  layout.add({.name = "position", .size = 3});
  layout.add({.name = "yaw"});
  layout.add({.name = "force", .size = 3, .role = BlockRole::input});
  layout.add({.name = "step", .role = BlockRole::clock});
  return layout;
}

TEST(BlocksRead, StandInTheOrderInWhichTheyAreAdded) {
  const StageLayout layout = layout_of_four();
  std::vector<int> blocks;
  BlocksRead reads(layout, blocks);
  const VectorHandle force = reads.add<3>("force");
  const NumberHandle step = reads.add("step");
  const AnyHandle position = reads.add<Eigen::Dynamic>("position");
  const VectorHandle again = reads.add<3>("force");
  EXPECT_EQ(blocks, (std::vector<int>{2, 3, 0}));
  EXPECT_EQ(force.offset(), 0);
  EXPECT_EQ(step.offset(), 3);
  EXPECT_EQ(position.offset(), 4);
  EXPECT_EQ(position.size(), 3);
  EXPECT_EQ(again.offset(), 0) << "read already";
  EXPECT_TRUE(reads.has("yaw"));
  EXPECT_FALSE(reads.has("target"));
}

TEST(BlocksRead, WhatIsNotThereOrOfAnotherSizeIsNamed) {
  const StageLayout layout = layout_of_four();
  std::vector<int> blocks;
  BlocksRead reads(layout, blocks);
  try {
    reads.add<3>("postion");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'position'"), std::string::npos) << error.what();
  }
  try {
    reads.add<3>("yaw");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "block 'yaw' is read as 3 numbers and has 1");
  }
}

// yaw^2 + step of the next stage x force.z, by name.
class Product final : public DifferentiableCost<Product, 4> {
 public:
  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.window = 2, .rows = 1};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add("yaw"), reads.add("step"), reads.add<3>("force")};
    return shape;
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    rows[0] = stage(in_.yaw) * stage(in_.yaw) + stage[1](in_.step) * stage(in_.force).z();
  }

 private:
  struct {
    NumberHandle yaw, step;
    VectorHandle force;
  } in_;
};

TEST(BlocksRead, HandlesReadTheirBlocks) {
  const StageLayout layout = layout_of_four();
  const Horizon horizon{.stages = 4, .step = 0.1};
  const Vehicle vehicle;
  const Environment environment;
  Product product;
  product.bind({layout, horizon, vehicle, environment});
  // yaw, step, force of this stage, then of the next.
  const std::vector<double> inputs = {2, 9, 3, 4, 5, 7, 0.5, 11, 12, 13};
  double value = 0;
  std::vector<double> slopes(inputs.size()), curvature(inputs.size() * inputs.size(), 0.0);
  Workspace workspace;
  product.evaluate({0, 1}, inputs.data(), &value, slopes.data(), workspace);
  EXPECT_DOUBLE_EQ(value, 2 * 2 + 0.5 * 5);
  EXPECT_EQ(slopes, (std::vector<double>{4, 0, 0, 0, 0.5, 0, 5, 0, 0, 0}));
  const double one = 1;
  product.curvature({0, 1}, inputs.data(), &one, curvature.data(), workspace);
  EXPECT_DOUBLE_EQ(curvature[0], 2);
  EXPECT_DOUBLE_EQ(curvature[4 * 10 + 6], 1);
  EXPECT_DOUBLE_EQ(curvature[6 * 10 + 4], 1);
}

}  // namespace
}  // namespace lapwing
