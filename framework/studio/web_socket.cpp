// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/web_socket.h"

#include <deque>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

namespace lapwing {
namespace {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;
using Socket = asio::basic_stream_socket<asio::ip::tcp, asio::io_context::executor_type>;
using Stream = websocket::stream<Socket, false>;  // no compression
using Clock = std::chrono::steady_clock;

class WebSocket final : public PageSocket, public std::enable_shared_from_this<WebSocket> {
 public:
  WebSocket(EventLoop& loop, int descriptor, const std::string& head, const std::string& headers,
            const WebLimits& limits, const WebHandlers& handlers, std::function<void()> done)
      : stream_(Socket(static_cast<asio::io_context*>(loop.io())->get_executor(),
                       asio::ip::tcp::v4(), descriptor)),
        head_(head),
        limits_(limits),
        handlers_(handlers),
        done_(std::move(done)),
        allowed_(2 * limits.messages) {
    error_code ignored;
    stream_.next_layer().set_option(asio::ip::tcp::no_delay(true), ignored);
    stream_.read_message_max(limits.message);
    stream_.text(true);
    auto patience = websocket::stream_base::timeout::suggested(boost::beast::role_type::server);
    patience.handshake_timeout = limits.patience;
    stream_.set_option(patience);
    stream_.set_option(websocket::stream_base::decorator([headers](
                                                             websocket::response_type& response) {
      for (std::size_t at = 0; at < headers.size();) {
        const std::size_t colon = headers.find(": ", at), end = headers.find("\r\n", at);
        response.set(headers.substr(at, colon - at), headers.substr(colon + 2, end - colon - 2));
        at = end + 2;
      }
    }));
  }
  ~WebSocket() override { done_(); }

  void begin() {
    stream_.async_accept(asio::buffer(head_), [self = shared_from_this()](const error_code& error) {
      if (error) return;
      self->is_open_ = true;
      self->handlers_.opened(self);
      self->read();
    });
  }

  void send(std::shared_ptr<const std::string> text, bool replaceable) override {
    if (!is_open_ || closing_) return;
    const std::size_t under_way = writing_ ? 1 : 0;
    if (replaceable)
      for (std::size_t i = under_way; i < waiting_.size(); ++i) {
        if (!waiting_[i].replaceable) continue;
        waiting_bytes_ -= waiting_[i].text->size();
        waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
        break;
      }
    waiting_bytes_ += text->size();
    waiting_.push_back({std::move(text), replaceable});
    if (waiting_bytes_ > limits_.waiting) return end();
    if (!writing_) write();
  }

  void close(const std::string& why) override {
    if (!is_open_ || closing_) return;
    closing_ = true;
    reason_ = why.substr(0, 120);
    if (!writing_) shut();
  }

 private:
  struct Waiting {
    std::shared_ptr<const std::string> text;
    bool replaceable;
  };

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](const error_code& error, std::size_t) {
      if (error) return self->end();
      self->take();
    });
  }

  void take() {
    const auto bytes = buffer_.data();
    const std::string text(static_cast<const char*>(bytes.data()), bytes.size());
    buffer_.consume(buffer_.size());
    const bool is_text = stream_.got_text();
    if (!closing_ && !is_text) close("expected text frames");
    if (!closing_ && !may_speak()) close("too many messages");
    if (!closing_) handlers_.received(*this, text);
    if (is_open_) read();
  }

  // So many a second, twice as many at once.
  bool may_speak() {
    const Clock::time_point now = Clock::now();
    const double passed = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    allowed_ = std::min(2 * limits_.messages, allowed_ + passed * limits_.messages) - 1;
    return allowed_ >= 0;
  }

  void write() {
    writing_ = true;
    stream_.async_write(asio::buffer(*waiting_.front().text),
                        [self = shared_from_this()](const error_code& error, std::size_t) {
                          self->written(error);
                        });
  }

  void written(const error_code& error) {
    writing_ = false;
    waiting_bytes_ -= waiting_.front().text->size();
    waiting_.pop_front();
    if (error) return end();
    if (!waiting_.empty())
      write();
    else if (closing_)
      shut();
  }

  void shut() {
    stream_.async_close(websocket::close_reason(websocket::close_code::policy_error, reason_),
                        [self = shared_from_this()](const error_code&) { self->end(); });
  }

  void end() {
    if (!is_open_) return;
    is_open_ = false;
    error_code ignored;
    stream_.next_layer().close(ignored);
    handlers_.closed(*this);
  }

  Stream stream_;
  std::string head_;
  WebLimits limits_;
  WebHandlers handlers_;
  std::function<void()> done_;
  boost::beast::flat_buffer buffer_;
  std::deque<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::string reason_;
  bool is_open_ = false, writing_ = false, closing_ = false;
  double allowed_;
  Clock::time_point last_ = Clock::now();
};

}  // namespace

std::shared_ptr<PageSocket> accept_web_socket(EventLoop& loop, int descriptor,
                                              const std::string& head, const std::string& headers,
                                              const WebLimits& limits, const WebHandlers& handlers,
                                              std::function<void()> done) {
  auto socket = std::make_shared<WebSocket>(loop, descriptor, head, headers, limits, handlers,
                                            std::move(done));
  socket->begin();
  return socket;
}

}  // namespace lapwing
