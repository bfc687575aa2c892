// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/flight_wire.h"

#include <charconv>
#include <cmath>

namespace lapwing {
namespace {

constexpr std::string_view kTick = "LAPWING-TICK ";
constexpr int kMostDatagrams = 1000;  // in one call

std::uint64_t microseconds_of(double seconds) {
  return static_cast<std::uint64_t>(std::llround(std::max(0.0, seconds) * 1e6));
}

}  // namespace

bool take_tick(std::string_view datagram, Arrival& arrival) {
  if (!datagram.starts_with(kTick)) return false;
  datagram.remove_prefix(kTick.size());
  std::uint64_t time = 0;
  const auto [next, error] =
      std::from_chars(datagram.data(), datagram.data() + datagram.size(), time);
  if (error == std::errc{} && next == datagram.data() + datagram.size())
    arrival.tick = static_cast<double>(time) * 1e-6;
  else
    arrival.end = true;
  return true;
}

std::string tick_of(double now) {
  return std::string(kTick) + std::to_string(microseconds_of(now));
}

FlightWire::FlightWire(Link& link, std::uint8_t system, std::uint8_t component)
    : link_(link), system_(system), component_(component) {}

void FlightWire::note(const mavlink::Packet& packet, double now) {
  if (log_) log_->write(epoch_ + microseconds_of(now), bytes_of(packet));
}

Arrival FlightWire::receive(double timeout, double now) {
  Arrival arrival;
  for (int i = 0; i < kMostDatagrams; ++i) {
    const auto bytes = link_.receive(i == 0 ? timeout : 0);
    if (!bytes) break;
    arrival.heard = true;
    if (take_tick(*bytes, arrival)) break;
    for (mavlink::Packet& packet : parser_.read(*bytes, link_.source())) {
      note(packet, now);
      arrival.packets.push_back(packet);
    }
  }
  return arrival;
}

void FlightWire::send(std::vector<mavlink::Packet> packets, double now) {
  for (mavlink::Packet& packet : packets) {
    packet.system = system_, packet.component = component_, packet.sequence = sequence_++;
    link_.send(bytes_of(packet));
    note(packet, now);
  }
}

void FlightWire::send_tick(double now) {
  link_.send(tick_of(now));
}

void FlightWire::send_end() {
  link_.send(std::string(kTick) + "end");
}

}  // namespace lapwing
