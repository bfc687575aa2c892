// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/journal.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <thread>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/studio/layer_file.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class StudioFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lapwing_studio_files_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    file_ = folder_ / "shot.studio.journal";
  }
  void TearDown() override { fs::remove_all(folder_); }

  static Value options() {
    return without_origins(from_json(R"({"margin": 0.5, "times": [1, 2]})", "test"));
  }
  // Adds so many gestures, each of its own margin.
  static StudioDocument write(Journal& journal, int count) {
    StudioDocument document = journal.document().value_or(StudioDocument(options()));
    if (!journal.document()) journal.begin(options());
    for (int i = 0; i < count; ++i) {
      Value next = document.current();
      next.set("margin", 1.0 + static_cast<double>(document.revision()));
      const HistoryEntry entry = document.entry_for(
          EntryKind::gesture, "id" + std::to_string(document.revision()), "label", next);
      journal.append(entry);
      document.add(entry);
    }
    return document;
  }
  void replace(const std::string& text) {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << text;
  }

  fs::path folder_, file_;
};

TEST_F(StudioFiles, AJournalTellsTheDocumentAgain) {
  {
    Journal journal(file_);
    EXPECT_FALSE(journal.document());
    write(journal, 3);
  }
  Journal again(file_);
  ASSERT_TRUE(again.document());
  EXPECT_EQ(again.document()->revision(), 3u);
  EXPECT_EQ(again.document()->current().at("margin").as_number(), 3);
  EXPECT_TRUE(again.document()->can_undo());
  EXPECT_EQ(again.document()->undone().at("margin").as_number(), 2);
  EXPECT_EQ(again.remark(), "");
  const std::size_t before = read_file(file_).size();
  write(again, 1);
  EXPECT_GT(read_file(file_).size(), before);
}

TEST_F(StudioFiles, AJournalWithoutAnEditGoesAway) {
  {
    Journal journal(file_);
    journal.begin(options());
    EXPECT_TRUE(fs::exists(file_));
  }
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(StudioFiles, AJournalIsOneProcessesAlone) {
  Journal journal(file_);
  EXPECT_THROW(Journal other(file_), InputError);
}

// One that ends takes its empty journal away; who opened that just before has the next one, with
// its name.
TEST_F(StudioFiles, AJournalThatGoesAwayIsNotHeld) {
  std::atomic<int> holders = 0, shared = 0, nameless = 0, held = 0;
  const auto work = [&] {
    for (int i = 0; i < 20000; ++i) {
      try {
        const Journal journal(file_);
        if (++holders > 1) ++shared;
        if (!fs::exists(file_)) ++nameless;
        ++held;
        --holders;
      } catch (const InputError&) {  // the other one has it
      }
    }
  };
  std::thread other(work);
  work();
  other.join();
  EXPECT_GT(held, 20);
  EXPECT_EQ(shared, 0);
  EXPECT_EQ(nameless, 0);
  EXPECT_FALSE(fs::exists(file_));
}

// At whatever byte the last line was cut off, all before it are there and the next ones are added.
TEST_F(StudioFiles, ALineThatWasCutOffIsDroppedAndSaid) {
  {
    Journal journal(file_);
    write(journal, 3);
  }
  const std::string whole = read_file(file_);
  const std::size_t last = whole.rfind('\n', whole.size() - 2) + 1;
  for (std::size_t cut = last + 1; cut < whole.size(); ++cut) {
    replace(whole.substr(0, cut));
    {
      Journal journal(file_);
      ASSERT_EQ(journal.document()->revision(), 2u) << cut;
      EXPECT_NE(journal.remark().find(std::to_string(cut - last) + " bytes"), std::string::npos);
      EXPECT_EQ(read_file(file_), whole.substr(0, last));
      write(journal, 2);
    }
    Journal journal(file_);
    ASSERT_EQ(journal.document()->revision(), 4u) << cut;
  }
  // A file system may leave zeros where the line was to be.
  replace(whole.substr(0, last) + std::string(100, '\0'));
  EXPECT_EQ(Journal(file_).document()->revision(), 2u);
}

TEST_F(StudioFiles, ADamagedJournalIsNamedWithItsLine) {
  {
    Journal journal(file_);
    write(journal, 3);
  }
  std::string text = read_file(file_);
  text[text.find('\n') + 5] = '#';
  replace(text);
  try {
    Journal journal(file_);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("line 2"), std::string::npos) << error.what();
  }
  EXPECT_EQ(read_file(file_), text);
}

