// SPDX-License-Identifier: Apache-2.0
// check_plugin_folder FOLDER KIND NAME: whether a registry of that folder offers the plugin, and
// the plugin passes what its kind must pass.
#include <cstdio>

#include "framework/conformance/check.h"

int main(int count, char** arguments) {
  if (count != 4) return std::fprintf(stderr, "usage: FOLDER KIND NAME\n"), 2;
  try {
    const lapwing::Registry registry({arguments[1]});
    const auto results = lapwing::check_plugin(registry, registry.find(arguments[2], arguments[3]));
    bool fine = results.size() > 5;
    for (const lapwing::CheckResult& result : results) {
      const bool failed = result.outcome == lapwing::Outcome::failed;
      fine &= !failed;
      std::printf("%s %s %s\n", failed ? "FAILED" : "ok", result.name.c_str(),
                  result.message.c_str());
    }
    return fine ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
