// SPDX-License-Identifier: Apache-2.0
// Blocks: the named parts of a stage.
//
// A stage x_i of the trajectory problem is a column of numbers, cut into blocks: position[3], yaw,
// force[3], target[3], step, ... A block's topology says how two of its values differ and how a
// step is taken from one: on a line, plain subtraction and addition; for a unit quaternion (w
// first), the rotation vector in the body frame. Solvers move in the tangent space: `tangent_size`
// numbers.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

enum class Topology { line, quaternion };

// What the kernel may do with a block between two stages.
//   state: follows the vehicle model's flow          input: held over the step
//   free:  belongs to the stage alone (targets)      clock: `time` and `step`
enum class BlockRole { state, input, free, clock };

struct BlockSpec {
  std::string name;  // snake_case
  int size = 1;
  std::string unit = {};
  BlockRole role = BlockRole::state;
  Topology topology = Topology::line;

  int tangent_size() const { return topology == Topology::quaternion ? 3 : size; }
};

// `to` minus `from`: tangent_size numbers. For quaternions, the smallest rotation vector that takes
// `from` to `to`, in the body frame of `from`; q and -q are equal.
void block_difference(const BlockSpec& block, const double* from, const double* to, double* delta);

// `at` moved by `delta`; the inverse of block_difference.
void block_retract(const BlockSpec& block, const double* at, const double* delta, double* result);

// d retract(at, delta) / d delta at delta = 0: size x tangent_size.
Eigen::MatrixXd retraction_jacobian(const BlockSpec& block, const double* at);

// Jacobians of block_difference with respect to tangent steps of `from` and of `to`:
// tangent_size x tangent_size each.
struct DifferenceJacobians {
  Eigen::MatrixXd from, to;
};
DifferenceJacobians difference_jacobians(const BlockSpec& block, const double* from,
                                         const double* to);

// Second derivatives of multipliers . block_difference(from, to) with respect to tangent steps of
// both, `from` first: 2 tangent_size squared, symmetric; zero on a line. `from` and `to` must be of
// unit length.
Eigen::MatrixXd difference_curvature(const BlockSpec& block, const double* from, const double* to,
                                     const double* multipliers);

// "position.x", "rotors.2", "yaw": the name of one number of a block.
std::string component_name(const BlockSpec& block, int component);

// Blocks in order, with their offsets in the stage column and in its tangent space.
class StageLayout {
 public:
  // Returns the block's index. Error when the name is taken or the size is below 1.
  int add(BlockSpec block);

  int count() const { return static_cast<int>(blocks_.size()); }
  const BlockSpec& block(int index) const { return blocks_[index]; }
  int offset(int index) const { return offsets_[index]; }
  int tangent_offset(int index) const { return tangent_offsets_[index]; }
  int size() const { return size_; }
  int tangent_size() const { return tangent_size_; }
  // -1 when there is none.
  int find(std::string_view name) const;
  // InputError naming the known blocks and the nearest one.
  int index(std::string_view name) const;
  std::vector<int> indices(std::initializer_list<std::string_view> names) const;

 private:
  std::vector<BlockSpec> blocks_;
  std::vector<int> offsets_, tangent_offsets_;
  int size_ = 0, tangent_size_ = 0;
};

}  // namespace lapwing
