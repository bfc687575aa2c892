// SPDX-License-Identifier: Apache-2.0
// Completion in bash, zsh and fish, each run for real.
#include <array>
#include <cstring>

#include "framework/app/command_reference.h"
#include "framework/app/completion_names.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

class Completing : public CommandLine {
 protected:
  // Runs a shell's script in the test's folder; `lapwing` is the program.
  Finished shell(const std::string& program, const std::string& script) {
    write("script", script);
    const std::string line = "cd '" + folder_.string() +
                             "' && PATH='" LAPWING_BUILD_DIR "/bin':\"$PATH\" HOME=$PWD " +
                             program + " script > out.txt 2> err.txt";
    Finished finished;
    finished.status = WEXITSTATUS(std::system(line.c_str()));
    finished.out = read_file(folder_ / "out.txt");
    finished.err = read_file(folder_ / "err.txt");
    EXPECT_EQ(finished.err, "");
    return finished;
  }
  static bool installed(const std::string& program) {
    return std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) == 0;
  }

  // What each shell completes, one a line. The last of the words is the one being typed.
  std::string in_bash(const std::string& words) {
    return shell("bash", "source <(lapwing completion bash)\nCOMP_WORDS=(" + words +
                             ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_lapwing\nprintf "
                             "'%s\\n' \"${COMPREPLY[@]}\"")
        .out;
  }
  // As bash itself calls the function, with the words cut at its word breaks. What it would put in
  // place of the last piece.
  std::string in_bash_line(const std::string& line) {
    std::string pieces, piece;
    const auto end_piece = [&] {
      if (!piece.empty()) pieces += " '" + piece + "'";
      piece.clear();
    };
    for (const char c : line) {
      const bool breaks = c == '=' || c == ':';
      if (c == ' ' || breaks != (piece == "=" || piece == ":")) end_piece();
      if (c != ' ') piece += c;
    }
    const bool between = line.ends_with(" ");
    end_piece();
    return shell("bash", "source <(lapwing completion bash)\nCOMP_LINE='" + line +
                             "'\nCOMP_WORDS=(" + pieces + (between ? " ''" : "") +
                             ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_lapwing\nprintf "
                             "'%s\\n' \"${COMPREPLY[@]}\"")
        .out;
  }
  // The parts of zsh's completion system that the function calls print what they are given.
  std::string in_zsh(const std::string& words) {
    return shell("zsh -f",
                 "compdef() {}\ncompset() { words[CURRENT]=${words[CURRENT]#*=} }\n"
                 "compadd() { while [[ $1 != -- ]]; do shift; done; shift; for w in $@; do [[ $w "
                 "== ${words[CURRENT]}* ]] "
                 "&& print -r -- $w; done; return 0 }\n"
                 "_files() { print FILES $@ }\n"
                 "_describe() { for w in $offered; do [[ $w == ${words[CURRENT]}* ]] && print -r "
                 "-- ${w%%:*}; done; return 0 }\n"
                 "source <(lapwing completion zsh)\nwords=(" +
                     words + ")\nCURRENT=$#words\n_lapwing\n")
        .out;
  }
  std::string in_fish(const std::string& line) {
    return shell("fish",
                 "lapwing completion fish | source\n"
                 "complete -C \"" +
                     line + "\" | string replace -r '\\t.*' ''")
        .out;
  }

  // What every shell offers behind `words` for the beginning `typed`.
  static std::vector<std::array<const char*, 3>> cases() {
    return {{"lapwing run --config", "scan/s", "scan/small\n"},
            {"lapwing verify --vehicle", "vehicles/",
             "vehicles/crosswind\nvehicles/phantom\nvehicles/racer\nvehicles/racer_flown\n"
             "vehicles/solo\n"},
            {"lapwing plugins show", "cost_term/input", "cost_term/input_effort\n"},
            {"lapwing export --format", "cs", "csv\n"},
            {"lapwing evaluate explore --world", "sub", "suburb\n"},
            {"lapwing evaluate explore --utility", "proxi", "proximity_count\n"},
            {"lapwing train dataset --explorer", "orac", "oracle\n"},
            {"lapwing evaluate scan --method", "mil", "milp\n"},
            {"lapwing new plugin", "util", "utility\n"},
            {"lapwing new mission", "fi", "film\n"},
            {"lapwing map", "con", "convert\n"},
            {"lapwing --color", "al", "always\n"}};
  }
};

