// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/tlog/tlog_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "framework/core/error.h"
#include "framework/flight_log/log_builder.h"
#include "framework/mavlink/message.h"
#include "framework/mavlink/vocabulary.h"
#include "plugins/flight_logs/tlog/tlog_clock.h"
#include "plugins/flight_logs/tlog/tlog_file.h"

namespace lapwing::tlog {
namespace {

using namespace mavlink;

constexpr double kLongestSilence = 1;  // s; more is a gap
constexpr double kNearClock = 1;       // s, of a setpoint's time from that of its packet
constexpr double kSameOrigin = 1;      // m
constexpr int kMostLost = 128;         // a larger gap in a sequence is a sender that began anew
constexpr std::uint8_t kFrameRelative = 3;
// POSITION_TARGET_TYPEMASK
constexpr std::uint16_t kIgnorePosition = 1 | 2 | 4, kIgnoreVelocity = 8 | 16 | 32,
                        kIgnoreYaw = 1024;
// GIMBAL_DEVICE_FLAGS: the yaw is of the earth.
constexpr std::uint16_t kGimbalYawLock = 16, kGimbalYawInEarth = 64;

std::string counted(std::size_t count, const std::string& one) {
  return std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

// s since the sender's boot, where the message states it.
std::optional<double> boot_of(const Packet& packet) {
  switch (packet.message) {
    case kAttitude:
      return 1e-3 * Message<kAttitude>(packet).get<"time_boot_ms">();
    case kLocalPosition:
      return 1e-3 * Message<kLocalPosition>(packet).get<"time_boot_ms">();
    case kGlobalPosition:
      return 1e-3 * Message<kGlobalPosition>(packet).get<"time_boot_ms">();
    case kGimbalDeviceAttitude:
      return 1e-3 * Message<kGimbalDeviceAttitude>(packet).get<"time_boot_ms">();
    default:
      return std::nullopt;
  }
}

bool relative_to_home(std::uint8_t frame) {
  return frame == kFrameRelative || frame == kFrameRelativeInt;
}

// Nothing for 0, 0, which autopilots without a fix send, and for what is not on the earth.
std::optional<GeodeticPoint> point_of(std::int32_t lat, std::int32_t lon, double height) {
  const GeodeticPoint point{1e-7 * lat, 1e-7 * lon, height};
  if ((lat == 0 && lon == 0) || std::abs(point.latitude_deg) > 90 ||
      std::abs(point.longitude_deg) > 180 || !std::isfinite(height))
    return std::nullopt;
  return point;
}

// What the first reading learns of a sender.
struct Sender {
  std::size_t first = 0;   // packet
  std::size_t motion = 0;  // packets of place or attitude
  std::uint8_t autopilot = kNoAutopilot;
  std::string version;  // of its firmware
  bool has_local_velocity = false, has_battery = false, origin_moved = false;
  std::optional<GeodeticPoint> origin;  // of its local frame, height above the sea
  std::optional<double> home;           // m above the sea
  std::optional<std::uint8_t> next;     // sequence
  std::size_t lost = 0, has_signature = 0;
  BootClock clock;

  bool flies() const { return autopilot != kNoAutopilot && motion > 0; }
};

void follow(Sender& sender, std::uint8_t sequence) {
  if (sender.next) {
    const int gap = static_cast<std::uint8_t>(sequence - *sender.next);
    if (gap < kMostLost) sender.lost += static_cast<std::size_t>(gap);
  }
  sender.next = static_cast<std::uint8_t>(sequence + 1);
}

void learn_origin(Sender& sender, const Message<kGlobalOrigin>& m) {
  const auto point =
      point_of(m.get<"latitude">(), m.get<"longitude">(), 1e-3 * m.get<"altitude">());
  if (!point) return;
  if (sender.origin && to_local(*sender.origin, *point).norm() > kSameOrigin)
    sender.origin_moved = true;
  if (!sender.origin) sender.origin = point;
}

void learn(Sender& sender, const Packet& packet) {
  switch (packet.message) {
    case kHeartbeat: {
      const Message<kHeartbeat> m(packet);
      if (m.get<"type">() != kGroundStation && m.get<"type">() != kOnboardController)
        sender.autopilot = m.get<"autopilot">();
      return;
    }
    case kAutopilotVersion: {
      const auto v = Message<kAutopilotVersion>(packet).get<"flight_sw_version">();
      sender.version = std::to_string(v >> 24) + "." + std::to_string(v >> 16 & 255) + "." +
                       std::to_string(v >> 8 & 255);
      return;
    }
    case kLocalPosition:
      sender.has_local_velocity = true;
      ++sender.motion;
      return;
    case kGlobalPosition: {
      const Message<kGlobalPosition> m(packet);
      sender.home = 1e-3 * (static_cast<double>(m.get<"alt">()) - m.get<"relative_alt">());
      ++sender.motion;
      return;
    }
    case kAttitude:
      ++sender.motion;
      return;
    case kGlobalOrigin:
      return learn_origin(sender, Message<kGlobalOrigin>(packet));
    case kSysStatus: {
      const auto voltage = Message<kSysStatus>(packet).get<"voltage_battery">();
      if (voltage != 0 && voltage != 65535) sender.has_battery = true;
      return;
    }
    default:
      return;
  }
}

class Mapping {
 public:
  explicit Mapping(std::string_view bytes) : bytes_(bytes), builder_("tlog", bytes.size()) {}

  FlightLog run() {
    look();
    choose();
    describe();
    const Listener listener{[this](std::uint64_t stamp, const Packet& packet, bool known) {
      if (known) take(time_of(stamp), packet);
    }};
    read_records(bytes_, listener);
    name_sources();
    remark();
    if (builder_.has("orientation")) builder_.log.series.erase("yaw");
    FlightLog log = builder_.finish();
    add_camera(log);
    if (log.series.empty()) refuse();
    return log;
  }

 private:
  using Key = std::uint16_t;  // system and component

  static Key key_of(const Packet& packet) {
    return static_cast<Key>(packet.system << 8 | packet.component);
  }
  std::uint8_t system() const { return static_cast<std::uint8_t>(vehicle_ >> 8); }
  Sender& vehicle() { return senders_.at(vehicle_); }

  double time_of(std::uint64_t stamp) const {
    return 1e-6 * (static_cast<double>(stamp) - static_cast<double>(begin_));
  }

  [[noreturn]] void refuse() const {
    const std::string& damage = builder_.log.damage;
    throw InputError(
        "no vehicle of it tells where it is; expected LOCAL_POSITION_NED or GLOBAL_POSITION_INT" +
        (damage.empty() ? std::string() : "; " + damage));
  }

  void look() {
    bool begun = false;
    const Listener listener{[&](std::uint64_t stamp, const Packet& packet, bool known) {
      if (!begun) begin_ = stamp, begun = true;
      ++counts_[{key_of(packet), packet.message}];
      unknown_ += known ? 0 : 1;
      Sender& sender = senders_[key_of(packet)];
      follow(sender, packet.sequence);
      if (!known) return;
      if (sender.motion == 0) sender.first = packets_;
      ++packets_;
      sender.has_signature += packet.has_signature ? 1 : 0;
      learn(sender, packet);
      if (const auto boot = boot_of(packet)) sender.clock.learn(time_of(stamp), *boot);
      if (packet.message == kGlobalTarget) {
        const Message<kGlobalTarget> m(packet);
        if (relative_to_home(m.get<"coordinate_frame">()))
          above_home_[m.get<"target_system">()] = true;
      }
      // The local frame begins at home.
      if (packet.message == kLocalTarget)
        above_home_[Message<kLocalTarget>(packet).get<"target_system">()] = true;
    }};
    const Outcome outcome = read_records(bytes_, listener);
    builder_.log.bytes_read = outcome.read;
    builder_.log.damage = outcome.damage;
  }

  // The first autopilot that tells of its motion; without one, the first sender that does.
  void choose() {
    std::optional<Key> best;
    for (const auto& [key, sender] : senders_) {
      if (sender.motion == 0) continue;
      ++flying_;
      const auto rank = [this](Key k) {
        const Sender& s = senders_.at(k);
        return std::pair(!s.flies(), s.first);
      };
      if (!best || rank(key) < rank(*best)) best = key;
    }
    if (!best) refuse();
    vehicle_ = *best;
  }

  // Heights are counted as the setpoints of the flight count them: a plan above the ground is flown
  // above home. Without setpoints, above the sea.
  void describe() {
    FlightLog& log = builder_.log;
    log.clock = "the first packet of the log";
    log.utc = 1e-6 * static_cast<double>(begin_);
    const Sender& flown = vehicle();
    relative_ = (above_home_[system()] || above_home_[0]) && flown.home;
    log.heights = relative_ ? HeightOf::ground : HeightOf::sea;
    log.recorder = flown.autopilot == kPx4         ? "PX4"
                   : flown.autopilot == kArduPilot ? "ArduPilot"
                                                   : "a MAVLink vehicle";
    if (!flown.version.empty()) log.recorder += " " + flown.version;
    log.recorder += ", system " + std::to_string(system());
    if (flown.origin && !flown.origin_moved) {
      log.reference = flown.origin;
      if (relative_) log.reference->altitude -= *flown.home;
    }
    for (const auto& [of, count] : counts_) {
      const MessageEntry* entry = find_message(of.second);
      std::string name = entry ? std::string(entry->name) : "message " + std::to_string(of.second);
      if (of.first != vehicle_)
        name += " of " + std::to_string(of.first >> 8) + "/" + std::to_string(of.first & 255);
      log.records.push_back({name, count});
    }
  }

  void take(double received, const Packet& packet) {
    double time = received;
    if (const auto boot = boot_of(packet)) time = senders_.at(key_of(packet)).clock.measured(*boot);
    if (packet.message == kLocalTarget) return take_local_target(received, packet);
    if (packet.message == kGlobalTarget) return take_global_target(received, packet);
    if (packet.system != system()) return;
    if (packet.message == kGimbalDeviceAttitude) return take_gimbal(time, packet);
    if (key_of(packet) != vehicle_) return;
    if (received - heard_ > kLongestSilence && heard_known_)
      builder_.log.gaps.push_back({received, received - heard_});
    heard_ = received, heard_known_ = true;
    take_state(time, packet);
  }

  void take_state(double time, const Packet& packet) {
    switch (packet.message) {
      case kLocalPosition: {
        const Message<kLocalPosition> m(packet);
        builder_.add("position", time, {m.get<"y">(), m.get<"x">(), -m.get<"z">()});
        return builder_.add("velocity", time, {m.get<"vy">(), m.get<"vx">(), -m.get<"vz">()});
      }
      case kGlobalPosition:
        return take_global(time, Message<kGlobalPosition>(packet));
      case kAttitude: {
        const Message<kAttitude> m(packet);
        const Eigen::Vector4d q =
            orientation_of_euler(m.get<"roll">(), m.get<"pitch">(), m.get<"yaw">());
        builder_.add("orientation", time, {q.data(), 4});
        return builder_.add("body_rates", time,
                            {m.get<"rollspeed">(), -m.get<"pitchspeed">(), -m.get<"yawspeed">()});
      }
      case kSysStatus:
      case kBatteryStatus:
        return take_battery(time, packet);
      case kStatusText:
        return take_text(time, Message<kStatusText>(packet));
      case kHeartbeat:
        return take_mode(time, Message<kHeartbeat>(packet));
      default:
        return;
    }
  }

  void take_global(double time, const Message<kGlobalPosition>& m) {
    const double height = 1e-3 * (relative_ ? m.get<"relative_alt">() : m.get<"alt">());
    const auto point = point_of(m.get<"lat">(), m.get<"lon">(), height);
    if (!point) return void(++without_place_);
    builder_.add("place", time, {point->latitude_deg, point->longitude_deg, height});
    if (!vehicle().has_local_velocity)
      builder_.add("velocity", time,
                   {1e-2 * m.get<"vy">(), 1e-2 * m.get<"vx">(), -1e-2 * m.get<"vz">()});
    if (m.get<"hdg">() != 65535)
      builder_.add("yaw", time, {yaw_of_heading(m.get<"hdg">() * M_PI / 18000)});
  }

  // SYS_STATUS; without a voltage there, the first battery of BATTERY_STATUS. What is not measured
  // is 65535 or -1.
  void take_battery(double time, const Packet& packet) {
    const bool of_system = packet.message == kSysStatus;
    if (of_system != vehicle().has_battery) return;
    double voltage = NAN;
    int current = -1, left = -1;
    if (of_system) {
      const Message<kSysStatus> m(packet);
      if (m.get<"voltage_battery">() != 65535) voltage = 1e-3 * m.get<"voltage_battery">();
      current = m.get<"current_battery">(), left = m.get<"battery_remaining">();
    } else {
      const Message<kBatteryStatus> m(packet);
      if (m.get<"id">() != 0) return;
      for (std::size_t i = 0; i < 10; ++i)
        if (m.get<"voltages">(i) != 65535)
          voltage = (i == 0 ? 0 : voltage) + 1e-3 * m.get<"voltages">(i);
      current = m.get<"current_battery">(), left = m.get<"battery_remaining">();
    }
    builder_.add("battery", time,
                 {voltage, current < 0 ? NAN : 1e-2 * current, left < 0 ? NAN : 1e-2 * left});
  }

  // A long text comes in chunks of one number.
  void take_text(double time, const Message<kStatusText>& m) {
    auto& messages = builder_.log.messages;
    const auto id = m.get<"id">();
    if (id != 0 && id == text_id_ && m.get<"chunk_seq">() > 0)
      messages[text_at_].text += m.text<"text">();
    else
      text_at_ = messages.size(), messages.push_back({time, m.text<"text">()});
    text_id_ = id;
  }

  void take_mode(double time, const Message<kHeartbeat>& m) {
    auto& messages = builder_.log.messages;
    const std::uint32_t mode = m.get<"custom_mode">();
    const bool armed = m.get<"base_mode">() & kArmed;
    if (mode != mode_) messages.push_back({time, "mode " + std::to_string(mode)});
    if (armed != armed_) messages.push_back({time, armed ? "armed" : "disarmed"});
    mode_ = mode, armed_ = armed;
  }

  void take_gimbal(double time, const Packet& packet) {
    const Message<kGimbalDeviceAttitude> m(packet);
    const double w = m.get<"q">(0), x = m.get<"q">(1), y = m.get<"q">(2), z = m.get<"q">(3);
    if (!std::isfinite(time + w + x + y + z)) return;
    gimbal_.push_back({time, std::atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
                       std::asin(std::clamp(2 * (w * y - z * x), -1.0, 1.0)),
                       (m.get<"flags">() & (kGimbalYawLock | kGimbalYawInEarth)) != 0});
  }

  // Of a gimbal that turns with the vehicle, where the heading is known.
  void add_camera(FlightLog& log) const {
    LogBuilder camera("tlog", 0);
    for (const Gimbal& g : gimbal_) {
      const auto yaw = value_at(log, "yaw", g.time);
      if (g.from_north) camera.add("camera", g.time, {yaw_of_heading(g.yaw), g.pitch});
      if (!g.from_north && yaw)
        camera.add("camera", g.time, {std::remainder((*yaw)[0] - g.yaw, 2 * M_PI), g.pitch});
    }
    FlightLog made = camera.finish();
    const auto found = made.series.find("camera");
    if (found == made.series.end()) return;
    found->second.source = find_message(kGimbalDeviceAttitude)->name;
    log.series["camera"] = std::move(found->second);
    log.remarks.insert(log.remarks.end(), made.remarks.begin(), made.remarks.end());
  }

  // The time that a setpoint states is of the vehicle's clock (Lapwing) or of its sender's.
  double time_of_target(double received, std::uint32_t boot_ms) {
    const double meant = vehicle().clock.at(1e-3 * boot_ms);
    return std::abs(meant - received) < kNearClock ? meant : received;
  }

  bool for_us(std::uint8_t target) const { return target == system() || target == 0; }

  template <class Target>
  void take_target(double time, const Target& m, const std::optional<Eigen::Vector3d>& position) {
    const auto mask = m.template get<"type_mask">();
    if (!(mask & kIgnorePosition) && position)
      builder_.add("position_setpoint", time, {position->data(), 3});
    if (!(mask & kIgnoreVelocity))
      builder_.add("velocity_setpoint", time,
                   {m.template get<"vy">(), m.template get<"vx">(), -m.template get<"vz">()});
    if (!(mask & kIgnoreYaw))
      builder_.add("yaw_setpoint", time, {yaw_of_heading(m.template get<"yaw">())});
  }

  void take_local_target(double received, const Packet& packet) {
    const Message<kLocalTarget> m(packet);
    if (!for_us(m.get<"target_system">())) return;
    if (m.get<"coordinate_frame">() != kFrameLocalNed) return void(++other_frames_);
    take_target(time_of_target(received, m.get<"time_boot_ms">()), m,
                Eigen::Vector3d(m.get<"y">(), m.get<"x">(), -m.get<"z">()));
  }

  void take_global_target(double received, const Packet& packet) {
    const Message<kGlobalTarget> m(packet);
    if (!for_us(m.get<"target_system">())) return;
    const auto frame = m.get<"coordinate_frame">();
    const bool above_sea = frame == kFrameGlobal || frame == kFrameGlobalInt;
    if (!above_sea && !relative_to_home(frame)) return void(++other_frames_);
    std::optional<Eigen::Vector3d> position;
    const auto& reference = builder_.log.reference;
    const auto point = point_of(m.get<"lat_int">(), m.get<"lon_int">(), m.get<"alt">());
    if (reference && point && above_sea != relative_) position = to_local(*reference, *point);
    if (!position && !(m.get<"type_mask">() & kIgnorePosition)) ++targets_without_place_;
    take_target(time_of_target(received, m.get<"time_boot_ms">()), m, position);
  }

  void name_sources() {
    const auto name = [this](const char* quantity, std::uint32_t message) {
      if (builder_.has(quantity))
        builder_.name_source(quantity, std::string(find_message(message)->name));
    };
    name("position", kLocalPosition);
    name("place", kGlobalPosition);
    name("velocity", vehicle().has_local_velocity ? kLocalPosition : kGlobalPosition);
    name("orientation", kAttitude);
    name("body_rates", kAttitude);
    name("yaw", kGlobalPosition);
    name("battery", vehicle().has_battery ? kSysStatus : kBatteryStatus);
    const bool local = counts_of(kLocalTarget) > 0;
    for (const char* setpoint : {"position_setpoint", "velocity_setpoint", "yaw_setpoint"})
      name(setpoint, local ? kLocalTarget : kGlobalTarget);
  }

  std::size_t counts_of(std::uint32_t message) const {
    std::size_t sum = 0;
    for (const auto& [of, count] : counts_) sum += of.second == message ? count : 0;
    return sum;
  }

  void remark() {
    const Sender& flown = vehicle();
    const auto say = [this](std::size_t count, const std::string& what, const std::string& why) {
      if (count > 0) builder_.log.remarks.push_back(counted(count, what) + " " + why);
    };
    say(flying_ - 1, "other sender",
        "told of a motion; system " + std::to_string(system()) + " is read");
    say(flown.lost, "packet", "of the vehicle missing, by their sequence");
    say(unknown_, "packet", "of messages that are not known here, left out");
    say(flown.has_signature, "packet", "with a signature that nobody checked");
    say(without_place_, "place", "without latitude and longitude, left out");
    say(other_frames_, "setpoint", "in a frame that turns with the vehicle, left out");
    say(targets_without_place_, "setpoint",
        "on the earth without a position in the local frame: the log does not tell where that is "
        "(GPS_GLOBAL_ORIGIN), or counts heights otherwise");
    if (flown.origin_moved)
      builder_.log.remarks.emplace_back(
          "the origin of the local frame moved during the log; it is not used");
  }

  struct Gimbal {
    double time = 0, yaw = 0, pitch = 0;  // s, rad
    bool from_north = false;
  };

  std::string_view bytes_;
  LogBuilder builder_;
  std::uint64_t begin_ = 0;  // us since 1970
  std::map<Key, Sender> senders_;
  std::map<std::pair<Key, std::uint32_t>, std::size_t> counts_;
  std::array<bool, 256> above_home_{};  // by the system that setpoints are for
  std::size_t packets_ = 0, unknown_ = 0, flying_ = 0;
  Key vehicle_ = 0;
  bool relative_ = false;  // heights above home
  double heard_ = 0;       // s, when the vehicle was heard
  bool heard_known_ = false, armed_ = false;
  std::optional<std::uint32_t> mode_;
  std::uint16_t text_id_ = 0;
  std::size_t text_at_ = 0;
  std::vector<Gimbal> gimbal_;
  std::size_t without_place_ = 0, other_frames_ = 0, targets_without_place_ = 0;
};

}  // namespace

FlightLog read(std::string_view bytes) {
  return Mapping(bytes).run();
}

std::string example() {
  std::string out;
  std::uint8_t sequence = 0;
  const auto append = [&](std::uint64_t microseconds, Packet packet) {
    packet.system = 1, packet.component = kAutopilotComponent, packet.sequence = sequence++;
    for (int shift = 56; shift >= 0; shift -= 8)
      out += static_cast<char>(microseconds >> shift & 0xff);
    out += bytes_of(packet);
  };
  const std::uint64_t begin = 1'700'000'000'000'000;
  append(begin, Message<kHeartbeat>()
                    .set<"type">(kQuadrotor)
                    .set<"autopilot">(kPx4)
                    .set<"mavlink_version">(3)
                    .packet());
  for (std::uint32_t k = 0; k <= 10; ++k)
    append(begin + 100'000 * k, Message<kLocalPosition>()
                                    .set<"time_boot_ms">(5000 + 100 * k)
                                    .set<"x">(1)
                                    .set<"y">(0.1f * static_cast<float>(k))
                                    .set<"z">(-2)
                                    .packet());
  return out;
}

}  // namespace lapwing::tlog
