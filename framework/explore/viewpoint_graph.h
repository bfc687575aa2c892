// SPDX-License-Identifier: Apache-2.0
// The viewpoints of an exploration and the free ways between them.
#pragma once

#include <vector>

#include "framework/explore/viewpoint_index.h"
#include "framework/map/map.h"
#include "framework/trajectory/rest_profile.h"

namespace lapwing {

// How long a move takes: straight ways at a speed, turns on the spot, one after the other. With
// accelerations each move is from rest to rest, and the vehicle turns on the way (rest_profile.h).
struct MoveTimes {
  static constexpr double kStep = 0.05;  // s, between samples of moves from rest to rest

  double speed = 1, turn_rate = 1;                 // m/s, rad/s
  double acceleration = 0, turn_acceleration = 0;  // m/s^2, rad/s^2; 0: at once
  double of(const Viewpoint& a, const Viewpoint& b) const;
  // Of a move from rest to rest; both accelerations are above 0.
  RestProfile way(const Viewpoint& a, const Viewpoint& b) const;
  RestProfile turn(const Viewpoint& a, const Viewpoint& b) const;
};

// Viewpoints, and moves between neighbours that were free when they were added. Shortest ways are
// asked for in the map as it is now: a move that is no longer free is left out until it is found
// to be free again, as it is where noise had blocked it.
class ViewpointGraph {
 public:
  ViewpointGraph(const Map& map, const Eigen::Vector3d& half, const MoveTimes& times)
      : map_(&map), half_(half), times_(times) {}

  int find(const Viewpoint& view) const { return index_.find(view); }
  int add(const Viewpoint& view);
  // Both ways.
  void join(int a, int b);
  bool joined(int a, int b) const;
  const Viewpoint& operator[](int place) const { return index_[place]; }
  int size() const { return index_.size(); }

  // Whether the body can move straight there through free voxels.
  bool free(const Viewpoint& a, const Viewpoint& b) const;

  // After the map has changed: which of the moves that were left out are free again.
  void look_again();

  // The quickest way, `from` left out; empty where there is none or where `from` is `to`.
  std::vector<int> way(int from, int to);
  // By place, the seconds of the quickest way by moves that were not found to be blocked; infinite
  // where there is none.
  std::vector<double> seconds_from(int from) const;
  // By place, whether there is a way; `from` is reached.
  std::vector<bool> reached_from(int from) const;

 private:
  struct Edge {
    int to;
    double seconds;
    bool blocked = false;
  };
  // Seconds by place, and in `before` the place before each; until `to` is reached, -1: all.
  std::vector<double> search(int from, int to, std::vector<int>& before) const;
  std::vector<int> believed_way(int from, int to) const;
  void set_blocked(int a, int b, bool blocked);

  const Map* map_;
  Eigen::Vector3d half_;
  MoveTimes times_;
  ViewpointIndex index_;
  std::vector<std::vector<Edge>> edges_;
  std::vector<std::pair<int, int>> blocked_;
};

}  // namespace lapwing
