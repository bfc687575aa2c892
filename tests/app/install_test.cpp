// SPDX-License-Identifier: Apache-2.0
// `lapwing` as a command: what README.md says of PATH and installing, typed as it stands there.
#include <sstream>

#include "tests/app/program_fixture.h"
#include "tests/guide.h"

namespace lapwing {
namespace {

class Installed : public CommandLine {
 protected:
  // The shell snippets of the README that hold `mark`, typed in a folder that links to this build;
  // but for `cmake --build`, which was before.
  int type(const std::string& mark, const std::string& after) {
    fs::create_directories(folder_ / "build");
    fs::create_symlink(LAPWING_BUILD_DIR, folder_ / "build/release");
    std::string script = "set -e\ncd '" + folder_.string() + "'\nexport HOME=\"$PWD/home\"\n";
    bool found = false;
    for (const Snippet& snippet : snippets_of(fs::path(LAPWING_SOURCE_DIR) / "README.md", "# ")) {
      if (snippet.language != "sh" || snippet.text.find(mark) == std::string::npos) continue;
      found = true;
      std::istringstream lines(snippet.text);
      for (std::string line; std::getline(lines, line);)
        if (line.rfind("cmake --build", 0) != 0) script += line + "\n";
    }
    EXPECT_TRUE(found) << "README.md has no snippet with " << mark;
    write("typed.sh", script + after + "\n");
    const int status = std::system(("bash '" + (folder_ / "typed.sh").string() + "' > '" +
                                    (folder_ / "log.txt").string() + "' 2>&1")
                                       .c_str());
    log_ = read_file(folder_ / "log.txt");
    return WEXITSTATUS(status);
  }

  std::string log_;
};

TEST_F(Installed, ThePathMakesItACommand) {
  EXPECT_EQ(type("export PATH=", "type lapwing\ncomplete -p lapwing"), 0) << log_;
  EXPECT_NE(log_.find("lapwing is "), std::string::npos) << log_;
  EXPECT_NE(log_.find("complete -F _lapwing lapwing"), std::string::npos) << log_;
}

TEST_F(Installed, AnInstallHasManualAndCompletions) {
  ASSERT_EQ(type("cmake --install", "cd home/.local && bin/lapwing plugins list > /dev/null"), 0)
      << log_;
  const fs::path share = folder_ / "home/.local/share";
  for (const char* file : {"man/man1/lapwing.1", "bash-completion/completions/lapwing",
                           "zsh/site-functions/_lapwing", "fish/vendor_completions.d/lapwing.fish"})
    EXPECT_FALSE(read_file(share / file).empty()) << file;
  EXPECT_NE(log_.find("lapwing "), std::string::npos);
}

}  // namespace
}  // namespace lapwing
