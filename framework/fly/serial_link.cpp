// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>

#include "framework/core/error.h"
#include "framework/fly/udp_link.h"

namespace lapwing {
namespace {

struct LineSpeed {
  std::uint32_t bits;  // per second
  speed_t speed;
};
constexpr LineSpeed kLineSpeeds[] = {{9600, B9600},     {19200, B19200},   {38400, B38400},
                                     {57600, B57600},   {115200, B115200}, {230400, B230400},
                                     {460800, B460800}, {921600, B921600}, {1500000, B1500000}};

speed_t speed_of(const LinkAddress& address) {
  std::string known;
  for (const LineSpeed& line : kLineSpeeds) {
    if (line.bits == address.port) return line.speed;
    known += (known.empty() ? "" : ", ") + std::to_string(line.bits);
  }
  throw InputError(address.in_words() + ": expected a speed of " + known + " bits per second");
}

class SerialLink final : public Link {
 public:
  explicit SerialLink(const LinkAddress& address) : name_(address.in_words()) {
    const speed_t speed = speed_of(address);
    file_ = ::open(address.host.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (file_ < 0)
      throw InputError(name_ + ": cannot open '" + address.host + "': " + std::strerror(errno));
    termios line{};
    const bool terminal = ::tcgetattr(file_, &line) == 0;
    ::cfmakeraw(&line);
    line.c_cflag |= CLOCAL | CREAD;
    line.c_cflag &= static_cast<tcflag_t>(~CRTSCTS);
    if (terminal && ::cfsetspeed(&line, speed) == 0 && ::tcsetattr(file_, TCSANOW, &line) == 0)
      return;
    ::close(file_);
    throw InputError(name_ + ": '" + address.host + "' is no serial line");
  }
  ~SerialLink() override { ::close(file_); }
  SerialLink(const SerialLink&) = delete;
  SerialLink& operator=(const SerialLink&) = delete;

  // What a full line does not take at once is lost: an old setpoint is worth nothing.
  void send(std::string_view bytes) override {
    if (::write(file_, bytes.data(), bytes.size()) < 0 && errno != EAGAIN) gone();
  }

  std::optional<std::string> receive(double timeout) override {
    pollfd waiting{file_, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(std::ceil(std::max(0.0, timeout) * 1000))) <= 0)
      return std::nullopt;
    char buffer[4096];
    const ssize_t got = ::read(file_, buffer, sizeof buffer);
    if (got > 0) return std::string(buffer, static_cast<std::size_t>(got));
    if (got == 0 || (errno != EAGAIN && errno != EINTR)) gone();
    return std::nullopt;
  }

  mavlink::Source source() const override { return mavlink::Source::stream; }

 private:
  [[noreturn]] void gone() const { throw InputError(name_ + ": the line is gone"); }
  std::string name_;
  int file_ = -1;
};

}  // namespace

std::unique_ptr<Link> open_serial(const LinkAddress& address) {
  return std::make_unique<SerialLink>(address);
}

std::unique_ptr<Link> open_link(const LinkAddress& address) {
  return address.kind == LinkAddress::Kind::serial ? open_serial(address) : open_udp(address);
}

}  // namespace lapwing
