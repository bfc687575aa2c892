// SPDX-License-Identifier: Apache-2.0
// Links to a vehicle: UDP and serial lines.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "framework/mavlink/packet_parser.h"

namespace lapwing {

// "udp:HOST:PORT" sends to a vehicle that listens; "udpin:HOST:PORT" listens at an address of this
// machine for a vehicle that sends, and answers the first that does; "serial:DEVICE:BAUD" opens a
// serial line with 8 bits, no parity, no flow control.
struct LinkAddress {
  enum class Kind { udp, udp_listening, serial };
  Kind kind = Kind::udp;
  std::string host;        // or the device
  std::uint32_t port = 0;  // or bits per second

  std::string in_words() const;
};

// Throws InputError, with the forms that there are, for another text, a port beyond 1 to 65535 or a
// speed that serial lines do not have.
LinkAddress link_address_from(const std::string& text);

class Link {
 public:
  virtual ~Link() = default;
  virtual void send(std::string_view bytes) = 0;
  // What came within `timeout` seconds; nothing where nothing did. Throws InputError where the line
  // is gone.
  virtual std::optional<std::string> receive(double timeout) = 0;
  virtual mavlink::Source source() const = 0;
  // The port that it listens at; 0 where it does not.
  virtual std::uint16_t port() const { return 0; }
};

// Throws InputError: a host that is not known, a port in use, a device that cannot be opened or is
// no serial line.
std::unique_ptr<Link> open_link(const LinkAddress& address);

// Whether what is sent stays in this machine. A serial line does not, but somebody plugged it in.
// Throws InputError for a host that is not known.
bool stays_here(const LinkAddress& address);

}  // namespace lapwing