TEST_F(Completing, BashCompletesCommandsOptionsAndFiles) {
  ASSERT_EQ(run({"completion", "bash"}).status, 0);
  EXPECT_EQ(in_bash("lapwing ru"), "run\n");
  EXPECT_EQ(in_bash("lapwing map con"), "convert\n");
  EXPECT_EQ(in_bash("lapwing run --conf"), "--config\n");
  EXPECT_EQ(in_bash("lapwing --color a"), "auto\nalways\n");
  EXPECT_EQ(in_bash("lapwing --plugin-path run plug"), "plugins\n");
  EXPECT_EQ(in_bash("lapwing help sw"), "sweep\n");
  EXPECT_EQ(in_bash("lapwing completion f"), "fish\n");
  write("my shot.lua", "");
  EXPECT_EQ(in_bash("lapwing run my"), "my shot.lua\n");
  EXPECT_EQ(in_bash("lapwing run --out my"), "\n");  // no folder of that name
}

TEST_F(Completing, BashCompletesNames) {
  for (const auto& [words, typed, offered] : cases())
    EXPECT_EQ(in_bash(words + std::string(" ") + typed), offered) << words;
}

TEST_F(Completing, ZshCompletesNames) {
  if (!installed("zsh")) GTEST_SKIP() << "zsh is not installed";
  for (const auto& [words, typed, offered] : cases()) {
    std::string found = in_zsh(words + std::string(" ") + typed);
    // What takes a file as well asks zsh for files, behind the names.
    if (const std::string files = "FILES\n"; found.ends_with(files))
      found.resize(found.size() - files.size());
    EXPECT_EQ(found, offered) << words;
  }
}

TEST_F(Completing, FishCompletesNames) {
  if (!installed("fish")) GTEST_SKIP() << "fish is not installed";
  for (const auto& [words, typed, offered] : cases())
    EXPECT_EQ(in_fish(words + std::string(" ") + typed), offered) << words;
}

// Options of the mission that is typed, and the values that they may have.
TEST_F(Completing, SettingsAreThoseOfTheMission) {
  write("shot.lua", film(""));
  const std::string run_it = "lapwing run shot.lua --set";
  const std::vector<std::array<std::string, 2>> all = {
      {"weights.s", "weights.skewness=\nweights.smoothness=\nweights.speed=\n"},
      {"timing=g", "timing=given\n"},
      {"solver=", "solver=ipopt\nsolver=iqp\nsolver=nlopt\n"},
      {"solver.it", "solver.iterations=\n"},
      {"vehicle=vehicles/r", "vehicle=vehicles/racer\nvehicle=vehicles/racer_flown\n"},
      {"stretch=", "stretch=auto\n"},
      {"ste", "step=\n"}};
  for (const auto& [typed, offered] : all) {
    EXPECT_EQ(in_bash(run_it + " " + typed), offered);
    std::string whole;  // the word as bash has it where '=' does not end words
    for (std::size_t at = 0; at < offered.size(); at = offered.find('\n', at) + 1)
      whole += "--set=" + offered.substr(at, offered.find('\n', at) + 1 - at);
    EXPECT_EQ(in_bash("lapwing config shot.lua --seed 3 --set=" + typed), whole);
    if (installed("zsh")) {
      EXPECT_EQ(in_zsh(run_it + " " + typed), offered);
      EXPECT_EQ(in_zsh("lapwing sweep shot.lua --vary=" + typed), offered);
    }
    if (installed("fish")) {
      EXPECT_EQ(in_fish(run_it + " " + typed), offered);
    }
  }
  EXPECT_EQ(in_bash("lapwing run --set ti"), "\n") << "of no mission";
  EXPECT_EQ(in_bash("lapwing run absent.lua --set ti"), "\n");
  EXPECT_EQ(run({"complete", "setting", "shot.lua", "tim"}).out, "timing=\n");
}

