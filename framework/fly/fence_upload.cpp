// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/fence_upload.h"

#include <cmath>

#include "framework/core/error.h"
#include "framework/mavlink/vocabulary.h"

namespace lapwing {

using namespace mavlink;

namespace {

constexpr double kRetry = 1.5;  // s
constexpr int kMostAsked = 5;
constexpr std::size_t kMostItems = 65535;

Message<kMissionItemInt> fence_item(std::uint16_t command, float param,
                                    const Eigen::Vector2d& place, const FlightFrame& frame) {
  const auto point = frame.on_earth({place.x(), place.y(), 0});
  if (!point)
    throw InputError(
        "the fence has no place on the earth: the plan has no origin, and "
        "the vehicle has not told that of its local frame");
  Message<kMissionItemInt> item;
  item.set<"frame">(kFrameGlobal)
      .set<"command">(command)
      .set<"autocontinue">(1)
      .set<"param1">(param)
      .set<"x">(static_cast<std::int32_t>(std::llround(point->latitude_deg * 1e7)))
      .set<"y">(static_cast<std::int32_t>(std::llround(point->longitude_deg * 1e7)))
      .set<"mission_type">(kFenceMission);
  return item;
}

template <class Message>
bool is_for_us(const Message& message) {
  const std::uint8_t component = message.template get<"target_component">();
  return message.template get<"target_system">() == kOurSystem &&
         (component == kComputer || component == 0);
}

}  // namespace

std::string mission_result_in_words(int result) {
  switch (result) {
    case kMissionAccepted:
      return "accepted";
    case kMissionError:
      return "error";
    case 2:
      return "unsupported frame";
    case kMissionUnsupported:
      return "unsupported";
    case kMissionNoSpace:
      return "no space";
    case kMissionSequence:
      return "wrong sequence";
    case kMissionDenied:
      return "denied";
    case kMissionCancelled:
      return "cancelled";
    default:
      return "result " + std::to_string(result);
  }
}

FenceUpload::FenceUpload(const std::vector<MissionFence>& fences, const FlightFrame& frame) {
  for (const MissionFence& fence : fences) {
    if (fence.corners.empty()) {
      items_.push_back(fence_item(fence.inclusion ? kCircleInclusion : kCircleExclusion,
                                  static_cast<float>(fence.radius), fence.center, frame));
      continue;
    }
    for (const Eigen::Vector2d& corner : fence.corners)
      items_.push_back(fence_item(fence.inclusion ? kFenceInclusion : kFenceExclusion,
                                  static_cast<float>(fence.corners.size()), corner, frame));
  }
  if (items_.size() > kMostItems) throw InputError("the fence has more than 65535 corners");
  if (items_.empty()) state_ = State::done;
}

void FenceUpload::fail(std::string problem) {
  state_ = State::failed;
  problem_ = std::move(problem);
}

void FenceUpload::receive(const Packet& packet, double now) {
  if (state_ != State::waiting) return;
  if (packet.message == kMissionAck) {
    const Message<kMissionAck> ack(packet);
    if (ack.get<"mission_type">() != kFenceMission || !is_for_us(ack)) return;
    if (ack.get<"type">() == kMissionAccepted)
      state_ = served_ ? State::done : state_;
    else
      fail("the vehicle refuses the fence: " + mission_result_in_words(ack.get<"type">()));
    return;
  }
  const bool asks = packet.message == kMissionRequestInt || packet.message == kMissionRequest;
  if (!asks) return;
  // Both messages have the same fields.
  const Message<kMissionRequestInt> request(packet);
  if (request.get<"mission_type">() != kFenceMission || !is_for_us(request)) return;
  if (request.get<"seq">() >= items_.size())
    return fail("the vehicle asks for item " + std::to_string(request.get<"seq">()) +
                " of a fence of " + std::to_string(items_.size()));
  counted_ = true;
  asked_at_ = now, asked_ = 0;
  requested_.push_back(request.get<"seq">());
}

std::vector<Packet> FenceUpload::step(double now, std::uint8_t system, std::uint8_t component) {
  std::vector<Packet> packets;
  if (state_ == State::idle) state_ = State::waiting, asked_at_ = now - 2 * kRetry;
  if (state_ != State::waiting) return packets;
  for (const std::uint16_t sequence : requested_) {
    Item item = items_[sequence];
    item.set<"seq">(sequence).set<"target_system">(system).set<"target_component">(component);
    packets.push_back(item.packet());
    served_ = served_ || sequence + 1u == items_.size();
  }
  const bool answered = !requested_.empty();
  requested_.clear();
  if (answered || now - asked_at_ < kRetry) return packets;
  if (++asked_ > kMostAsked) {
    fail(counted_ ? "the vehicle asked for a part of the fence and then fell silent"
                  : "the vehicle does not answer to the fence (MISSION_COUNT)");
    return packets;
  }
  asked_at_ = now;
  // A vehicle that has begun asks again by itself.
  if (counted_) return packets;
  packets.push_back(Message<kMissionCount>()
                        .set<"target_system">(system)
                        .set<"target_component">(component)
                        .set<"count">(static_cast<std::uint16_t>(items_.size()))
                        .set<"mission_type">(kFenceMission)
                        .packet());
  return packets;
}

}  // namespace lapwing
