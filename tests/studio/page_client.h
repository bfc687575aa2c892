// SPDX-License-Identifier: Apache-2.0
// A page without a browser: HTTP and WebSocket over plain sockets, so that what is sent is exactly
// what a test says.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

#include "framework/core/json.h"

namespace lapwing {

// "http://127.0.0.1:PORT/#TOKEN"
struct StudioAddress {
  int port = 0;
  std::string token;
  explicit StudioAddress(const std::string& text) {
    const std::size_t colon = text.rfind(':'), hash = text.find('#');
    port = std::stoi(text.substr(colon + 1));
    token = text.substr(hash + 1);
  }
  std::string host() const { return "127.0.0.1:" + std::to_string(port); }
};

class Connection {
 public:
  explicit Connection(int port) {
    descriptor_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_port = htons(static_cast<std::uint16_t>(port));
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int on = 1;
    ::setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (::connect(descriptor_, reinterpret_cast<sockaddr*>(&here), sizeof here) < 0) {
      ::close(descriptor_);
      throw std::runtime_error("no connection");
    }
  }
  ~Connection() { ::close(descriptor_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  // False where the other end is gone.
  bool write(const std::string& bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count =
          ::send(descriptor_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (count <= 0) return false;
      done += static_cast<std::size_t>(count);
    }
    return true;
  }
  // More bytes behind `buffer`; false at the end, or after so long.
  bool read(std::string& buffer, std::chrono::milliseconds patience) {
    pollfd waiting{descriptor_, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(patience.count())) <= 0) return false;
    char bytes[65536];
    const ssize_t count = ::recv(descriptor_, bytes, sizeof bytes, 0);
    if (count <= 0) return false;
    buffer.append(bytes, static_cast<std::size_t>(count));
    return true;
  }
  // Everything until the other end closes.
  std::string read_all() {
    std::string all;
    while (read(all, std::chrono::seconds(5))) {
    }
    return all;
  }

 private:
  int descriptor_;
};

// What the server answers to these bytes.
inline std::string answer_to(int port, const std::string& request) {
  Connection connection(port);
  connection.write(request);
  return connection.read_all();
}

inline std::string upgrade_request(const std::string& host, const std::string& origin,
                                   const std::string& path = "/session") {
  return "GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n" +
         (origin.empty() ? "" : "Origin: " + origin + "\r\n") +
         "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
}

class PageClient {
 public:
  static constexpr std::chrono::milliseconds kPatience{120000};

  explicit PageClient(int port) : connection_(port) {
    const std::string host = "127.0.0.1:" + std::to_string(port);
    connection_.write(upgrade_request(host, "http://" + host));
    std::size_t end;
    while ((end = buffer_.find("\r\n\r\n")) == buffer_.npos)
      if (!connection_.read(buffer_, kPatience)) throw std::runtime_error("no WebSocket");
    head_ = buffer_.substr(0, end);
    buffer_.erase(0, end + 4);
  }
  // Greets and takes the welcome.
  PageClient(const StudioAddress& address, const std::string& tab) : PageClient(address.port) {
    Value hello = Value::map();
    hello.set("type", "hello");
    hello.set("token", address.token);
    hello.set("tab", tab);
    hello.set("seen", 0);
    send(hello);
    welcome = until([](const Value& m) { return m.at("type") == Value("welcome"); });
    told_ = welcome.at("answer");
  }

  const std::string& head() const { return head_; }
  bool send(const Value& message) { return send_text(to_json(message, -1)); }
  bool send_text(const std::string& text, char opcode = 1) {
    return connection_.write(frame_of(text, opcode));
  }
  // One behind the other, with nothing between them.
  bool send_together(const std::string& first, const std::string& second) {
    return connection_.write(frame_of(first, 1) + frame_of(second, 1));
  }

