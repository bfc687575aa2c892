// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/studio.h"

#include <sys/random.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>

#include "framework/core/error.h"
#include "framework/studio/address_memory.h"
#include "framework/studio/backdrop.h"
#include "framework/studio/embedded_page.h"
#include "framework/studio/layer_file.h"
#include "framework/studio/page_assets.h"
#include "framework/studio/session.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// 128 bits from the system, in hexadecimal.
std::string new_token() {
  unsigned char bytes[16];
  if (::getrandom(bytes, sizeof bytes, 0) != static_cast<ssize_t>(sizeof bytes))
    throw Error("the system gives no random numbers");
  std::string token;
  for (const unsigned char byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", byte);
    token += digits;
  }
  return token;
}

// None where the script's folder cannot be written; `why` then says so.
std::unique_ptr<Journal> open_journal(const fs::path& script, std::string& why) {
  const fs::path folder = script.has_parent_path() ? script.parent_path() : fs::path(".");
  if (::access(folder.c_str(), W_OK) != 0) {
    why = "the folder of the script cannot be written: edits would have no place";
    return nullptr;
  }
  return std::make_unique<Journal>(beside_script(script, ".studio.journal"));
}

// At the place of a studio of this script that was killed, where that is free, so that its pages
// find this one; else at the port that is asked for, with a token of its own. `place.token` must be
// known before anybody connects: on one thread nobody is heard before the loop runs.
std::unique_ptr<WebServer> listen(EventLoop& loop, std::uint16_t port, const WebHandlers& handlers,
                                  const AddressMemory& memory, std::string& token) {
  const std::optional<StudioPlace> before = memory.find();
  if (before && (port == 0 || port == before->port)) {
    try {
      auto server = std::make_unique<WebServer>(loop, before->port, "/session", handlers);
      token = before->token;
      return server;
    } catch (const InputError&) {  // somebody else's by now
    }
  }
  token = new_token();
  return std::make_unique<WebServer>(loop, port, "/session", handlers);
}

constexpr std::string_view kBlobs = "/blob/";

WebContent blob_content(std::shared_ptr<const std::string> bytes) {
  const bool picture = bytes->starts_with("\x89PNG");
  return {picture ? "image/png" : "application/octet-stream", std::move(bytes), true};
}

void watch_token(EventLoop& loop, const CancellationToken& token) {
  if (token.cancelled()) return loop.stop();
  loop.after(std::chrono::milliseconds(50), [&loop, &token] { watch_token(loop, token); });
}

}  // namespace

bool has_built_page() {
  return !embedded_page().empty();
}

void run_studio(const StudioSettings& settings, const CancellationToken& token,
                const std::function<void(const std::string& address)>& ready) {
  std::error_code code;
  if (!fs::is_regular_file(settings.script, code))
    throw InputError("there is no script '" + settings.script.string() + "'");
  if (!settings.backdrop.empty()) backdrop_look(settings.backdrop);  // what is wrong is said here
  const PageAssets assets =
      settings.assets.empty() ? PageAssets::built_in() : PageAssets::of_folder(settings.assets);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is an error to be told
  std::string why_not;
  std::unique_ptr<Journal> journal = open_journal(settings.script, why_not);
  // Behind the journal: that one studio alone has the script.
  const AddressMemory memory(settings.script);
  EventLoop loop;
  SessionSettings own;
  own.script = settings.script;
  own.backdrop = settings.backdrop;
  own.run_words = settings.run_words;
  own.laid = settings.laid;
  StudioSession session(loop, own, std::move(journal), why_not);
  WebHandlers handlers;
  handlers.get = [&](std::string_view path) -> std::optional<WebContent> {
    if (!path.starts_with(kBlobs)) return assets.find(path);
    auto bytes = session.blob(path.substr(kBlobs.size()));
    if (!bytes) return std::nullopt;
    return blob_content(std::move(bytes));
  };
  handlers.opened = [&](const std::shared_ptr<PageSocket>& page) { session.opened(page); };
  handlers.received = [&](PageSocket& page, std::string_view text) {
    session.received(page, text);
  };
  handlers.closed = [&](PageSocket& page) { session.closed(page); };
  std::string secret;
  const auto server = listen(loop, settings.port, handlers, memory, secret);
  session.set_token(secret);
  memory.keep({server->port(), secret});
  const auto link = [&](WorkerRole role) {
    return std::make_unique<WorkerLink>(
        loop, settings.worker,
        WorkerListener{[&session, role](Frame frame) { session.heard(role, std::move(frame)); },
                       [&session, role] { session.started(role); },
                       [&session, role](const std::string& why) { session.crashed(role, why); }});
  };
  const auto solver = link(WorkerRole::solver), checker = link(WorkerRole::checker),
             errands = link(WorkerRole::errands);
  session.begin(*solver, *checker, *errands);
  ready("http://127.0.0.1:" + std::to_string(server->port()) + "/#" + secret);
  watch_token(loop, token);
  loop.run();
  session.finish();
}

}  // namespace lapwing
