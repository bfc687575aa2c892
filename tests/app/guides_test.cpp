// SPDX-License-Identifier: Apache-2.0
// The guides, followed to the letter: files are saved under the name in their first line, commands
// are typed in the order in which they stand.
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

#include "tests/app/program_fixture.h"
#include "tests/guide.h"

namespace lapwing {
namespace {

class Guides : public CommandLine {
 protected:
  // Types every snippet of a guide in the test's folder. A line that begins with "! " is one that
  // the guide says is refused.
  void follow(const std::string& guide, int least_commands) {
    const std::string program = LAPWING_BUILD_DIR "/bin";
    std::string script =
        "set -e\ncd '" + folder_.string() + "'\nexport PATH='" + program + "':\"$PATH\"\n";
    int commands = 0, files = 0;
    for (const Snippet& snippet : snippets_of(fs::path(LAPWING_SOURCE_DIR) / guide, "# ")) {
      if (snippet.language == "sh") {
        std::istringstream lines(snippet.text);
        for (std::string line; std::getline(lines, line); ++commands) {
          const bool refused = line.rfind("! ", 0) == 0;
          const std::string typed = refused ? line.substr(2) : line;
          script +=
              "echo '$ '" + ("'" + replaced(typed) + "'") + "\n" +
              (refused ? "if " + typed + "; then echo 'not refused'; exit 9; fi\n" : typed + "\n");
        }
        continue;
      }
      const std::string mark = snippet.language == "lua" ? "-- " : "# ";
      const std::string first = snippet.text.substr(0, snippet.text.find('\n'));
      ASSERT_TRUE(first.rfind(mark, 0) == 0 && first.find('.') != std::string::npos)
          << guide << ": a snippet in " << snippet.language << " without a name:\n"
          << snippet.text;
      write(first.substr(mark.size()), snippet.text);
      ++files;
    }
    EXPECT_GE(commands, least_commands) << guide;
    write("guide.sh", script);
    const int status = std::system(("bash '" + (folder_ / "guide.sh").string() + "' > '" +
                                    (folder_ / "log.txt").string() + "' 2>&1")
                                       .c_str());
    log_ = read_file(folder_ / "log.txt");
    EXPECT_EQ(status, 0) << guide << ":\n" << log_;
  }

  // Within single quotes of a shell.
  static std::string replaced(const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result;
  }

  std::string log_;
};

TEST_F(Guides, OfScriptsHolds) {
  follow("scripts/README.md", 9);
  EXPECT_NE(log_.find("did you mean 'margin'?"), std::string::npos) << log_;
  for (const char* plan : {"out/tower", "out/walk", "out/round", "out/hop"})
    EXPECT_TRUE(fs::exists(folder_ / plan / "plan.json")) << plan;
  EXPECT_EQ(read_file(folder_ / "lapwing_annotations.lua").rfind("---@meta\n", 0), 0u);
}

TEST_F(Guides, OfConfigurationsHolds) {
  follow("configs/README.md", 9);
  const auto line_of = [&](const std::string& what) {
    const std::size_t at = log_.find(what);
    return at == std::string::npos ? "" : log_.substr(at, log_.find('\n', at) - at);
  };
  EXPECT_NE(line_of("  smoothness: ").find("smooth.yaml"), std::string::npos) << log_;
  EXPECT_NE(line_of("  camera: ").find("--set"), std::string::npos) << log_;
  EXPECT_NE(line_of("  effort: ").find("default"), std::string::npos) << log_;
  for (const char* kind : {"mission", "vehicle", "film"})
    EXPECT_TRUE(fs::exists(folder_ / (std::string(kind) + ".schema.json")));
}

// The command line's reference names every option of every command, and none that there is not.
TEST_F(Guides, TheSynopsisIsWhole) {
  const std::string text = read_file(fs::path(LAPWING_SOURCE_DIR) / "framework/app/README.md");
  const std::size_t begin = text.find("```\n") + 4;
  std::istringstream lines(text.substr(begin, text.find("```", begin) - begin));
  std::vector<std::string> synopses;
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("lapwing ", 0) == 0)
      synopses.push_back(line);
    else
      synopses.back() += line;
  ASSERT_GE(synopses.size(), 20u);
  const auto options_in = [](const std::string& where, const std::regex& pattern) {
    std::set<std::string> found;
    for (std::sregex_iterator at(where.begin(), where.end(), pattern), end; at != end; ++at)
      found.insert((*at)[1]);
    return found;
  };
  for (const std::string& synopsis : synopses) {
    std::smatch command;
    ASSERT_TRUE(std::regex_search(synopsis, command, std::regex("^lapwing ((?:[a-z]+ ?)+)")));
    std::istringstream words(command[1].str());
    std::vector<std::string> typed{std::istream_iterator<std::string>(words), {}};
    typed.push_back("--help");
    const Finished finished = run(typed);
    ASSERT_EQ(finished.status, 0) << synopsis;
    typed.pop_back();
    std::string usage = "Usage: lapwing";
    for (const std::string& word : typed) usage += " " + word;
    EXPECT_NE(finished.out.find(usage + " "), std::string::npos) << synopsis << finished.out;
    // An option's first name: "-o" of "-o,--output".
    std::set<std::string> known = options_in(finished.out, std::regex("\n  (-[a-z]|--[a-z-]+)"));
    known.erase("-h");
    EXPECT_EQ(options_in(synopsis, std::regex("(?:^|[ \\[])(-[a-z]|--[a-z-]+)")), known)
        << synopsis;
  }
}

// Its commands are typed in the tree: here in a folder of links to it, with this build.
TEST_F(Guides, OfContributorsHolds) {
  fs::create_directories(folder_ / "build");
  fs::create_symlink(LAPWING_BUILD_DIR, folder_ / "build/release");
  follow("CONTRIBUTING.md", 1);
  EXPECT_NE(log_.find("tests, 0 failed"), std::string::npos) << log_;
}

}  // namespace
}  // namespace lapwing
