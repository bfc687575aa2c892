// SPDX-License-Identifier: Apache-2.0
#include <charconv>

#include "framework/core/error.h"
#include "framework/fly/link.h"

namespace lapwing {
namespace {

constexpr const char* kLinkForms =
    "expected udp:HOST:PORT, udpin:HOST:PORT or serial:DEVICE:BAUD, as in udp:127.0.0.1:14540 or "
    "serial:/dev/ttyACM0:57600";

// "HOST:NUMBER".
bool split_number(const std::string& rest, LinkAddress& address) {
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string::npos || colon == 0) return false;
  address.host = rest.substr(0, colon);
  const char* begin = rest.data() + colon + 1;
  const char* end = rest.data() + rest.size();
  const auto [next, error] = std::from_chars(begin, end, address.port);
  return error == std::errc{} && next == end && begin != end;
}

}  // namespace

LinkAddress link_address_from(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  LinkAddress address;
  if (kind == "udp")
    address.kind = LinkAddress::Kind::udp;
  else if (kind == "udpin")
    address.kind = LinkAddress::Kind::udp_listening;
  else if (kind == "serial")
    address.kind = LinkAddress::Kind::serial;
  else
    throw InputError("'" + text + "': " + kLinkForms);
  if (colon == std::string::npos || !split_number(text.substr(colon + 1), address))
    throw InputError("'" + text + "': " + kLinkForms);
  if (address.kind != LinkAddress::Kind::serial && (address.port < 1 || address.port > 65535))
    throw InputError("'" + text + "': a port lies between 1 and 65535");
  return address;
}

std::string LinkAddress::in_words() const {
  const char* name = kind == Kind::udp ? "udp:" : kind == Kind::serial ? "serial:" : "udpin:";
  return name + host + ":" + std::to_string(port);
}

}  // namespace lapwing
