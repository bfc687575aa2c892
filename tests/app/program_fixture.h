// SPDX-License-Identifier: Apache-2.0
// The program run as a process of its own, in a folder of the test's own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <thread>

#include "framework/core/files.h"

namespace lapwing {

namespace fs = std::filesystem;

struct Finished {
  int status = -1;
  std::string out, err;
};

class CommandLine : public ::testing::Test {
 protected:
  CommandLine() {
    static int count = 0;
    folder_ = fs::temp_directory_path() /
              ("lapwing_app_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    fs::create_directories(folder_);
    ::unsetenv("LAPWING_DATA");
  }
  ~CommandLine() override { fs::remove_all(folder_); }

  // Starts the program in the test's folder.
  pid_t start(const std::vector<std::string>& arguments) {
    const std::string program = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing";
    const pid_t child = ::fork();
    if (child != 0) return child;
    std::vector<char*> pointers = {const_cast<char*>(program.c_str())};
    for (const std::string& a : arguments) pointers.push_back(const_cast<char*>(a.c_str()));
    pointers.push_back(nullptr);
    if (::chdir(folder_.c_str()) != 0 || !std::freopen("stdout.txt", "w", stdout) ||
        !std::freopen("stderr.txt", "w", stderr)) {
      ::_exit(99);
    }
    ::execv(program.c_str(), pointers.data());
    ::_exit(98);
  }

  Finished finish(pid_t child) {
    Finished finished;
    int status = 0;
    ::waitpid(child, &status, 0);
    finished.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    finished.out = read_file(folder_ / "stdout.txt");
    finished.err = read_file(folder_ / "stderr.txt");
    fs::remove(folder_ / "stdout.txt");
    fs::remove(folder_ / "stderr.txt");
    return finished;
  }

  Finished run(const std::vector<std::string>& arguments) { return finish(start(arguments)); }

  // Waits until something holds; false after a minute, which no busy machine needs.
  static bool becomes(const std::function<bool()>& holds) {
    for (int i = 0; i < 3000 && !holds(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return holds();
  }

  // Waits until the started program says something on standard error.
  bool speaks() const {
    return becomes([&] {
      const fs::path errors = folder_ / "stderr.txt";
      return fs::exists(errors) && fs::file_size(errors) > 0;
    });
  }

  void write(const std::string& name, const std::string& text) {
    write_file_atomically(folder_ / name, text);
  }

  // What `lapwing run` refuses, `lapwing config` refuses in the same words: with every bad input of
  // these tests, unless it is one of an option that only `run` has.
  void judged_alike(std::vector<std::string> arguments, const Finished& of_run) {
    if (arguments.empty() || arguments[0] != "run") return;
    arguments[0] = "config";
    for (const std::string& word : arguments)
      if (word == "-o" || word == "--threads" || word.starts_with("--out")) return;
    std::erase_if(arguments, [](const std::string& word) {
      return word == "--quiet" || word == "--keep" || word == "--verbose";
    });
    std::string expected = of_run.err;
    const std::string command = "'lapwing run";
    for (std::size_t at = 0; (at = expected.find(command, at)) != std::string::npos;)
      expected.replace(at, command.size(), "'lapwing config");
    const Finished judged = run(arguments);
    EXPECT_EQ(judged.status, 2) << "lapwing config: " << judged.err;
    EXPECT_EQ(judged.err, expected) << "lapwing config";
  }

  // Bad input: exit 2, the fragments on standard error, nothing written. `of_run_alone`: for what
  // `config` does not look at, as it writes nothing.
  void refused(const std::vector<std::string>& arguments, const std::vector<std::string>& fragments,
               bool of_run_alone = false) {
    std::vector<fs::path> before, after;
    for (const auto& entry : fs::directory_iterator(folder_)) before.push_back(entry.path());
    const Finished finished = run(arguments);
    for (const auto& entry : fs::directory_iterator(folder_)) after.push_back(entry.path());
    EXPECT_EQ(finished.status, 2) << finished.err;
    EXPECT_EQ(finished.out, "");
    for (const std::string& fragment : fragments) {
      EXPECT_NE(finished.err.find(fragment), std::string::npos)
          << "expected: " << fragment << "\ngot: " << finished.err;
    }
    EXPECT_EQ(before.size(), after.size()) << "something was written";
    if (!of_run_alone) judged_alike(arguments, finished);
  }

  void refused_script(const std::string& text, const std::vector<std::string>& fragments) {
    write("shot.lua", text);
    refused({"run", "shot.lua"}, fragments);
  }

  static std::string film(const std::string& more) {
    return "local film = require 'mission.film'\n"
           "return film.shot {\n  keyframes = {\n    { position = {0, 0, 2} },\n"
           "    { position = {5, 0, 3} },\n  },\n  " +
           more + "\n}\n";
  }

  fs::path folder_;
};

}  // namespace lapwing
