// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/link_faults.h"

#include <algorithm>
#include <charconv>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr const char* kFaultForms =
    "expected lost=SHARE, late=S, noise=SHARE, gap=S[@T], jump=S[@T], takeover=T, unwell=T, "
    "refuse=arm|mode|fence|gimbal, estimate=bad, battery=PERCENT or offset=M";

[[noreturn]] void refuse_fault(const std::string& text) {
  throw InputError("--fault '" + text + "': " + kFaultForms);
}

double fault_number(const std::string& whole, std::string_view text, double least, double most) {
  double number = 0;
  const auto [next, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || next != text.data() + text.size()) refuse_fault(whole);
  if (!(number >= least && number <= most))
    throw InputError("--fault '" + whole + "': the number lies beyond its range");
  return number;
}

// "5@3": seconds, and when.
void read_event(const std::string& whole, std::string_view text, double least, double most,
                double& amount, double& at) {
  const std::size_t sign = text.find('@');
  amount = fault_number(whole, text.substr(0, sign), least, most);
  if (sign != std::string_view::npos) at = fault_number(whole, text.substr(sign + 1), 0, 1e6);
}

}  // namespace

void add_fault(const std::string& text, SimulatedFaults& faults) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) refuse_fault(text);
  const std::string key = text.substr(0, equals);
  const std::string_view value = std::string_view(text).substr(equals + 1);
  if (key == "lost")
    faults.lost = fault_number(text, value, 0, 1);
  else if (key == "late")
    faults.late = fault_number(text, value, 0, 60);
  else if (key == "noise")
    faults.noise = fault_number(text, value, 0, 1);
  else if (key == "gap")
    read_event(text, value, 0, 1e4, faults.gap, faults.gap_at);
  else if (key == "jump")
    read_event(text, value, -1e4, 1e4, faults.jump, faults.jump_at);
  else if (key == "takeover")
    faults.takeover_at = fault_number(text, value, 0, 1e6);
  else if (key == "unwell")
    faults.unwell_at = fault_number(text, value, 0, 1e6);
  else if (key == "battery")
    faults.battery = static_cast<int>(fault_number(text, value, 0, 100));
  else if (key == "offset")
    faults.offset = fault_number(text, value, -1e6, 1e6);
  else if (text == "refuse=arm")
    faults.refuse_arming = true;
  else if (text == "refuse=mode")
    faults.refuse_mode = true;
  else if (text == "refuse=fence")
    faults.refuse_fence = true;
  else if (text == "refuse=gimbal")
    faults.refuse_gimbal = true;
  else if (text == "estimate=bad")
    faults.lose_estimate = true;
  else
    refuse_fault(text);
}

FaultyChannel::FaultyChannel(const SimulatedFaults& faults, std::uint64_t seed)
    : faults_(faults), random_(seed) {}

void FaultyChannel::push(std::string bytes, double now, bool open) {
  // The same numbers are drawn whatever happens, so that faults do not change each other.
  const bool lost = random_.uniform() < faults_.lost;
  const bool damaged = random_.uniform() < faults_.noise;
  const double delay = faults_.late * random_.uniform();
  const auto place =
      static_cast<std::size_t>(random_.integer(0, static_cast<std::int64_t>(bytes.size()) - 1));
  if (!open || lost) return;
  if (damaged) bytes[place] = static_cast<char>(bytes[place] ^ 0x55);
  double arrives = now + delay;
  if (!waiting_.empty()) arrives = std::max(arrives, waiting_.back().arrives);
  waiting_.push_back({arrives, std::move(bytes)});
}

std::vector<std::string> FaultyChannel::pop(double now) {
  std::vector<std::string> arrived;
  while (!waiting_.empty() && waiting_.front().arrives <= now) {
    arrived.push_back(std::move(waiting_.front().bytes));
    waiting_.pop_front();
  }
  return arrived;
}

}  // namespace lapwing
