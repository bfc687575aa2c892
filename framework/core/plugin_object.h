// SPDX-License-Identifier: Apache-2.0
// What every interface that plugins implement has: the name of the plugin that an object is of. So
// the kernel can say whose code it is in when that crashes, throws or does not come back.
//
//   in_plugin(*exporter, "write", [&] { return exporter->write(plan); });
#pragma once

#include "framework/core/active_call.h"
#include "framework/core/error.h"

namespace lapwing {

class PluginObject {
 public:
  // As `lapwing plugins check` takes it; null for an object that no registry made.
  const char* plugin_name() const { return plugin_name_; }
  // Kept as it is: see `lasting_text`.
  void set_plugin_name(const char* lasting) { plugin_name_ = lasting; }

 protected:
  ~PluginObject() = default;

 private:
  const char* plugin_name_ = nullptr;
};

// Runs `body`, which calls `object` and returns what that returns, as the call named `call` (a
// literal): marked (active_call.h), and what it throws told with the plugin's name (`call_plugin`).
// An object without a name is called as it is.
template <class Body>
decltype(auto) in_plugin(const PluginObject& object, const char* call, const Body& body,
                         CallLength length = CallLength::brief) {
  const ActiveCall mark(object.plugin_name(), call, length);
  if (!object.plugin_name()) return body();
  return call_plugin(object.plugin_name(), call, body);
}

}  // namespace lapwing