  // The next message; null where the server closed the connection, or said nothing for so long.
  Value receive(std::chrono::milliseconds patience = kPatience) {
    std::string text;
    if (!receive_text(text, patience)) return {};
    return from_json(text, "server");
  }
  bool receive_text(std::string& message, std::chrono::milliseconds patience = kPatience) {
    for (;;) {
      while (buffer_.size() < 2)
        if (!connection_.read(buffer_, patience)) return false;
      const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(buffer_[i]); };
      std::size_t size = byte(1) & 0x7f, head = 2;
      const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
      while (buffer_.size() < head + more)
        if (!connection_.read(buffer_, patience)) return false;
      if (more > 0) {
        size = 0;
        for (std::size_t i = 0; i < more; ++i) size = size << 8 | byte(2 + i);
        head += more;
      }
      while (buffer_.size() < head + size)
        if (!connection_.read(buffer_, patience)) return false;
      const int opcode = byte(0) & 0x0f;
      const bool last = (byte(0) & 0x80) != 0;
      if (opcode == 8) {
        close_reason = size > 2 ? buffer_.substr(head + 2, size - 2) : "";
        return false;
      }
      if (opcode < 3) message += buffer_.substr(head, size);
      buffer_.erase(0, head + size);
      if (opcode < 3 && last) return true;
    }
  }

  // The first message that `wanted` takes; those before are dropped. Throws where none comes. An
  // answer that came before the page did is in the welcome: that is the first message.
  Value until(const std::function<bool(const Value&)>& wanted) {
    const Value told = std::exchange(told_, Value());
    if (!told.is_null() && wanted(told)) return told;
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < end) {
      Value message = receive();
      if (message.is_null()) throw std::runtime_error("the server closed: " + close_reason);
      if (wanted(message)) return message;
    }
    throw std::runtime_error("the server never said it");
  }
  Value until_type(const std::string& type) {
    return until([&](const Value& m) { return m.at("type") == Value(type); });
  }
  // Of the document: its last answer of this revision.
  Value until_judged(std::int64_t revision) {
    return until([&](const Value& m) {
      if (m.at("type") != Value("answer") || m.at("revision") != Value(revision)) return false;
      const std::string& grade = m.at("grade").as_text();
      return m.at("edit").is_null() && grade != "step" && grade != "converged";
    });
  }

  Value welcome;
  std::string close_reason;

 private:
  static std::string frame_of(const std::string& text, char opcode) {
    std::string frame(1, static_cast<char>(0x80 | opcode));
    const std::size_t size = text.size();
    const auto add = [&](int bytes) {
      for (int i = bytes - 1; i >= 0; --i) frame += static_cast<char>(size >> (8 * i));
    };
    if (size < 126) {
      frame += static_cast<char>(0x80 | size);
    } else if (size < 65536) {
      frame += static_cast<char>(0x80 | 126);
      add(2);
    } else {
      frame += static_cast<char>(0x80 | 127);
      add(8);
    }
    const char mask[4] = {0x12, 0x34, 0x56, 0x78};
    frame.append(mask, 4);
    for (std::size_t i = 0; i < size; ++i) frame += static_cast<char>(text[i] ^ mask[i % 4]);
    return frame;
  }

  Connection connection_;
  std::string head_, buffer_;
  Value told_;
};

// ---- messages -----------------------------------------------------------------------------------

inline Value page_says(const char* type) {
  Value message = Value::map();
  message.set("type", type);
  return message;
}

inline Value change(const std::string& path, Value value) {
  Value one = Value::map();
  one.set("path", path);
  one.set("value", std::move(value));
  return one;
}

inline Value gesture(const std::string& id, std::int64_t base, Value::List changes) {
  Value message = page_says("gesture");
  message.set("id", id);
  message.set("base", base);
  message.set("label", "label of " + id);
  message.set("patch", Value(std::move(changes)));
  return message;
}

inline Value preview(std::int64_t edit, Value::List changes) {
  Value message = page_says("preview");
  message.set("edit", edit);
  message.set("patch", Value(std::move(changes)));
  return message;
}

inline Value place(double x, double y, double z) {
  return Value(Value::List{x, y, z});
}

}  // namespace lapwing
