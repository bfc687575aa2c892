// SPDX-License-Identifier: Apache-2.0
// A WebSocket that a request asked for. Internal to this room.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "framework/studio/web_server.h"

namespace lapwing {

// Takes over a connected socket whose request, `head`, asked for a WebSocket; `headers` are added
// to the answer. `done` is called once, when it is closed.
std::shared_ptr<PageSocket> accept_web_socket(EventLoop& loop, int descriptor,
                                              const std::string& head, const std::string& headers,
                                              const WebLimits& limits, const WebHandlers& handlers,
                                              std::function<void()> done);

}  // namespace lapwing
