// SPDX-License-Identifier: Apache-2.0
// Whoever runs a mission hears of the files that it reads.
#include "framework/config/read_note.h"

#include <gmock/gmock.h>

#include <thread>
#include <vector>

namespace lapwing {
namespace {

using testing::ElementsAre;

TEST(ReadNotes, AreHeardByTheInnermostListenerOfTheThread) {
  std::vector<std::string> outer, inner;
  const auto into = [](std::vector<std::string>& heard) {
    return [&heard](const std::filesystem::path& file) { heard.push_back(file.string()); };
  };
  note_read("/nobody/listens");
  {
    const ReadListener first(into(outer));
    note_read("/data/a/../course.yaml");
    {
      const ReadListener second(into(inner));
      note_read("/data/map.ot");
    }
    std::thread([] { note_read("/other/thread"); }).join();
    note_read("/data/shot.json");
  }
  note_read("/nobody/listens");
  EXPECT_THAT(outer, ElementsAre("/data/course.yaml", "/data/shot.json"));
  EXPECT_THAT(inner, ElementsAre("/data/map.ot"));
}

}  // namespace
}  // namespace lapwing
