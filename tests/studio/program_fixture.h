// SPDX-License-Identifier: Apache-2.0
// The program itself, `lapwing studio`, started and stopped by tests.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/studio/option_path.h"
#include "framework/studio/patch.h"
#include "framework/trajectory/plan.h"
#include "framework/verify/certificate.h"
#include "tests/studio/page_client.h"

namespace lapwing {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

inline const fs::path kSource = LAPWING_SOURCE_DIR;
inline const std::string kProgram = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing";

// A process of the program, with its standard output.
class Started {
 public:
  Started(const fs::path& folder, std::vector<std::string> words) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    process = ::fork();
    if (process == 0) {
      ::dup2(ends[1], STDOUT_FILENO);
      const int errors =
          ::open((folder / "errors.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
      ::dup2(errors, STDERR_FILENO);
      std::vector<char*> pointers{const_cast<char*>(kProgram.c_str())};
      for (std::string& word : words) pointers.push_back(word.data());
      pointers.push_back(nullptr);
      if (::chdir(folder.c_str()) == 0) ::execv(kProgram.c_str(), pointers.data());
      ::_exit(98);
    }
    ::close(ends[1]);
    output_ = ends[0];
  }
  ~Started() {
    end(SIGKILL);
    ::close(output_);
  }
  Started(const Started&) = delete;
  // Up to the end of a line; "" at the end.
  std::string line() const {
    std::string text;
    for (char byte = 0; ::read(output_, &byte, 1) == 1 && byte != '\n';) text += byte;
    return text;
  }
  int end(int signal) {
    if (process <= 0) return status_;
    if (signal != 0) ::kill(process, signal);
    int status = 0;
    ::waitpid(process, &status, 0);
    process = -1;
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    return status_;
  }
  std::vector<pid_t> workers() const {
    std::ifstream list("/proc/" + std::to_string(process) + "/task/" + std::to_string(process) +
                       "/children");
    std::vector<pid_t> found;
    for (pid_t child; list >> child;) found.push_back(child);
    return found;
  }

  pid_t process = -1;

 private:
  int output_ = -1, status_ = -1;
};

class StudioProgram : public testing::Test {
 protected:
  void SetUp() override {
    static int count = 0;
    ::unsetenv("LAPWING_DATA");
    ::unsetenv("XDG_RUNTIME_DIR");
    folder_ = fs::temp_directory_path() /
              ("lapwing_studio_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    fs::create_directories(folder_ / "page");
    write_file_atomically(folder_ / "page/index.html", "<!doctype html>page");
    write_file_atomically(folder_ / "page/studio.js", "//");
  }
  void TearDown() override {
    server_.reset();
    fs::remove_all(folder_);
  }
  void use(const std::string& example) {
    script_ = fs::path(example).filename();
    fs::copy_file(kSource / "examples" / example, folder_ / script_);
  }
  StudioAddress serve(std::vector<std::string> more = {}) {
    std::vector<std::string> words{"studio", script_.string(), "--no-open", "--assets", "page"};
    words.insert(words.end(), more.begin(), more.end());
    server_.reset();
    server_ = std::make_unique<Started>(folder_, words);
    const std::string line = server_->line();
    if (line.empty()) throw std::runtime_error(read_file(folder_ / "errors.txt"));
    return StudioAddress(line);
  }
  // Runs to the end; what it says on standard error is in `errors_`.
  int run(std::vector<std::string> words) {
    Started program(folder_, std::move(words));
    const int status = program.end(0);
    errors_ = read_file(folder_ / "errors.txt");
    return status;
  }
  std::string journal() const {
    return read_file(folder_ / (script_.stem().string() + ".studio.journal"));
  }

  fs::path folder_, script_;
  std::unique_ptr<Started> server_;
  std::string errors_;
};

}  // namespace lapwing
