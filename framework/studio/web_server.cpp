// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/web_server.h"

#include <unistd.h>

#include <list>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/rfc7230.hpp>

#include "framework/core/error.h"
#include "framework/studio/web_socket.h"

namespace lapwing {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;
using Socket = asio::basic_stream_socket<asio::ip::tcp, asio::io_context::executor_type>;
using Acceptor = asio::basic_socket_acceptor<asio::ip::tcp, asio::io_context::executor_type>;
using Timer = asio::basic_waitable_timer<std::chrono::steady_clock,
                                         asio::wait_traits<std::chrono::steady_clock>,
                                         asio::io_context::executor_type>;
using Request = http::request_parser<http::empty_body>;

std::string address_of(std::uint16_t port) {
  return "127.0.0.1:" + std::to_string(port);
}

bool asks_for_socket(const Request::value_type& request) {
  return http::token_list(request[http::field::connection]).exists("upgrade") &&
         boost::beast::iequals(request[http::field::upgrade], "websocket");
}

// Exactly one Host, which is ours, and no Origin but ours.
bool comes_from_here(const Request::value_type& request, std::uint16_t port, bool socket) {
  const auto hosts = request.equal_range(http::field::host);
  if (std::distance(hosts.first, hosts.second) != 1 || hosts.first->value() != address_of(port))
    return false;
  const auto origins = request.equal_range(http::field::origin);
  const auto count = std::distance(origins.first, origins.second);
  if (count == 0) return !socket;
  return count == 1 && origins.first->value() == "http://" + address_of(port);
}

}  // namespace

std::string security_headers(std::uint16_t port) {
  return "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; "
         "img-src 'self' blob: data:; font-src 'self'; connect-src 'self' ws://" +
         address_of(port) +
         "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n"
         "X-Content-Type-Options: nosniff\r\n"
         "X-Frame-Options: DENY\r\n"
         "Referrer-Policy: no-referrer\r\n"
         "Cross-Origin-Opener-Policy: same-origin\r\n"
         "Cross-Origin-Resource-Policy: same-origin\r\n";
}

struct WebServer::Impl : std::enable_shared_from_this<WebServer::Impl> {
  // One request.
  struct Connection {
    Connection(Socket connected, const WebLimits& limits)
        : socket(std::move(connected)), timer(socket.get_executor()) {
      parser.header_limit(static_cast<std::uint32_t>(limits.header));
      parser.body_limit(boost::none);
      parser.eager(false);
    }
    Socket socket;
    Timer timer;
    Request parser;
    std::string head, answer;
    std::size_t parsed = 0;  // bytes of the head
    char bytes[4096];
    std::shared_ptr<const std::string> body;
  };
  using Held = std::list<std::shared_ptr<Connection>>::iterator;

  Impl(EventLoop& the_loop, std::uint16_t port, std::string path, WebHandlers given,
       const WebLimits& most)
      : loop(the_loop),
        acceptor(static_cast<asio::io_context*>(the_loop.io())->get_executor()),
        socket_path(std::move(path)),
        handlers(std::move(given)),
        limits(most) {
    const asio::ip::tcp::endpoint here(asio::ip::address_v4::loopback(), port);
    acceptor.open(here.protocol());
    acceptor.set_option(asio::socket_base::reuse_address(true));
    error_code error;
    acceptor.bind(here, error);
    if (!error) acceptor.listen(32, error);
    if (error)
      throw InputError("--port " + std::to_string(port) + ": " +
                       (error == asio::error::address_in_use
                            ? "it is in use; name another, or leave --port out to have one chosen"
                            : "cannot be listened on: " + error.message()));
  }

  std::uint16_t port() const { return acceptor.local_endpoint().port(); }

  void accept() {
    acceptor.async_accept([self = shared_from_this()](const error_code& error, auto socket) {
      if (error == asio::error::operation_aborted || !self->acceptor.is_open()) return;
      if (!error && self->connections.size() < self->limits.connections)
        self->begin(Socket(std::move(socket)));
      self->accept();  // what there is no place for is closed
    });
  }

