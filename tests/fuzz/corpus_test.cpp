// Replays the small inputs that fuzzing starts from and what it once found.
#include <gtest/gtest.h>

#include <filesystem>

#include "framework/core/files.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace lapwing {
namespace {

TEST(FuzzCorpus, MapReaderTakesOrRefusesEveryInput) {
  int count = 0;
  for (const auto& item :
       std::filesystem::directory_iterator(LAPWING_SOURCE_DIR "/tests/fuzz/map_reader")) {
    const std::string bytes = read_file(item.path());
    EXPECT_EQ(LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                     bytes.size()),
              0)
        << item.path();
    ++count;
  }
  EXPECT_GE(count, 8);
}

}  // namespace
}  // namespace lapwing
