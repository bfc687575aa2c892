// SPDX-License-Identifier: Apache-2.0
// Who may ask for what: requests as they come from other sites, and from those who mean harm.
#include "framework/studio/web_server.h"

#include <atomic>
#include <thread>

#include "framework/core/files.h"
#include "framework/studio/embedded_page.h"
#include "framework/studio/page_assets.h"
#include "tests/studio/page_client.h"

namespace lapwing {
namespace {

class Web : public testing::Test {
 protected:
  void serve(const WebLimits& limits = {}) {
    WebHandlers handlers;
    handlers.get = [](std::string_view path) -> std::optional<WebContent> {
      if (path != "/" && path != "/page.js") return std::nullopt;
      return WebContent{"text/javascript", std::make_shared<const std::string>("content"), false};
    };
    handlers.opened = [this](const std::shared_ptr<PageSocket>& page) {
      ++opened_;
      page_ = page;
    };
    handlers.received = [this](PageSocket& page, std::string_view text) {
      ++received_;
      if (text == "close") return page.close("because");
      page.send(std::make_shared<const std::string>(text));
    };
    handlers.closed = [this](PageSocket&) { ++closed_; };
    server_ = std::make_unique<WebServer>(loop_, 0, "/session", handlers, limits);
    port_ = server_->port();
    host_ = "127.0.0.1:" + std::to_string(port_);
    thread_ = std::thread([this] { loop_.run(); });
  }
  void TearDown() override {
    loop_.stop();
    if (thread_.joinable()) thread_.join();
  }
  // "200", ...
  std::string status(const std::string& request) {
    const std::string answer = answer_to(port_, request);
    return answer.size() < 12 ? "closed" : answer.substr(9, 3);
  }
  std::string get(const std::string& path, const std::string& more = "") {
    return status("GET " + path + " HTTP/1.1\r\nHost: " + host_ + "\r\n" + more + "\r\n");
  }
  static void wait_until(const std::function<bool()>& holds) {
    for (int i = 0; i < 500 && !holds(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_TRUE(holds());
  }

  EventLoop loop_;
  std::unique_ptr<WebServer> server_;
  std::thread thread_;
  int port_ = 0;
  std::string host_;
  std::atomic<int> opened_ = 0, received_ = 0, closed_ = 0;
  std::weak_ptr<PageSocket> page_;
};

TEST_F(Web, AnswersItsTableAndNothingElse) {
  serve();
  EXPECT_EQ(get("/"), "200");
  EXPECT_EQ(get("/page.js"), "200");
  for (const char* path : {"/page.js/", "/../page.js", "/..", "/%2e%2e/page.js", "//page.js", "/x",
                           "/page.js?x", "/./page.js", "/etc/passwd", "http://127.0.0.1/page.js",
                           "/page.js%00", "/PAGE.JS", "/blob/../../x"})
    EXPECT_EQ(get(path), "404") << path;
  EXPECT_EQ(get("/session"), "426");
  for (const char* method : {"POST", "PUT", "HEAD", "OPTIONS", "DELETE", "TRACE"})
    EXPECT_EQ(status(std::string(method) + " / HTTP/1.1\r\nHost: " + host_ + "\r\n\r\n"), "405");
  EXPECT_EQ(status("nonsense\r\n\r\n"), "400");
  EXPECT_EQ(status(std::string("\x16\x03\x01\x02\x00", 5) + std::string(100, 'x') + "\r\n\r\n"),
            "400");
}

TEST_F(Web, EveryAnswerForbidsWhatIsForeign) {
  serve();
  const std::string answer = answer_to(port_, "GET / HTTP/1.1\r\nHost: " + host_ + "\r\n\r\n");
  EXPECT_NE(answer.find("Content-Security-Policy: default-src 'none'; script-src 'self';"),
            std::string::npos);
  EXPECT_NE(answer.find("frame-ancestors 'none'"), std::string::npos);
  EXPECT_NE(answer.find("X-Content-Type-Options: nosniff\r\n"), std::string::npos);
  EXPECT_NE(answer.find("Cross-Origin-Resource-Policy: same-origin\r\n"), std::string::npos);
  EXPECT_EQ(answer.find("http://"), std::string::npos);
  EXPECT_EQ(answer.find("unsafe"), std::string::npos);
}

TEST_F(Web, AnotherHostOrOriginIsRefused) {
  serve();
  const std::string port = std::to_string(port_);
  for (const std::string& host : {std::string("localhost:") + port, std::string("127.0.0.1"),
                                  "evil.example:" + port, "127.0.0.1:" + port + ".evil.example",
                                  std::string("127.0.0.1:1"), "[::1]:" + port, std::string("")})
    EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n"), "403") << host;
  EXPECT_EQ(status("GET / HTTP/1.1\r\n\r\n"), "403");
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: " + host_ + "\r\nHost: " + host_ + "\r\n\r\n"), "403");
  EXPECT_EQ(get("/", "Origin: http://" + host_ + "\r\n"), "200");
  for (const std::string& origin : {std::string("https://evil.example"), "https://" + host_,
                                    "http://" + host_ + ".evil.example", std::string("null"),
                                    "http://" + host_ + "/", "http://localhost:" + port}) {
    EXPECT_EQ(get("/", "Origin: " + origin + "\r\n"), "403") << origin;
    EXPECT_EQ(status(upgrade_request(host_, origin)), "403") << origin;
  }
  // A browser always names it.
  EXPECT_EQ(status(upgrade_request(host_, "")), "403");
  EXPECT_EQ(status(upgrade_request("localhost:" + port, "http://" + host_)), "403");
  EXPECT_EQ(status(upgrade_request(host_, "http://" + host_, "/other")), "404");
  EXPECT_EQ(opened_, 0);
}

TEST_F(Web, RequestsThatAreTooLongOrNeverEndAreClosed) {
  WebLimits limits;
  limits.patience = std::chrono::seconds(1);
  serve(limits);
  EXPECT_EQ(get("/", "X: " + std::string(20000, 'x') + "\r\n"), "400");
  EXPECT_EQ(get("/" + std::string(20000, 'x')), "400");
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: "), "closed");
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(4));
  // In parts it is read all the same.
  Connection slow(port_);
  const std::string request = "GET / HTTP/1.1\r\nHost: " + host_ + "\r\n\r\n";
  for (const char byte : request) {
    ASSERT_TRUE(slow.write(std::string(1, byte)));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(slow.read_all().substr(9, 3), "200");
}

TEST_F(Web, ConnectionsAndPagesHaveALimit) {
  WebLimits limits;
  limits.connections = 4;
  limits.sockets = 2;
  serve(limits);
  std::vector<std::unique_ptr<PageClient>> pages;
  for (int i = 0; i < 2; ++i) pages.push_back(std::make_unique<PageClient>(port_));
  EXPECT_EQ(status(upgrade_request(host_, "http://" + host_)), "503");
  pages.pop_back();
  wait_until([&] { return closed_ == 1; });
  pages.push_back(std::make_unique<PageClient>(port_));  // its place is free again
  std::vector<std::unique_ptr<Connection>> idle;
  for (int i = 0; i < 4; ++i) idle.push_back(std::make_unique<Connection>(port_));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(get("/"), "closed");
  idle.clear();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(get("/"), "200");
}

TEST_F(Web, FramesGoBothWaysUncompressed) {
  serve();
  PageClient page(port_);
  EXPECT_EQ(page.head().find("permessage-deflate"), std::string::npos);
  EXPECT_NE(page.head().find("Content-Security-Policy"), std::string::npos);
  for (const std::size_t size : {std::size_t{1}, std::size_t{125}, std::size_t{126},
                                 std::size_t{65535}, std::size_t{65536}, std::size_t{1} << 20}) {
    ASSERT_TRUE(page.send_text(std::string(size, 'x')));
    std::string back;
    ASSERT_TRUE(page.receive_text(back)) << size;
    EXPECT_EQ(back.size(), size);
  }
}

TEST_F(Web, FramesThatAreTooLargeOrNoTextCloseThePage) {
  serve();
  {
    PageClient page(port_);
    page.send_text(std::string((1 << 20) + 1, 'x'));
    std::string back;
    EXPECT_FALSE(page.receive_text(back));
  }
  {
    PageClient page(port_);
    page.send_text("bytes", 2);
    std::string back;
    EXPECT_FALSE(page.receive_text(back));
    EXPECT_EQ(page.close_reason, "expected text frames");
  }
  {
    PageClient page(port_);
    page.send_text("\xff\xfe");  // not UTF-8
    std::string back;
    EXPECT_FALSE(page.receive_text(back));
  }
  EXPECT_EQ(received_, 0);
  wait_until([&] { return closed_ == 3; });
}

TEST_F(Web, WhoSaysTooMuchIsClosed) {
  WebLimits limits;
  limits.messages = 50;
  serve(limits);
  PageClient page(port_);
  for (int i = 0; i < 500; ++i)
    if (!page.send_text("x")) break;
  std::string back;
  while (page.receive_text(back)) back.clear();
  EXPECT_EQ(page.close_reason, "too many messages");
  EXPECT_LE(received_, 110);
  EXPECT_GE(received_, 99);
  EXPECT_EQ(get("/"), "200");
}

TEST_F(Web, WhoDoesNotReadIsClosed) {
  WebLimits limits;
  limits.waiting = 4 << 20;
  serve(limits);
  const PageClient page(port_);
  wait_until([&] { return opened_ == 1; });
  const auto text = std::make_shared<const std::string>(1 << 20, 'x');
  for (int i = 0; i < 40; ++i)
    loop_.post([this, text] {
      if (const auto open = page_.lock()) open->send(text);
    });
  wait_until([&] { return closed_ == 1; });
}

TEST_F(Web, OfReplaceableTextsTheNewestIsSent) {
  serve();
  PageClient page(port_);
  wait_until([&] { return opened_ == 1; });
  loop_.post([this] {
    const auto open = page_.lock();
    const auto text = [](const std::string& t) { return std::make_shared<const std::string>(t); };
    open->send(text("first"));  // under way
    for (int i = 0; i < 5; ++i) open->send(text("step " + std::to_string(i)), true);
    open->send(text("last"));
    open->close("done");
  });
  std::vector<std::string> heard;
  for (std::string one; page.receive_text(one); one.clear()) heard.push_back(one);
  EXPECT_EQ(heard, (std::vector<std::string>{"first", "step 4", "last"}));
  EXPECT_EQ(page.close_reason, "done");
}

TEST(PageFiles, AreAnExactTable) {
  namespace fs = std::filesystem;
  const fs::path folder =
      fs::temp_directory_path() / ("lapwing_page_files_" + std::to_string(::getpid()));
  fs::remove_all(folder);
  EXPECT_THROW(PageAssets::of_folder(folder), InputError);
  write_file_atomically(folder / "page/index.html", "index");
  write_file_atomically(folder / "page/parts/app.js", "app");
  write_file_atomically(folder / "page/key.pem", "secret");
  write_file_atomically(folder / "secret.js", "secret");
  fs::create_symlink(folder / "secret.js", folder / "page/linked.js");
  const PageAssets assets = PageAssets::of_folder(folder / "page");
  EXPECT_EQ(*assets.find("/")->bytes, "index");
  EXPECT_EQ(assets.find("/index.html")->type, "text/html; charset=utf-8");
  EXPECT_EQ(*assets.find("/parts/app.js")->bytes, "app");
  write_file_atomically(folder / "page/late.js", "late");
  for (const char* path : {"/key.pem", "/linked.js", "/late.js", "/../secret.js", "/parts",
                           "/parts/", "/parts/../index.html", "", "index.html"})
    EXPECT_FALSE(assets.find(path)) << path;
  write_file_atomically(folder / "page/parts/app.js", "newer");  // for who works on the page
  EXPECT_EQ(*assets.find("/parts/app.js")->bytes, "newer");
  fs::remove_all(folder);
  EXPECT_FALSE(assets.find("/parts/app.js"));
}

// What the build embeds is the files of the page, byte for byte; or nothing, which is said.
TEST(PageFiles, AreThoseThatTheBuildEmbeds) {
  if (embedded_page().empty()) {
    EXPECT_THROW(PageAssets::built_in(), InputError);
    return;
  }
  const PageAssets assets = PageAssets::built_in();
  for (const EmbeddedFile& file : embedded_page()) {
    const std::string on_disk = read_file(std::string(LAPWING_SOURCE_DIR) +
                                          "/framework/studio/page/dist" + std::string(file.path));
    EXPECT_TRUE(*assets.find(file.path)->bytes == on_disk) << file.path;
  }
}

TEST_F(Web, APortInUseIsSaid) {
  serve();
  EventLoop loop;
  try {
    WebServer other(loop, static_cast<std::uint16_t>(port_), "/session", {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("it is in use"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace lapwing