  void begin(Socket socket) {
    connections.push_front(std::make_shared<Connection>(std::move(socket), limits));
    const Held held = connections.begin();
    const auto connection = *held;
    connection->timer.expires_after(limits.patience);
    connection->timer.async_wait([connection](const error_code& error) {
      error_code ignored;
      if (!error) connection->socket.close(ignored);
    });
    read(held);
  }

  void read(Held held) {
    const auto connection = *held;
    connection->socket.async_read_some(
        asio::buffer(connection->bytes),
        [self = shared_from_this(), held](const error_code& error, std::size_t count) {
          if (error) return self->end(held);
          self->take(held, count);
        });
  }

  void take(Held held, std::size_t count) {
    Connection& connection = **held;
    connection.head.append(connection.bytes, count);
    error_code error;
    connection.parsed +=
        connection.parser.put(asio::buffer(connection.head) + connection.parsed, error);
    if (error == http::error::need_more && connection.head.size() <= limits.header)
      return read(held);
    if (error) return answer(held, "400 Bad Request", {});
    if (!connection.parser.is_header_done()) return read(held);
    respond(held);
  }

  void respond(Held held) {
    const Request::value_type& request = (*held)->parser.get();
    const std::string path(request.target());
    const bool socket = asks_for_socket(request);
    if (!comes_from_here(request, port(), socket)) return answer(held, "403 Forbidden", {});
    if (request.method() != http::verb::get) return answer(held, "405 Method Not Allowed", {});
    if (path == socket_path) {
      if (!socket) return answer(held, "426 Upgrade Required", {});
      if (sockets >= limits.sockets) return answer(held, "503 Service Unavailable", {});
      return upgrade(held);
    }
    const std::optional<WebContent> content = handlers.get(path);
    if (content)
      answer(held, "200 OK", *content);
    else
      answer(held, "404 Not Found", {});
  }

  void upgrade(Held held) {
    const auto connection = *held;
    connection->timer.cancel();
    error_code error;
    const int descriptor = connection->socket.release(error);
    connections.erase(held);
    if (error) return;
    ++sockets;
    open.push_back(accept_web_socket(loop, descriptor, connection->head, security_headers(port()),
                                     limits, handlers, [weak = weak_from_this()] {
                                       if (const auto self = weak.lock()) --self->sockets;
                                     }));
    std::erase_if(open, [](const auto& page) { return page.expired(); });
  }

  void answer(Held held, const std::string& status, const WebContent& content) {
    const auto connection = *held;
    connection->body = content.bytes;
    const std::size_t length = content.bytes ? content.bytes->size() : 0;
    connection->answer = "HTTP/1.1 " + status + "\r\nContent-Length: " + std::to_string(length) +
                         "\r\nConnection: close\r\nCache-Control: " +
                         (content.immutable ? "private, max-age=31536000, immutable" : "no-store") +
                         "\r\n" + security_headers(port());
    if (!content.type.empty()) connection->answer += "Content-Type: " + content.type + "\r\n";
    connection->answer += "\r\n";
    std::vector<asio::const_buffer> all{asio::buffer(connection->answer)};
    if (length > 0) all.push_back(asio::buffer(*connection->body));
    asio::async_write(connection->socket, all,
                      [self = shared_from_this(), held](const error_code&, std::size_t) {
                        error_code ignored;
                        (*held)->socket.shutdown(asio::socket_base::shutdown_both, ignored);
                        self->end(held);
                      });
  }

  void end(Held held) {
    (*held)->timer.cancel();
    connections.erase(held);
  }

  EventLoop& loop;
  Acceptor acceptor;
  std::string socket_path;
  WebHandlers handlers;
  WebLimits limits;
  std::list<std::shared_ptr<Connection>> connections;
  std::vector<std::weak_ptr<PageSocket>> open;
  std::size_t sockets = 0;
};

WebServer::WebServer(EventLoop& loop, std::uint16_t port, std::string socket_path,
                     WebHandlers handlers, const WebLimits& limits)
    : impl_(
          std::make_shared<Impl>(loop, port, std::move(socket_path), std::move(handlers), limits)) {
  impl_->accept();
}

WebServer::~WebServer() {
  error_code ignored;
  impl_->acceptor.close(ignored);
}

std::uint16_t WebServer::port() const {
  return impl_->port();
}

}  // namespace lapwing
