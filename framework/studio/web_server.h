// SPDX-License-Identifier: Apache-2.0
// HTTP and WebSocket for pages of this machine, on one thread; nothing of missions is known here.
//
// It listens on 127.0.0.1 alone. A request whose Host is not exactly the server's address, or whose
// Origin is there and is another, is refused; a WebSocket needs the Origin, so that no page of
// another site reaches it. One request a connection; every size, count and rate has a limit.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "framework/studio/event_loop.h"

namespace lapwing {

// What a GET of a path gives.
struct WebContent {
  std::string type;  // "text/html"
  std::shared_ptr<const std::string> bytes;
  bool immutable = false;  // its path names its bytes
};

// A page that is connected.
class PageSocket {
 public:
  virtual ~PageSocket() = default;
  // Text frames, in order. A page that leaves too much unread is closed. What is `replaceable`
  // takes the place of another such text that has not been sent yet.
  virtual void send(std::shared_ptr<const std::string> text, bool replaceable = false) = 0;
  // Once what waits has been sent. No more is received.
  virtual void close(const std::string& why) = 0;
};

struct WebLimits {
  std::size_t connections = 64;       // at once
  std::size_t sockets = 16;           // pages at once
  std::size_t header = 8 << 10;       // bytes of a request
  std::size_t message = 1 << 20;      // bytes of a frame from a page
  double messages = 200;              // a second from a page; twice as many in a burst
  std::size_t waiting = 256 << 20;    // bytes that a page may leave unread
  std::chrono::seconds patience{10};  // for a request to be complete
};

struct WebHandlers {
  // Nothing: there is no such path. The path is the request's, not decoded; no part of it was
  // judged.
  std::function<std::optional<WebContent>(std::string_view path)> get;
  std::function<void(const std::shared_ptr<PageSocket>&)> opened;
  std::function<void(PageSocket&, std::string_view text)> received;
  std::function<void(PageSocket&)> closed;
};

class WebServer {
 public:
  // `port` 0 chooses one. WebSockets are at `socket_path`. InputError where the port is in use.
  WebServer(EventLoop& loop, std::uint16_t port, std::string socket_path, WebHandlers handlers,
            const WebLimits& limits = {});
  ~WebServer();
  std::uint16_t port() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

// The security headers of every answer, each line with its end.
std::string security_headers(std::uint16_t port);

}  // namespace lapwing
