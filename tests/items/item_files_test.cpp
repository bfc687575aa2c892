// SPDX-License-Identifier: Apache-2.0
// Shards, measured times, and what results were made from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <set>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/portable.h"
#include "framework/items/item_times.h"
#include "framework/items/prepared_groups.h"
#include "framework/items/shard.h"
#include "framework/items/statement.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

template <class Call>
std::string refusal_of(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Shards, AreAPartitionOfTheItems) {
  for (const std::size_t count : {1u, 2u, 7u, 50u}) {
    std::vector<int> owners(30, 0);
    for (std::size_t number = 1; number <= count; ++number)
      for (std::size_t item = 0; item < owners.size(); ++item)
        owners[item] += Shard{number, count}.has(item);
    EXPECT_EQ(owners, std::vector<int>(30, 1)) << count;
  }
}

TEST(Shards, AreReadFromArraysThatCountFromZeroOrOne) {
  EXPECT_EQ(read_shard("3/10").text(), "3/10");
  EXPECT_EQ(read_shard("10/10").text(), "10/10");
  EXPECT_EQ(read_shard("0/10").text(), "10/10");
  for (const char* text : {"3/2", "1/0", "0/0", "", "3", "/", "1/", "/2", "-1/2", "1/2x", "1 /2",
                           "1/2/3", "1/10000001", "99999999999999999999/3"})
    EXPECT_THAT(refusal_of([&] { read_shard(text); }), HasSubstr("--shard: expected K/N")) << text;
}

class ItemFiles : public testing::Test {
 protected:
  ItemFiles() : base_(fs::temp_directory_path() / ("lapwing_items_" + std::to_string(::getpid()))) {
    fs::remove_all(base_);
  }
  ~ItemFiles() override { fs::remove_all(base_); }
  fs::path base_;
};

TEST_F(ItemFiles, TimesOfShardsAreReadTogether) {
  const std::vector<Item> items{{"a b.json", 0, {"slow in x", "slow"}},
                                {"c.json", 0, {"slow in y", "slow"}},
                                {"d.json", 1, {"slow in z", "slow"}},
                                {"e.json", 1, {"fast"}}};
  EXPECT_EQ(ItemTimes::read(base_).expected(items), std::vector<double>(4, 1));
  {
    ItemTimesLog first(base_, ""), second(base_, "1_of_2");
    EXPECT_THAT(refusal_of([&] { ItemTimesLog(base_, "1_of_2"); }), HasSubstr("another process"));
    first.add("a b.json", {8, 2});
    second.add("c.json", {4, 0});
    second.add("of another list.json", {1000, 0});
  }
  // A damaged line, and one of a killed process.
  write_file_atomically(base_ / "times/items.2_of_2.txt", "nan 1 d.json\n-1 0 d.json\n7 \n3.5 0 ");
  const ItemTimes times = ItemTimes::read(base_);
  EXPECT_EQ(times.count(items), 2u);
  EXPECT_EQ(times.expected(items), (std::vector<double>{8, 4, 6, 6}));
  EXPECT_EQ(times.preparations(items, 2), (std::vector<double>{2, 2}));
}

TEST_F(ItemFiles, OtherVersionsMachinesAndInputsAreRefused) {
  Value statement = Value::map();
  statement.set("seed", 3);
  const Value mark = made_by("lapwing 1.0.0", statement);
  const fs::path file = base_ / "item.json";
  EXPECT_FALSE(has_item(file, mark));
  const auto refused = [&](const char* key, Value value) {
    Value other = mark;
    other.set(key, std::move(value));
    Value item = Value::map();
    item.set(kMadeByEntry, other);
    write_file_atomically(file, to_json(item));
    return refusal_of([&] { has_item(file, mark); });
  };
  EXPECT_EQ(refused("program", "lapwing 1.0.0"), "");
  EXPECT_THAT(refused("program", "lapwing 0.9.0"),
              HasSubstr("item.json' was made by lapwing 0.9.0, and this is lapwing 1.0.0"));
  EXPECT_THAT(refused("machine", "m68k"),
              testing::AllOf(HasSubstr("was made on another machine (m68k; this one is "),
                             HasSubstr("--portable")));
  EXPECT_THAT(refused("inputs", "0"), HasSubstr("from other inputs"));
  write_file_atomically(file, "{}");
  EXPECT_THAT(refusal_of([&] { has_item(file, mark); }), HasSubstr("does not state"));
  write_file_atomically(file, "{\"made");
  EXPECT_THAT(refusal_of([&] { has_item(file, mark); }), HasSubstr("delete it"));
}

TEST_F(ItemFiles, AStatementIsWrittenOnceAndCompared) {
  Value statement = Value::map();
  statement.set("seed", 3);
  statement.set("machine", machine_of_numbers());
  const fs::path file = base_ / "study.json";
  ItemOptions resume, gather, shard;
  resume.resume = gather.gather = true;
  shard.shard = Shard{1, 2};
  EXPECT_THAT(refusal_of([&] { open_statement(file, statement, gather, "study"); }),
              HasSubstr("--gather: there is no study in"));
  EXPECT_FALSE(fs::exists(file));
  open_statement(file, statement, shard, "study");
  for (const ItemOptions& options : {resume, gather, shard})
    open_statement(file, statement, options, "study");
  EXPECT_THAT(refusal_of([&] { open_statement(file, statement, {}, "study"); }),
              HasSubstr("continue it with --resume"));
  statement.set("seed", 4);
  EXPECT_THAT(refusal_of([&] { open_statement(file, statement, resume, "study"); }),
              HasSubstr("states another study: it has other inputs: seed; --resume continues"));
  statement.set("machine", "m68k");
  EXPECT_THAT(
      refusal_of([&] { open_statement(file, statement, shard, "study"); }),
      HasSubstr("it is of another machine (" + machine_of_numbers() + "; this one is m68k"));
}

TEST_F(ItemFiles, OneOfSeveralWritersCreatesAFile) {
  EXPECT_TRUE(create_file_atomically(base_ / "one", "first"));
  EXPECT_FALSE(create_file_atomically(base_ / "one", "second"));
  EXPECT_EQ(read_file(base_ / "one"), "first");
  EXPECT_EQ(std::distance(fs::directory_iterator(base_), fs::directory_iterator()), 1);
}

TEST(PreparedGroups, KeepTheLastGroupAndThoseInUse) {
  std::vector<std::size_t> prepared;
  PreparedGroups groups([&](std::size_t group) {
    prepared.push_back(group);
    if (group == 9) throw InputError("no");
    return std::make_shared<const std::size_t>(group);
  });
  double seconds = 0;
  auto first = groups.use(1, seconds);
  EXPECT_EQ(groups.use(1, seconds), first);
  EXPECT_EQ(prepared, std::vector<std::size_t>{1});
  groups.use(2, seconds);
  EXPECT_THAT(groups.held(), testing::ElementsAre(1, 2));
  first.reset();
  groups.use(3, seconds);
  EXPECT_THAT(groups.held(), testing::ElementsAre(3));
  for (int turn = 0; turn < 2; ++turn) EXPECT_THROW(groups.use(9, seconds), InputError);
  EXPECT_EQ(prepared, (std::vector<std::size_t>{1, 2, 3, 9, 9}));
}

TEST(Machine, IsOneLine) {
  const std::string& machine = machine_of_numbers();
  EXPECT_EQ(machine.find('\n'), machine.npos);
  EXPECT_THAT(machine, HasSubstr("glibc "));
  EXPECT_EQ(is_portable(), machine.ends_with("portable"));
}

}  // namespace
}  // namespace lapwing
