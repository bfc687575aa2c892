// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/environment_distance.h"

#include "framework/core/parameters.h"

namespace lapwing {
namespace {

// The lower of two nodes, the first of which may be none (-1).
int minimum(ExpressionGraph& graph, int a, int b, double width) {
  if (a < 0) return b;
  const int lower = graph.apply(TapeOp::maximum, graph.apply(TapeOp::negate, a),
                                graph.apply(TapeOp::negate, b), -1, width);
  return graph.apply(TapeOp::negate, lower);
}

}  // namespace

int nearest_distance(ExpressionGraph& graph, const Environment& environment,
                     const std::string& name, const int (&point)[3], double width) {
  std::vector<std::string> known;
  int nearest = -1;
  for (std::size_t i = 0; i < environment.obstacles.size(); ++i) {
    const Obstacle& obstacle = environment.obstacles[i];
    if (obstacle.side == Side::keep_inside) continue;
    known.push_back(obstacle.name);
    if (!name.empty() && obstacle.name != name) continue;
    if (!obstacle.shape)
      throw InputError("'" + obstacle.name + "' has no distances: its shape was not opened");
    if (!obstacle.still())
      throw InputError("'" + obstacle.name +
                       "' moves: only distances to obstacles that stand still are possible");
    const int field = graph.add_field(obstacle.shape, static_cast<int>(i));
    nearest = minimum(graph, nearest,
                      graph.apply(TapeOp::distance, point[0], point[1], point[2], 0, field), width);
  }
  if (nearest >= 0) return nearest;
  if (name.empty()) throw InputError("the environment has no obstacle");
  std::string message = "no obstacle '" + name + "' in the environment";
  for (std::size_t k = 0; k < known.size(); ++k)
    message += (k ? ", '" : known.size() == 1 ? "; there is '" : "; there are '") + known[k] + "'";
  const std::string close = nearest_name(name, known);
  throw InputError(message + (close.empty() ? "" : "; did you mean '" + close + "'?"));
}

}  // namespace lapwing
