// SPDX-License-Identifier: Apache-2.0
// What the program says of itself: help, errors of usage, completion, the manual, colour.
#include <regex>

#include "framework/app/command_reference.h"
#include "framework/core/json.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

class Helping : public CommandLine {
 protected:
  // Runs a shell's command in the test's folder; its output, and what it says wrong.
  Finished shell(const std::string& command) {
    Finished finished;
    const std::string whole = "cd '" + folder_.string() +
                              "' && PATH='" LAPWING_BUILD_DIR "/bin':\"$PATH\"; { " + command +
                              "\n} > out.txt 2> err.txt";
    write("command.sh", whole);
    finished.status =
        WEXITSTATUS(std::system(("bash '" + (folder_ / "command.sh").string() + "'").c_str()));
    finished.out = read_file(folder_ / "out.txt");
    finished.err = read_file(folder_ / "err.txt");
    return finished;
  }
  static bool installed(const std::string& program) {
    return std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) == 0;
  }
};

TEST_F(Helping, TheKeysOfLiveFlightsAreListed) {
  const CommandEntry tree = command_tree();
  for (const CommandEntry* command : every_command(tree)) {
    const bool keys =
        command->footer.find("space pauses, r resumes, a or q aborts") != std::string::npos;
    EXPECT_EQ(keys, command->path == "lapwing fly") << command->path;
  }
}

TEST_F(Helping, EveryCommandHasAnExampleDefaultsAndExitStatuses) {
  const CommandEntry tree = command_tree();
  int commands = 0;
  for (const CommandEntry* command : every_command(tree)) {
    ++commands;
    EXPECT_TRUE(std::regex_search(command->footer, std::regex("Examples?:\n  .*lapwing")))
        << command->path;
    EXPECT_NE(command->footer.find("Exit status: "), std::string::npos) << command->path;
    for (const OptionEntry& option : command->options) {
      if (option.positional || option.required || option.value.empty()) continue;
      EXPECT_NE(option.help.find("default"), std::string::npos)
          << command->path << " " << option.names.back() << ": " << option.help;
    }
  }
  EXPECT_GE(commands, 30);
  const Finished finished = run({"run", "--help"});
  EXPECT_NE(finished.out.find("Exit status: 0 done and certified"), std::string::npos)
      << finished.out;
}

TEST_F(Helping, HelpIsACommandToo) {
  EXPECT_EQ(run({"help", "map", "info"}).out, run({"map", "info", "--help"}).out);
  EXPECT_EQ(run({"help", "run"}).out, run({"run", "--help"}).out);
  EXPECT_EQ(run({"help"}).out, run({"--help"}).out);
  EXPECT_EQ(run({"version"}).out, run({"--version"}).out);
  refused({"help", "rnu"}, {"'lapwing' has no command 'rnu'; did you mean 'run'?"});
}

TEST_F(Helping, WrongWordsGetTheNearestRightOne) {
  refused({"run", "--conf", "x", "shot.lua"},
          {"'lapwing run' has no option '--conf'; did you mean '--config'?"});
  refused({"run", "shot.lua", "--confg=x"}, {"did you mean '--config'?"});
  refused({"map", "inof", "x"}, {"unknown command 'inof'; did you mean 'info'?"});
  refused({}, {"expected a command after 'lapwing':", "\n  run ", "plan a mission",
               "\n  completion ", "lapwing help COMMAND"});
  refused({"map"}, {"expected a command after 'lapwing map':", "\n  convert "});
  refused({"run", "--seed", "x", "shot.lua"}, {"--seed"});
  refused({"--color", "red", "version"}, {"expected auto, always or never, not 'red'"});
}

TEST_F(Helping, ErrorsBlameWhatIsWrong) {
  refused({"run", "missing.lua"}, {"lapwing: cannot read 'missing.lua': No such file"});
  refused({"run", folder_.string()}, {"lapwing: cannot read '" + folder_.string() + "': it is a"});
  write("shot.lua", film("name = 'hop',"));
  refused({"run", "shot.lua", "--set", "vehicle=vehicles/sola"},
          {"lapwing: --set vehicle=vehicles/sola: no configuration 'vehicles/sola'; did you mean "
           "'vehicles/solo'?"});
  write("mine.yaml", "step: 0.1\nvehicle: vehicles/sola\n");
  refused({"run", "shot.lua", "--config", "mine.yaml"},
          {"lapwing: mine.yaml:2: no configuration 'vehicles/sola'"});
  refused_script(film("vehicle = 'vehicles/sola',"), {"lapwing: shot.lua:", "'vehicles/sola'"});
  refused({"run", "shot.lua", "-o", std::string(300, 'a')}, {"File name too long"});
}

// What the mission found out repeats the check that failed: the longer sentence says both.
TEST_F(Helping, AFailureIsPrintedOnce) {
  write("shot.lua", film("name = 'hop', duration = 0.7,"));
  const auto count = [](const std::string& text, const std::string& part) {
    int found = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != text.npos; at += part.size()) ++found;
    return found;
  };
  const Finished finished = run({"run", "shot.lua"});
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.out.find("in a flight without the limits of the vehicle: keyframe_miss"),
            std::string::npos)
      << finished.out;
  EXPECT_EQ(count(finished.out, "keyframe_miss"), 1) << finished.out;
  // And which option decides how near is near enough.
  EXPECT_EQ(count(finished.out, "keyframes may be missed by 0.5 m: hard = METRES"), 1)
      << finished.out;
  const Finished quiet = run({"run", "shot.lua", "--quiet"});
  EXPECT_EQ(count(quiet.err, "keyframe_miss"), 1) << quiet.err;
}