// What no crash of a studio leaves is not taken for a line that was cut off.
TEST_F(StudioFiles, AFileThatIsNoJournalStaysAsItIs) {
  {
    Journal journal(file_);
    write(journal, 2);
  }
  const std::string whole = read_file(file_), first = whole.substr(0, whole.find('\n'));
  const auto stays = [&](const std::string& text, const std::string& line) {
    replace(text);
    try {
      const Journal journal(file_);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(line), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("move it away"), std::string::npos) << error.what();
    }
    EXPECT_EQ(read_file(file_), text);
  };
  stays("my notes", "line 1");
  stays("my notes\n", "line 1");
  stays("my notes\nmore of them", "line 1");
  stays(first, "line 1");
  stays(first.substr(0, first.size() / 2), "line 1");
  stays(first + "\nmy notes\n", "line 2");
  stays(whole + "my notes\n", "line 4");
  stays(whole + std::string(100, '\0') + "\n", "line 4");
  std::string newer = whole;
  newer.replace(newer.find("journal\":") + 9, 1, "9");
  stays(newer.substr(0, newer.find('\n') + 1), "line 1");
}

// A file may not grow: as with a full disk, what was written of the line is taken back.
TEST_F(StudioFiles, AFullDiskLeavesTheJournalAsItWas) {
  std::signal(SIGXFSZ, SIG_IGN);
  Journal journal(file_);
  StudioDocument document = write(journal, 2);
  const std::string before = read_file(file_);
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  for (const std::size_t room : {std::size_t{0}, std::size_t{1}, std::size_t{20}}) {
    const rlimit full{before.size() + room, old.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
    Value next = document.current();
    next.set("margin", 9);
    std::string why;
    try {
      journal.append(document.entry_for(EntryKind::gesture, "x", "", next));
    } catch (const InputError& error) {
      why = error.what();
    }
    ::setrlimit(RLIMIT_FSIZE, &old);
    EXPECT_NE(why.find("File too large"), std::string::npos) << why;
    EXPECT_EQ(read_file(file_), before);
  }
  Value next = document.current();
  next.set("margin", 9);
  journal.append(document.entry_for(EntryKind::gesture, "x", "", next));
  EXPECT_GT(read_file(file_).size(), before.size());
}

TEST_F(StudioFiles, LayersAreWrittenWholeAndKnowWhoWroteThem) {
  const fs::path script = folder_ / "shot.lua";
  EXPECT_EQ(beside_script(script, ".studio.yaml"), folder_ / "shot.studio.yaml");
  EXPECT_FALSE(read_layer(script));
  const Value layer = without_origins(from_json(
      R"({"margin": 1.5, "times": [3, 4], "a": {"b": "x: y #"}, "none": null, "l": [{"t": []}]})",
      "test"));
  write_layer(script, 7, layer, options());
  const std::string text = read_file(folder_ / "shot.studio.yaml");
  EXPECT_NE(text.find("# revision 7"), std::string::npos);
  EXPECT_NE(text.find("# times stands in place of the script's, sha256 "), std::string::npos);
  std::optional<LayerFile> file = read_layer(script);
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->as_written);
  EXPECT_TRUE(same_options(file->layer, layer));
  std::ofstream(folder_ / "shot.studio.yaml", std::ios::app) << "speed: 3\n";
  file = read_layer(script);
  EXPECT_FALSE(file->as_written);
  EXPECT_EQ(file->layer.at("speed").as_number(), 3);
  write_layer(script, 8, Value::map(), options());
  EXPECT_FALSE(fs::exists(folder_ / "shot.studio.yaml"));
  write_layer(script, 8, Value::map(), options());  // gone already
}

}  // namespace
}  // namespace lapwing
