// SPDX-License-Identifier: Apache-2.0
// Hands the zones of a plan to the vehicle as its fence, by MAVLink's mission protocol
// (mavlink.io/en/services/mission.html): MISSION_COUNT, then MISSION_ITEM_INT for each request,
// then MISSION_ACK. Nothing that waits here blocks: time and packets come from outside.
#pragma once

#include <string>
#include <vector>

#include "framework/export/mission_fences.h"
#include "framework/fly/flight_frame.h"

namespace lapwing {

class FenceUpload {
 public:
  enum class State { idle, waiting, done, failed };

  // The items of these fences; places of the earth are those of the frame. Throws InputError for
  // more items than MAVLink counts, and where the frame has no place on the earth.
  FenceUpload(const std::vector<MissionFence>& fences, const FlightFrame& frame);

  // The packets to send now; retries after 1.5 s, at most five times.
  std::vector<mavlink::Packet> step(double now, std::uint8_t system, std::uint8_t component);
  // The answer to a request is kept for the next step. What is addressed to others is left out, and
  // an acceptance before the last item was sent: it belongs to somebody else's fence.
  void receive(const mavlink::Packet& packet, double now);

  State state() const { return state_; }
  // "the vehicle refuses the fence: ...", "... does not answer".
  const std::string& problem() const { return problem_; }
  std::size_t items() const { return items_.size(); }

 private:
  using Item = mavlink::Message<mavlink::kMissionItemInt>;
  void fail(std::string problem);

  std::vector<Item> items_;
  State state_ = State::idle;
  std::string problem_;
  std::vector<std::uint16_t> requested_;
  bool served_ = false;   // the last item has been sent
  bool counted_ = false;  // a request came: the vehicle knows the count
  double asked_at_ = 0;   // s
  int asked_ = 0;
};

// MAV_MISSION_RESULT in words.
std::string mission_result_in_words(int result);

}  // namespace lapwing