TEST_F(Helping, NoColourInPipesUnlessAsked) {
  write("shot.lua", film("name = 'hop',"));
  EXPECT_EQ(run({"run", "shot.lua"}).out.find('\x1b'), std::string::npos);
  Finished finished = run({"--color", "always", "run", "shot.lua"});
  EXPECT_NE(finished.out.find("\x1b[32mcertified\x1b[0m"), std::string::npos) << finished.out;
  finished = run({"verify", "out/hop/plan.json", "--color", "always"});
  EXPECT_NE(finished.out.find("\x1b[32mpass   \x1b[0m"), std::string::npos) << finished.out;
  finished = run({"run", "shot.lua", "--color", "always", "--json"});
  EXPECT_EQ(finished.out.find('\x1b'), std::string::npos);
  // A terminal: the script's, whose output is a file again.
  if (!installed("script")) GTEST_SKIP() << "there is no 'script' to make a terminal";
  const auto on_terminal = [&](const std::string& before) {
    return shell(before + " script -qec 'lapwing run shot.lua' /dev/null").out;
  };
  EXPECT_NE(on_terminal("TERM=xterm").find("\x1b[32mcertified"), std::string::npos);
  EXPECT_EQ(on_terminal("NO_COLOR=1 TERM=xterm").find("\x1b[32m"), std::string::npos);
  EXPECT_EQ(on_terminal("TERM=dumb").find("\x1b[32m"), std::string::npos);
}

TEST_F(Helping, EscapeSequencesAreShownAsText) {
  write("shot.lua", "print('a\\27[31mb')\n" + film("name = 'hop',"));
  Finished finished = run({"run", "shot.lua"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_NE(finished.err.find("a\\x1b[31mb\n"), std::string::npos) << finished.err;
  EXPECT_NE(read_file(folder_ / "out/hop/run.log").find("a\\x1b[31mb"), std::string::npos);
  std::string plan = read_file(folder_ / "out/hop/plan.json");
  plan.replace(plan.find("\"hop\""), 5, "\"h\\u001b]0;pwned\\u0007op\"");
  write("named.json", plan);
  finished = run({"verify", "named.json"});
  EXPECT_EQ(finished.out.rfind("h\\x1b]0;pwned\\x07op: not certified\n", 0), 0u)  // it was changed
      << finished.out;
  // Keys, constraints and certificates of an edited plan.
  plan = read_file(folder_ / "out/hop/plan.json");
  plan.replace(plan.find("\"stretch\""), 9, "\"\\u001b[31mRED\\u001b[2J\": 1, \"stretch\"");
  plan.insert(plan.find("\"configuration\""),
              "\"constraints\": [{\"name\": \"\\u001b[32mgreen\", \"required\": true, "
              "\"operations\": [{\"op\": \"input\", \"block\": \"position\", \"component\": 0, "
              "\"later\": 0}], \"results\": [{\"of\": 0, \"upper\": -5}]}],\n  ");
  write("edited.json", plan);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"verify", "edited.json"},
        std::vector<std::string>{"export", "edited.json", "--format", "csv", "-o", "x.csv"}}) {
    finished = run(words);
    EXPECT_EQ(finished.status, 1) << finished.err;
    EXPECT_EQ((finished.out + finished.err).find('\x1b'), std::string::npos) << finished.err;
    EXPECT_NE((finished.out + finished.err).find("\\x1b[31mRED"), std::string::npos);
    EXPECT_NE((finished.out + finished.err).find("\\x1b[32mgreen"), std::string::npos);
  }
  write("bad.lua", "error('a\\27[2Jb')");
  refused({"run", "bad.lua"}, {"a\\x1b[2Jb"});
  refused({"run", "a\x1b[2J.lua"}, {"a\\x1b[2J.lua"});
  refused({"run", "shot.lua", "--\x1b[2J"}, {"--\\x1b[2J"});
}

TEST_F(Helping, TheManualIsWellFormed) {
  const Finished finished = run({"man"});
  for (const char* part : {".TH LAPWING 1", ".SS lapwing map convert", "\\-\\-resume",
                           ".SH EXIT STATUS", ".SH ENVIRONMENT"})
    EXPECT_NE(finished.out.find(part), std::string::npos) << part;
  if (!installed("groff")) GTEST_SKIP() << "groff is not installed";
  const Finished read =
      shell("lapwing man > lapwing.1 && groff -man -ww -Tutf8 lapwing.1 > page.txt");
  EXPECT_EQ(read.status, 0);
  EXPECT_EQ(read.err, "");
  EXPECT_NE(read_file(folder_ / "page.txt").find("lapwing sweep"), std::string::npos);
}

TEST_F(Helping, NamesOfPluginsAreUsable) {
  for (const char* name : {"class", "new", "double", "co_await", "xor_eq"})
    refused({"new", "plugin", "cost_term", name}, {"it is a keyword of C++", "my_"});
  refused({"new", "plugin", "cost_term", std::string(300, 'a')}, {"300 letters", "at most 64"});
  refused({"new", "mission", "film", std::string(300, 'a') + ".lua"}, {"File name too long"});
  EXPECT_EQ(run({"new", "plugin", "cost_term", std::string(64, 'a')}).status, 0);
}

TEST_F(Helping, AFolderOfOtherFilesStopsNoCommand) {
  write("mine/compile_commands.json", "[]");
  write("mine/notes.json", "not JSON");
  Finished finished = run({"--plugin-path", "mine", "plugins", "list"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.out.find("keyframe"), std::string::npos);
  EXPECT_NE(finished.err.find("notes.json"), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find("is not a plugin's sidecar"), std::string::npos) << finished.err;
}

}  // namespace
}  // namespace lapwing
