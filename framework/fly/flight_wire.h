// SPDX-License-Identifier: Apache-2.0
// Packets over a link: with sender and sequence, logged, and in lockstep with a simulator.
//
// In lockstep both sides agree that no time passes but what the simulator says: it sends its
// packets of a period and a tick with its time, and waits for a tick in turn. A flight then passes
// as fast as the machine computes it, and the same every time. A tick is a datagram of its own,
// "LAPWING-TICK" and the time in us, or "end"; readers of MAVLink pass over it as garbage.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/fly/link.h"
#include "framework/fly/telemetry_log.h"

namespace lapwing {

struct Arrival {
  std::vector<mavlink::Packet> packets;
  std::optional<double> tick;  // s
  bool end = false;            // the other side has left
  bool heard = false;          // something came, if only garbage
};

// Whether a datagram is a tick or an end, which it then notes.
bool take_tick(std::string_view datagram, Arrival& arrival);
std::string tick_of(double now);

class FlightWire {
 public:
  // Keeps a reference.
  FlightWire(Link& link, std::uint8_t system, std::uint8_t component);

  // From now on every packet is noted; `epoch`: us since 1970 at time 0.
  void begin_log(TelemetryLog& log, std::uint64_t epoch) { log_ = &log, epoch_ = epoch; }

  // Waits up to `timeout` s for the first datagram, and takes what else is there, up to a tick.
  // `now`: s, for the log.
  Arrival receive(double timeout, double now);
  void send(std::vector<mavlink::Packet> packets, double now);
  void send_tick(double now);
  void send_end();

  const mavlink::ParserCounts& counts() const { return parser_.counts(); }

 private:
  void note(const mavlink::Packet& packet, double now);

  Link& link_;
  std::uint8_t system_, component_, sequence_ = 0;
  TelemetryLog* log_ = nullptr;
  std::uint64_t epoch_ = 0;
  mavlink::PacketParser parser_;
};

}  // namespace lapwing
