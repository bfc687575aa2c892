// SPDX-License-Identifier: Apache-2.0
// Commands that are lists of items, in one process or under mpirun.
#pragma once

#include <map>
#include <string>

#include "tests/app/program_fixture.h"
#include "tests/tool.h"

namespace lapwing {

class Items : public CommandLine {
 protected:
  Items() {
    write("yard.obj",
          "v 0 0 0\nv 12 0 0\nv 12 12 0\nv 0 12 0\nv 4 4 0\nv 7 4 0\nv 7 7 0\nv 4 7 0\n"
          "v 4 4 4\nv 7 4 4\nv 7 7 4\nv 4 7 4\nf 1 2 3 4\nf 9 10 11 12\nf 5 6 10 9\n"
          "f 6 7 11 10\nf 7 8 12 11\nf 8 5 9 12\n");
  }

  // An item takes a few milliseconds.
  std::string explore(const std::string& out, const std::string& more = "", int episodes = 6,
                      int steps = 1) const {
    return std::string(LAPWING_BUILD_DIR) +
           "/bin/lapwing evaluate explore --world yard.obj --utility frontier --threads 1 "
           "--episodes " +
           std::to_string(episodes) + " --steps " + std::to_string(steps) + " -o " + out + " " +
           more;
  }

  // Of a line of the shell, in the test's folder.
  Finished shell(const std::string& line) const {
    Finished finished;
    const int status =
        std::system(("cd '" + folder_.string() + "' && " + line + " > out.txt 2> err.txt").c_str());
    finished.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    finished.out = read_file(folder_ / "out.txt");
    finished.err = read_file(folder_ / "err.txt");
    return finished;
  }

  // Results, without times.
  std::map<std::string, std::string> bytes(const std::string& out) const {
    std::map<std::string, std::string> all;
    for (const auto& item : fs::recursive_directory_iterator(folder_ / out)) {
      const std::string name = item.path().lexically_relative(folder_ / out).string();
      if (item.is_regular_file() && !name.starts_with("times") && !name.starts_with("seconds"))
        all[name] = read_file(item.path());
    }
    return all;
  }
};

class MpiItems : public Items {
 protected:
  void SetUp() override {
    if (!fs::exists(LAPWING_BUILD_DIR "/lib/plugins/executors/mpi.json"))
      GTEST_SKIP() << "the executor mpi is not built; install libopenmpi-dev";
    if (tool_on_path({"mpirun"}).empty()) GTEST_SKIP() << "no mpirun; install openmpi-bin";
    ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  }
  static std::string mpirun(int ranks) {
    return "mpirun --oversubscribe -n " + std::to_string(ranks) + " ";
  }
};

}  // namespace lapwing
