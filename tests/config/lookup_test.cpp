// SPDX-License-Identifier: Apache-2.0
#include "framework/config/lookup.h"

#include <unistd.h>

#include <cstdlib>

#include "framework/config/shipped.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class LookupTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("lapwing_lookup_" + std::to_string(::getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    write_file_atomically(folder_ / "configs/solvers/ipopt.yaml", "solver: {type: ipopt}\n");
    write_file_atomically(folder_ / "configs/vehicles/solo.yaml", "mass: 1.5\n");
    write_file_atomically(folder_ / "configs/vehicles/racer.yaml", "mass: 0.8\n");
    write_file_atomically(folder_ / "own/mine.yaml", "a: 1\n");
    write_file_atomically(folder_ / "own/list.yaml", "[1, 2]\n");
  }
  void TearDown() override { fs::remove_all(folder_); }
  ConfigSearch search(bool any_path = true) const { return {{folder_ / "configs"}, any_path}; }
  std::string refusal(const std::string& name, bool any_path = true) const {
    try {
      read_config(name, search(any_path), {"shot.lua", 3});
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  fs::path folder_;
};

TEST_F(LookupTest, FindsNamesAndPathsWithOrWithoutExtension) {
  for (const char* name : {"solvers/ipopt", "solvers/ipopt.yaml"}) {
    EXPECT_EQ(find_config(name, search()), folder_ / "configs/solvers/ipopt.yaml");
    EXPECT_EQ(find_config(name, search(false)), folder_ / "configs/solvers/ipopt.yaml");
  }
  for (const char* name : {"own/mine", "own/mine.yaml"}) {
    EXPECT_EQ(find_config(folder_ / name, search()), folder_ / "own/mine.yaml");
  }
  EXPECT_EQ(read_config("vehicles/solo", search()).at("mass").origin(),
            (Origin{(folder_ / "configs/vehicles/solo.yaml").string(), 1}));
  const ConfigSearch two{{folder_ / "absent", folder_ / "own", folder_ / "configs"}};
  EXPECT_EQ(find_config("mine", two), folder_ / "own/mine.yaml");
}

TEST_F(LookupTest, NamesTheNearest) {
  const std::string searched = "; searched '" + (folder_ / "configs").string() + "'";
  EXPECT_EQ(
      refusal("vehicles/sollo"),
      "shot.lua:3: no configuration 'vehicles/sollo'; did you mean 'vehicles/solo'?" + searched);
  EXPECT_EQ(refusal("solo.yaml"),
            "shot.lua:3: no configuration 'solo.yaml'; did you mean 'vehicles/solo'?" + searched);
  EXPECT_EQ(refusal("vehicles/quadcopter"),
            "shot.lua:3: no configuration 'vehicles/quadcopter'; known: vehicles/racer, "
            "vehicles/solo" +
                searched);
  EXPECT_NE(refusal("").find("is empty"), std::string::npos);
  EXPECT_NE(refusal(folder_ / "own/list").find("expected keys and values, got a list"),
            std::string::npos);
}

TEST_F(LookupTest, KeepsScriptsInsideTheFolders) {
  for (const std::string& name :
       {std::string("../own/mine"), std::string("vehicles/../../own/mine"),
        (folder_ / "own/mine").string(), std::string("/etc/passwd")}) {
    EXPECT_NE(refusal(name, false).find("without '..'"), std::string::npos) << name;
  }
  fs::create_symlink(folder_ / "own/mine.yaml", folder_ / "configs/link.yaml");
  EXPECT_NE(refusal("link", false).find("a link that leaves"), std::string::npos);
}

TEST_F(LookupTest, ShippedFilesComeFromTheSourceTreeOrTheEnvironment) {
  ::unsetenv("LAPWING_HOME");
  EXPECT_TRUE(fs::equivalent(shipped_root(), LAPWING_SOURCE_DIR));
  ::setenv("LAPWING_HOME", folder_.c_str(), 1);
  EXPECT_EQ(shipped_root(), folder_);
  EXPECT_EQ(shipped_folder("configs"), folder_ / "configs");
  EXPECT_THROW(shipped_folder("scripts"), InputError);
  ::setenv("LAPWING_HOME", (folder_ / "own").c_str(), 1);
  EXPECT_THROW(shipped_root(), InputError);
  ::unsetenv("LAPWING_HOME");
}

}  // namespace
}  // namespace lapwing
