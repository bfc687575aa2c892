// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/simulated_fence.h"

#include "framework/mavlink/vocabulary.h"

namespace lapwing {

using namespace mavlink;

namespace {

constexpr double kAskAgain = 0.5;  // s, for an item
constexpr double kLongAgo = -1e9;  // s

bool inside_fence(const MissionFence& fence, const Eigen::Vector2d& p) {
  if (fence.corners.empty()) return (p - fence.center).norm() < fence.radius;
  bool in = false;
  const auto& c = fence.corners;
  for (std::size_t i = 0, j = c.size() - 1; i < c.size(); j = i++)
    if ((c[i].y() > p.y()) != (c[j].y() > p.y()) &&
        p.x() < (c[j].x() - c[i].x()) * (p.y() - c[i].y()) / (c[j].y() - c[i].y()) + c[i].x())
      in = !in;
  return in;
}

}  // namespace

SimulatedFence::SimulatedFence(const EarthFrame& earth, double height, bool refuses)
    : earth_(earth), height_(height), refuses_(refuses) {}

// To whoever sent `packet`.
Packet SimulatedFence::acknowledge(const Packet& packet, std::uint8_t result) {
  open_ = false;
  return Message<kMissionAck>()
      .set<"target_system">(packet.system)
      .set<"target_component">(packet.component)
      .set<"type">(result)
      .set<"mission_type">(kFenceMission)
      .packet();
}

// Polygons are runs of items that state how many corners theirs has.
std::uint8_t SimulatedFence::finish() {
  constexpr double kE7 = 1e7;
  std::vector<MissionFence> fences;
  for (std::size_t i = 0; i < items_.size();) {
    const Item& first = items_[i];
    const std::uint16_t command = first.get<"command">();
    const auto place = [&](const Item& item) -> Eigen::Vector2d {
      return earth_.local({item.get<"x">() / kE7, item.get<"y">() / kE7, height_}).head<2>();
    };
    MissionFence fence;
    fence.inclusion = command == kFenceInclusion || command == kCircleInclusion;
    if (command == kCircleInclusion || command == kCircleExclusion) {
      fence.center = place(first);
      fence.radius = first.get<"param1">();
      ++i;
    } else {
      const auto corners = static_cast<std::size_t>(first.get<"param1">());
      const bool polygon = command == kFenceInclusion || command == kFenceExclusion;
      if (!polygon || corners < 3 || i + corners > items_.size()) return kMissionError;
      for (std::size_t k = 0; k < corners; ++k, ++i) {
        if (items_[i].get<"command">() != command) return kMissionError;
        fence.corners.push_back(place(items_[i]));
      }
    }
    fences.push_back(fence);
  }
  fences_ = fences;
  return kMissionAccepted;
}

std::optional<Packet> SimulatedFence::receive(const Packet& packet, double now) {
  if (packet.message == kMissionCount) {
    const Message<kMissionCount> count(packet);
    if (count.get<"mission_type">() != kFenceMission) return std::nullopt;
    if (refuses_) return acknowledge(packet, kMissionDenied);
    sender_ = packet.system, sender_component_ = packet.component;
    count_ = count.get<"count">();
    next_ = 0;
    items_.clear();
    open_ = true;
    asked_at_ = kLongAgo;
    return std::nullopt;
  }
  const Item item(packet);
  if (!open_ || item.get<"mission_type">() != kFenceMission) return std::nullopt;
  if (item.get<"seq">() != next_) return std::nullopt;
  items_.push_back(item);
  asked_at_ = now - 2 * kAskAgain;
  if (++next_ < count_) return std::nullopt;
  return acknowledge(packet, finish());
}

std::optional<Packet> SimulatedFence::step(double now) {
  if (!open_ || now - asked_at_ <= kAskAgain) return std::nullopt;
  asked_at_ = now;
  return Message<kMissionRequestInt>()
      .set<"target_system">(sender_)
      .set<"target_component">(sender_component_)
      .set<"seq">(static_cast<std::uint16_t>(next_))
      .set<"mission_type">(kFenceMission)
      .packet();
}

void SimulatedFence::watch(const Eigen::Vector2d& place) {
  for (const MissionFence& fence : fences_)
    if (inside_fence(fence, place) != fence.inclusion) ++breaches_;
}

}  // namespace lapwing
