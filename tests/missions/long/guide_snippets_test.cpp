// SPDX-License-Identifier: Apache-2.0
// Maps, scans and explorations of the guides, run as they stand but for the small configuration of
// their kind. tests/app/snippets_test.cpp runs every other snippet.
#include <map>

#include "tests/app/program_fixture.h"
#include "tests/guide.h"

namespace lapwing {
namespace {

using SlowSnippets = CommandLine;

TEST_F(SlowSnippets, OfEveryReadmeRun) {
  const fs::path source(LAPWING_SOURCE_DIR);
  std::map<std::string, int> runs;  // of each kind
  for (const fs::path& file : guides_in(source)) {
    for (const Snippet& snippet : snippets_of(file, "# ")) {
      const std::string kind = slow_kind(snippet.text);
      if (snippet.language != "lua" || snippet.excerpt || kind.empty()) continue;
      const std::string where =
          file.lexically_relative(source).string() + ":" + std::to_string(snippet.line);
      write("snippet.lua", snippet.text);
      const std::string folder = "run_" + std::to_string(runs[kind]++) + kind;
      const Finished finished =
          run({"run", "snippet.lua", "--config", kind + "/small", "--out", folder});
      EXPECT_EQ(finished.status, 0) << where << "\n" << finished.out << finished.err;
      EXPECT_TRUE(fs::exists(folder_ / folder / "report.html")) << where;
      // A map is no plan, and is not certified. Several batteries are a fleet of plans.
      const bool fleet = fs::exists(folder_ / folder / "fleet.json");
      const char* result = kind == "mapping" ? "map.ot" : fleet ? "plan_1.json" : "plan.json";
      EXPECT_TRUE(fs::exists(folder_ / folder / result)) << where;
      if (kind == "mapping") continue;
      EXPECT_NE(finished.out.find(": certified"), std::string::npos) << where << finished.out;
    }
  }
  EXPECT_EQ(runs.size(), 3u) << "a kind has no snippet";
}

}  // namespace
}  // namespace lapwing
