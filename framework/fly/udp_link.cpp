// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/udp_link.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr std::size_t kLargestDatagram = 65536;

// The first IPv4 address of a host.
sockaddr_in address_of(const LinkAddress& address) {
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.host.c_str(), nullptr, &wanted, &found) != 0 || !found)
    throw InputError(address.in_words() + ": no host '" + address.host +
                     "' with an address of IPv4");
  sockaddr_in result{};
  std::memcpy(&result, found->ai_addr, sizeof result);
  ::freeaddrinfo(found);
  result.sin_port = htons(static_cast<std::uint16_t>(address.port));
  return result;
}

bool loopback(const sockaddr_in& address) {
  return ntohl(address.sin_addr.s_addr) >> 24 == 127;
}

class UdpLink final : public Link {
 public:
  explicit UdpLink(const LinkAddress& address)
      : listens_(address.kind == LinkAddress::Kind::udp_listening), peer_(address_of(address)) {
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (socket_ < 0) throw InputError(address.in_words() + ": no socket: " + std::strerror(errno));
    known_ = !listens_;
    if (!listens_) return;
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&peer_), sizeof peer_) == 0) return;
    const int error = errno;
    ::close(socket_);
    if (error == EADDRINUSE)
      throw InputError(address.in_words() + ": another program listens at port " +
                       std::to_string(address.port) + "; end it, or use another port");
    throw InputError(address.in_words() + ": cannot listen there: " + std::strerror(error));
  }
  ~UdpLink() override { ::close(socket_); }
  UdpLink(const UdpLink&) = delete;
  UdpLink& operator=(const UdpLink&) = delete;

  // A datagram that nobody takes is lost, as any may be.
  void send(std::string_view bytes) override {
    if (!known_) return;
    (void)::sendto(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL,
                   reinterpret_cast<const sockaddr*>(&peer_), sizeof peer_);
  }

  std::optional<std::string> receive(double timeout) override {
    pollfd waiting{socket_, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(std::ceil(std::max(0.0, timeout) * 1000))) <= 0)
      return std::nullopt;
    buffer_.resize(kLargestDatagram);
    sockaddr_in from{};
    socklen_t length = sizeof from;
    const ssize_t got = ::recvfrom(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT,
                                   reinterpret_cast<sockaddr*>(&from), &length);
    if (got < 0) return std::nullopt;  // also that nobody listens there, yet
    if (!known_) peer_ = from, known_ = true;
    const bool ours =
        from.sin_addr.s_addr == peer_.sin_addr.s_addr && from.sin_port == peer_.sin_port;
    if (!ours) return std::nullopt;
    return buffer_.substr(0, static_cast<std::size_t>(got));
  }

  mavlink::Source source() const override { return mavlink::Source::datagram; }

  std::uint16_t port() const override {
    sockaddr_in own{};
    socklen_t length = sizeof own;
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &length);
    return ntohs(own.sin_port);
  }

 private:
  bool listens_, known_ = false;
  sockaddr_in peer_;
  int socket_ = -1;
  std::string buffer_;
};

}  // namespace

std::unique_ptr<Link> open_udp(const LinkAddress& address) {
  return std::make_unique<UdpLink>(address);
}

bool stays_here(const LinkAddress& address) {
  return address.kind == LinkAddress::Kind::serial || loopback(address_of(address));
}

}  // namespace lapwing
