// SPDX-License-Identifier: Apache-2.0
// Replays the small inputs that fuzzing starts from and what it once found.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <ostream>
#include <string>

#include "framework/core/files.h"
#include "tests/fuzz/reader_list.h"

namespace lapwing {

void PrintTo(const FuzzedReader& reader, std::ostream* out) {
  *out << reader.name;
}

namespace {

// Inputs that a reader has at least: those that it once had stay.
int fewest_inputs(const std::string& reader) {
  static const std::map<std::string, int> fewest{
      {"depth_reader", 11},       {"json_value", 8}, {"map_reader", 12},   {"mesh_reader", 19},
      {"orienteering_reader", 9}, {"override", 12},  {"plan_document", 5}, {"ply_reader", 6},
      {"png_reader", 7},          {"quantity", 8},   {"stick_log", 8},     {"yaml_value", 12}};
  const auto found = fewest.find(reader);
  return found == fewest.end() ? 5 : found->second;  // a new one: 5
}

class FuzzCorpus : public testing::TestWithParam<FuzzedReader> {};

TEST_P(FuzzCorpus, EveryInputIsTakenOrRefused) {
  const std::string folder = std::string(LAPWING_SOURCE_DIR "/tests/fuzz/") + GetParam().name;
  int count = 0;
  for (const auto& item : std::filesystem::directory_iterator(folder)) {
    const std::string bytes = read_file(item.path());
    SCOPED_TRACE(item.path());
    EXPECT_EQ(GetParam().fuzz(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()),
              0);
    ++count;
  }
  EXPECT_GE(count, fewest_inputs(GetParam().name)) << "too few inputs to start from";
}

INSTANTIATE_TEST_SUITE_P(Readers, FuzzCorpus, testing::ValuesIn(fuzzed_readers()),
                         [](const auto& reader) { return std::string(reader.param.name); });

// A fuzzer that is in no line of CMakeLists.txt would be replayed and never run.
TEST(FuzzList, HoldsEveryFuzzer) {
  const std::string list = read_file(LAPWING_SOURCE_DIR "/tests/fuzz/CMakeLists.txt");
  for (const FuzzedReader& reader : fuzzed_readers()) {
    const std::string line = std::string("\nlapwing_add_fuzzer(") + reader.name;
    const std::size_t at = list.find(line);
    ASSERT_NE(at, std::string::npos) << reader.name;
    EXPECT_TRUE(list[at + line.size()] == ' ' || list[at + line.size()] == ')') << reader.name;
  }
}

}  // namespace
}  // namespace lapwing
