// SPDX-License-Identifier: Apache-2.0
#include "framework/plugin/registry.h"

#include <filesystem>
#include <fstream>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/log.h"
#include "framework/plugin/sidecar.h"
#include "tests/plugin/fixtures/fixture.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

const fs::path kFixtures = fs::path(LAPWING_BUILD_DIR) / "tests" / "plugin_fixtures";

// The message of the InputError that `body` throws; fails when it throws none.
template <class Body>
std::string refusal(Body&& body) {
  try {
    body();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return "";
}

#define EXPECT_SAYS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "said: " << (text)

// A folder of its own for each test, gone afterwards.
class RegistryTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("lapwing_registry_" + std::to_string(::getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Copies library and sidecar; the sidecar is written last, as the build does.
  void copy(const std::string& from, const std::string& name) {
    fs::copy_file(kFixtures / from / (name + ".so"), folder_ / (name + ".so"));
    fs::copy_file(kFixtures / from / (name + ".json"), folder_ / (name + ".json"));
  }
  Value sidecar(const std::string& name) {
    return from_json(read_file(folder_ / (name + ".json")), name);
  }
  // A sidecar for a broken library, as an honest build would have written it.
  void invent_sidecar(const std::string& name, const std::string& tag) {
    Value value = from_json(read_file(kFixtures / "whole" / "good.json"), "");
    value.set("library", name + ".so");
    value.set("abi_tag", tag);
    fs::copy_file(kFixtures / "broken" / (name + ".so"), folder_ / (name + ".so"));
    write_file_atomically(folder_ / (name + ".json"), to_json(value));
  }
  Registry registry() const { return Registry({folder_}); }

  fs::path folder_;
};

TEST_F(RegistryTest, ListsWithoutLoadingAndCreatesOnDemand) {
  copy("whole", "good");
  const Registry plugins = registry();
  ASSERT_EQ(plugins.entries().size(), 2u);
  EXPECT_EQ(plugins.entries()[0].name, "doubled");
  EXPECT_EQ(plugins.entries()[0].preset_of, "good");
  const PluginEntry& good = plugins.entries()[1];
  EXPECT_EQ(good.version, "1.2.0");
  EXPECT_EQ(good.reference, "none, (0.1)");
  EXPECT_EQ(good.abi_tag, kAbiTag);
  EXPECT_EQ(good.parameters.find("value")->unit, "m/s");
  // The path of the copy is in the process's maps only once something was created.
  const auto loaded = [&] {
    std::ifstream maps("/proc/self/maps");
    const std::string text((std::istreambuf_iterator<char>(maps)), {});
    return text.find(folder_.string()) != std::string::npos;
  };
  EXPECT_FALSE(loaded());
  EXPECT_EQ(plugins.extension("fixture", "good", "trainable"), nullptr);
  EXPECT_FALSE(loaded());
  EXPECT_EQ(plugins.create<Fixture>("good")->answer(), 42.0);
  EXPECT_TRUE(loaded());
  EXPECT_EQ(*static_cast<const int*>(plugins.extension("fixture", "good", "countable")), 7);
}

TEST_F(RegistryTest, ChecksParametersAndLaysPresetsUnderThem) {
  copy("whole", "good");
  const Registry plugins = registry();
  Value given = Value::map();
  given.set("value", "36 km/h");
  EXPECT_EQ(plugins.create<Fixture>("good", given)->answer(), 10.0);
  EXPECT_EQ(plugins.create<Fixture>("doubled", given)->answer(), 20.5);
  given.set("times", 3);
  EXPECT_EQ(plugins.create<Fixture>("doubled", given)->answer(), 30.5);
  Value wrong = Value::map();
  wrong.set("tims", Value(3)).with_origin({"shot.lua", 12});
  const std::string message =
      refusal([&] { plugins.create<Fixture>("good", wrong, "weights.good"); });
  EXPECT_EQ(message, "shot.lua:12: weights.good.tims: unknown key; did you mean 'times'?");
}

TEST_F(RegistryTest, NamesTheNearestOfUnknownNames) {
  copy("whole", "good");
  copy("whole", "throwing");
  const Registry plugins = registry();
  const std::string message = refusal([&] {
    plugins.find("fixture", "goood", Origin{"shot.lua", 3});
  });
  EXPECT_EQ(message,
            "shot.lua:3: unknown fixture 'goood'; did you mean 'good'?; "
            "known: doubled, good, throwing; --plugin-path FOLDER adds a folder of your "
            "plugins");
  EXPECT_SAYS(refusal([&] { plugins.find("cost_term", "good"); }), "its kind is fixture");
  EXPECT_SAYS(refusal([&] { plugins.find("cost_term", "x"); }), folder_.string());
  fs::remove(folder_ / "throwing.json");
  EXPECT_SAYS(refusal([&] { registry().find("fixture", "throwing"); }), "has no sidecar");
}

TEST_F(RegistryTest, RefusesAnotherAbiBeforeReadingDescriptors) {
  const std::string message = refusal([] { describe_library(kFixtures / "broken/other_abi.so"); });
  EXPECT_SAYS(message, "[lapwing 0; gcc 2]");
  EXPECT_SAYS(message, kAbiTag);
  EXPECT_SAYS(message, "rebuild the plugin");
  // The library's own tag counts, even if the sidecar claims another.
  invent_sidecar("other_abi", kAbiTag);
  EXPECT_SAYS(refusal([&] { registry().create<Fixture>("good"); }), "[lapwing 0; gcc 2]");
}

TEST_F(RegistryTest, RefusesAnotherAbiFromTheSidecarWithoutOpening) {
  invent_sidecar("no_symbol", "lapwing 1; clang 99");
  const Registry plugins = registry();  // still listed
  EXPECT_EQ(plugins.find("fixture", "good").abi_tag, "lapwing 1; clang 99");
  EXPECT_SAYS(refusal([&] { plugins.create<Fixture>("good"); }), "[lapwing 1; clang 99]");
}

TEST_F(RegistryTest, SaysWhyALibraryDoesNotOpen) {
  const fs::path broken = kFixtures / "broken";
  EXPECT_SAYS(refusal([&] { describe_library(broken / "no_symbol.so"); }),
              "no symbol 'lapwing_plugin_library'");
  EXPECT_SAYS(refusal([&] { describe_library(broken / "undefined_symbol.so"); }),
              "lapwing_fixture_absent_function");
  EXPECT_SAYS(refusal([&] { describe_library(broken / "absent.so"); }), "No such file");
  EXPECT_SAYS(refusal([&] { describe_library(broken / "bad_preset.so"); }), "vlaue");
  write_file_atomically(folder_ / "text.so", "not a library");
  EXPECT_SAYS(refusal([&] { describe_library(folder_ / "text.so"); }), "text.so");
  EXPECT_THROW(describe_library(broken / "throwing_library.so"), PluginError);
}

TEST_F(RegistryTest, ExceptionsOfAPluginEndTheCallNotTheHost) {
  copy("whole", "throwing");
  const Registry plugins = registry();
  const auto create = [&](const char* how) {
    Value given = Value::map();
    given.set("how", Value(how)).with_origin({"shot.lua", 4});
    plugins.create<Fixture>("throwing", given);
  };
  try {
    create("standard");
    FAIL() << "nothing was thrown";
  } catch (const PluginError& error) {
    EXPECT_STREQ(error.what(),
                 "plugin 'throwing' failed in create: index 7; try it alone: lapwing plugins check "
                 "throwing");
  }
  EXPECT_THROW(create("number"), PluginError);
  EXPECT_THROW(create("cancelled"), Cancelled);
  EXPECT_EQ(refusal([&] { create("input"); }), "shot.lua:4: not this one");
}

TEST_F(RegistryTest, RefusesTwoPluginsOfOneName) {
  copy("whole", "good");
  const fs::path other = kFixtures / "duplicate";
  const std::string message = refusal([&] { Registry({folder_, other}); });
  EXPECT_SAYS(message, (folder_ / "good.so").string());
  EXPECT_SAYS(message, (other / "duplicate.so").string());
  // One folder named twice holds no duplicate.
  EXPECT_EQ(Registry({folder_, folder_, folder_ / "."}).entries().size(), 2u);
}

TEST_F(RegistryTest, RefusesBrokenSidecars) {
  copy("whole", "good");
  const Value whole = sidecar("good");
  const auto expect_refused = [&](const Value& changed, const char* part) {
    write_file_atomically(folder_ / "good.json", to_json(changed));
    EXPECT_SAYS(refusal([&] { registry(); }), part);
  };
  Value changed = whole;
  changed.set("sidecar", 2);
  expect_refused(changed, "good.json:2");
  changed = whole;
  changed.set("library", "../good.so");
  expect_refused(changed, "plain file name");
  changed = whole;
  changed.find("plugins")->as_list()[0].set("name", "Good Plugin");
  expect_refused(changed, "snake_case");
  changed = whole;
  changed.find("plugins")->push_back(changed.at("plugins").as_list()[0]);
  expect_refused(changed, "twice");
  const std::string text = to_json(whole);
  write_file_atomically(folder_ / "good.json", text.substr(0, text.size() / 2));
  EXPECT_SAYS(refusal([&] { registry(); }), "invalid JSON");
}

// A folder of builds holds more than plugins; what is none of them stops nobody.
TEST_F(RegistryTest, LeavesOutWhatIsNoPlugin) {
  copy("whole", "good");
  write_file_atomically(folder_ / "notes.json", "{\"name\": \"notes\"}");
  write_file_atomically(folder_ / "list.json", "[1, 2");
  write_file_atomically(folder_ / "empty.json", "");
  Value gone = sidecar("good");
  gone.set("library", "gone.so");
  gone.find("plugins")->as_list()[0].set("name", "gone");
  gone.find("plugins")->as_list()[0].set("presets", Value::list());
  write_file_atomically(folder_ / "gone.json", to_json(gone));
  const logging::Capture capture;
  const Registry plugins = registry();
  EXPECT_EQ(plugins.entries().size(), 2u);
  for (const char* part : {"notes.json", "no key 'sidecar'", "list.json", "empty.json",
                           "gone.so', which does not exist", "left out"})
    EXPECT_SAYS(capture.text(), part);
  EXPECT_SAYS(refusal([&] { plugins.create<Fixture>("gone"); }), "only its sidecar does");
  EXPECT_NE(plugins.create<Fixture>("good"), nullptr);
}

TEST_F(RegistryTest, RefusesStaleSidecars) {
  copy("whole", "good");
  Value stale = sidecar("good");
  Value& plugin = stale.find("plugins")->as_list()[0];
  plugin.set("parameters", Value::list());
  plugin.set("presets", Value::list());
  write_file_atomically(folder_ / "good.json", to_json(stale));
  EXPECT_SAYS(refusal([&] { registry().create<Fixture>("good"); }), "rebuild the plugin");
  // Older than the library, it is found out when plugins are listed.
  const auto time = fs::last_write_time(folder_ / "good.so");
  fs::last_write_time(folder_ / "good.json", time - std::chrono::seconds(5));
  EXPECT_SAYS(refusal([&] { registry(); }), "in its present version");
  // Older, but true: a copied tree.
  fs::copy_file(kFixtures / "whole" / "good.json", folder_ / "good.json",
                fs::copy_options::overwrite_existing);
  fs::last_write_time(folder_ / "good.json", time - std::chrono::seconds(5));
  EXPECT_EQ(registry().entries().size(), 2u);
}

TEST_F(RegistryTest, SkipsAbsentFoldersAndDeepOnes) {
  copy("whole", "good");
  EXPECT_TRUE(Registry({folder_ / "absent"}).entries().empty());
  fs::create_directories(folder_ / "a" / "b" / "c");
  fs::rename(folder_ / "good.so", folder_ / "a" / "good.so");
  fs::rename(folder_ / "good.json", folder_ / "a" / "good.json");
  EXPECT_EQ(registry().entries().size(), 2u);
  fs::rename(folder_ / "a" / "good.so", folder_ / "a" / "b" / "good.so");
  fs::rename(folder_ / "a" / "good.json", folder_ / "a" / "b" / "good.json");
  EXPECT_TRUE(registry().entries().empty());
}

}  // namespace
}  // namespace lapwing