// Bash cuts words at '=' and ':', and puts offers in place of the last piece.
TEST_F(Completing, BashPutsItsPiecesTogether) {
  write("shot.lua", film(""));
  EXPECT_EQ(in_bash_line("lapwing run --config=scan/s"), "scan/small\n");
  EXPECT_EQ(in_bash_line("lapwing verify --vehicle=vehicles/r"),
            "vehicles/racer\nvehicles/racer_flown\n");
  EXPECT_EQ(in_bash_line("lapwing run shot.lua --set timing=g"), "given\n");
  EXPECT_EQ(in_bash_line("lapwing run shot.lua --set timing="),
            "free\ngiven\npath_first\ntime_first\n");
  EXPECT_EQ(in_bash_line("lapwing run shot.lua --set=timing=g"), "given\n");
  EXPECT_EQ(in_bash_line("lapwing run shot.lua --set=weights.sk"), "weights.skewness=\n");
  EXPECT_EQ(in_bash_line("lapwing run shot.lua --set timing=given --qu"), "--quiet\n");
  EXPECT_EQ(in_bash_line("lapwing export --format="),
            "chan\ncolmap\ncsv\nedl\ngeojson\ngltf\ngpx\nkml\nlitchi\nmcap\npoly4d\nqgc_plan\nsrt\n"
            "waypoints\nwpml\n");
  write("a=b.lua", "");
  write("c:d.lua", "");
  EXPECT_EQ(in_bash_line("lapwing run a=b"), "b.lua\n");
  EXPECT_EQ(in_bash_line("lapwing run c:"), "d.lua\n");
  EXPECT_EQ(in_bash_line("lapwing ru"), "run\n");
}

// Files stand beside the names, and a name of another list does not.
TEST_F(Completing, FilesJoinTheNames) {
  write("scan.yaml", "");
  EXPECT_EQ(in_bash("lapwing run --config scan"), "scan/fused\nscan/room\nscan/small\nscan.yaml\n");
  EXPECT_EQ(in_bash("lapwing run --config vehicles/"), "\n");
  EXPECT_EQ(in_bash("lapwing plugins check cost_term/input"), "cost_term/input_effort\n");
  EXPECT_EQ(in_bash("lapwing evaluate explore --world wal"), "\n") << "a part of scenes";
}

TEST_F(Completing, ListsAreOfDeclaredOptionsAndHoldNames) {
  const CommandEntry tree = command_tree();
  for (const NamedValue& value : named_values()) {
    int found = 0;
    for (const CommandEntry* command : every_command(tree))
      for (const OptionEntry& option : command->options)
        found += (*value.command == '\0' || command->path == value.command) &&
                 option.names.back() == value.option && option.names_list == value.names;
    EXPECT_GT(found, 0) << value.command << " " << value.option;
    if (value.names == std::string(kSettings)) continue;  // of a mission
    EXPECT_FALSE(run({"complete", value.names}).out.empty()) << value.names;
  }
  refused({"complete", "moods"}, {"there is no list of names 'moods'", "vehicle", "world"});
  EXPECT_EQ(run({"help"}).out.find("\n  complete "), std::string::npos) << "for shells alone";
}

// Whatever a folder of plugins holds, a shell reads it as a name or not at all.
TEST_F(Completing, NoNameIsReadAsACommand) {
  const Finished finished = run({"complete", "plugin"});
  for (const char c : finished.out)
    EXPECT_TRUE(std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_-./+\n", c)) << c;
}

}  // namespace
}  // namespace lapwing
