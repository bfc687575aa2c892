// Replays the small inputs that fuzzing starts from and what it once found.
#include <gtest/gtest.h>

#include <filesystem>

#include "framework/core/files.h"

// Each fuzzer's entry, renamed by the build.
extern "C" {
int fuzz_map_reader(const std::uint8_t* data, std::size_t size);
int fuzz_mesh_reader(const std::uint8_t* data, std::size_t size);
int fuzz_depth_reader(const std::uint8_t* data, std::size_t size);
}

namespace lapwing {
namespace {

void replay(int (*fuzzer)(const std::uint8_t*, std::size_t), const char* name, int least) {
  int count = 0;
  for (const auto& item :
       std::filesystem::directory_iterator(std::string(LAPWING_SOURCE_DIR "/tests/fuzz/") + name)) {
    const std::string bytes = read_file(item.path());
    EXPECT_EQ(fuzzer(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0)
        << item.path();
    ++count;
  }
  EXPECT_GE(count, least);
}

TEST(FuzzCorpus, MapReaderTakesOrRefusesEveryInput) {
  replay(fuzz_map_reader, "map_reader", 8);
}

TEST(FuzzCorpus, MeshReaderTakesOrRefusesEveryInput) {
  replay(fuzz_mesh_reader, "mesh_reader", 15);
}

TEST(FuzzCorpus, DepthReaderTakesOrRefusesEveryInput) {
  replay(fuzz_depth_reader, "depth_reader", 10);
}

}  // namespace
}  // namespace lapwing
