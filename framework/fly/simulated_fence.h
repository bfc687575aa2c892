// SPDX-License-Identifier: Apache-2.0
// The fence of the simulated vehicle: the vehicle's side of MAVLink's mission protocol
// (mavlink.io/en/services/mission.html), and breaches of the fence that it was given.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "framework/export/earth_frame.h"
#include "framework/export/mission_fences.h"
#include "framework/mavlink/message.h"

namespace lapwing {

class SimulatedFence {
 public:
  // Keeps a reference. Places of the items are on the earth at `height`, m. One that `refuses`
  // denies every fence.
  SimulatedFence(const EarthFrame& earth, double height, bool refuses);

  // The answer to MISSION_COUNT and MISSION_ITEM_INT, where they need one.
  std::optional<mavlink::Packet> receive(const mavlink::Packet& packet, double now);
  // The request for the next item, twice a second.
  std::optional<mavlink::Packet> step(double now);

  // Counts a breach for each fence whose wrong side the vehicle is on. m, world.
  void watch(const Eigen::Vector2d& place);

  const std::vector<MissionFence>& fences() const { return fences_; }
  std::size_t items() const { return items_.size(); }
  std::uint64_t breaches() const { return breaches_; }

 private:
  using Item = mavlink::Message<mavlink::kMissionItemInt>;
  mavlink::Packet acknowledge(const mavlink::Packet& packet, std::uint8_t result);
  std::uint8_t finish();

  const EarthFrame& earth_;
  double height_;
  bool refuses_;
  bool open_ = false;                               // items are missing
  std::uint8_t sender_ = 0, sender_component_ = 0;  // of the items
  std::size_t count_ = 0, next_ = 0;
  double asked_at_ = 0;  // s
  std::vector<Item> items_;
  std::vector<MissionFence> fences_;
  std::uint64_t breaches_ = 0;
};

}  // namespace lapwing
