// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/reader_program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "framework/core/error.h"
#include "framework/core/library_path.h"

extern char** environ;

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr double kPatience = 120;  // s without a byte

// Both ends of a pipe, closed at last.
struct Pipe {
  int ends[2] = {-1, -1};
  Pipe() {
    if (::pipe2(ends, O_CLOEXEC) != 0) throw Error("there can be no more pipes");
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_end(int which) {
    if (ends[which] >= 0) ::close(ends[which]);
    ends[which] = -1;
  }
};

struct Answer {
  std::string output, errors;
  bool patient = true;  // it answered in time
  int status = 0;
};

// What both pipes give until they end.
void read_both(Pipe& output, Pipe& errors, Answer& answer) {
  std::vector<char> buffer(1 << 18);
  while (output.ends[0] >= 0 || errors.ends[0] >= 0) {
    pollfd waiting[2] = {{output.ends[0], POLLIN, 0}, {errors.ends[0], POLLIN, 0}};
    const int ready = ::poll(waiting, 2, static_cast<int>(1000 * kPatience));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) {
      answer.patient = false;
      return;
    }
    for (int which = 0; which < 2; ++which) {
      if (waiting[which].fd < 0 || waiting[which].revents == 0) continue;
      const ssize_t count = ::read(waiting[which].fd, buffer.data(), buffer.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0)
        (which == 0 ? output : errors).close_end(0);
      else
        (which == 0 ? answer.output : answer.errors)
            .append(buffer.data(), static_cast<std::size_t>(count));
    }
  }
}

Answer answer_of(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  Pipe output, errors;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, output.ends[1], 1);
  posix_spawn_file_actions_adddup2(&actions, errors.ends[1], 2);
  pid_t process = 0;
  const int failed =
      ::posix_spawn(&process, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed) throw Error("'" + words[0] + "' cannot be started: " + std::strerror(failed));
  output.close_end(1);
  errors.close_end(1);
  Answer answer;
  read_both(output, errors, answer);
  if (!answer.patient) ::kill(process, SIGKILL);
  while (::waitpid(process, &answer.status, 0) < 0 && errno == EINTR) {
  }
  return answer;
}

}  // namespace

fs::path ReaderProgram::path() const {
  return library_folder() / "lapwing" / file;
}

bool ReaderProgram::is_installed() const {
  std::error_code error;
  return fs::is_regular_file(path(), error);
}

std::string answer_of_program(const ReaderProgram& program, const fs::path& file,
                              const std::vector<std::string>& question) {
  const auto fail = [&](const std::string& why) {
    throw InputError("'" + file.string() + "': " + why);
  };
  if (!program.is_installed())
    fail("Lapwing was built without " + program.library + ", which reads " + program.reads +
         ". On Debian, as root: apt-get install " + program.package +
         ", then build again (cmake --fresh --preset release)");
  std::error_code error;
  if (!fs::is_regular_file(file, error)) fail("it is no file that can be read");
  std::vector<std::string> words{program.path().string(), question[0], file.string()};
  words.insert(words.end(), question.begin() + 1, question.end());
  Answer answer = answer_of(words);
  if (!answer.patient) fail(program.library + " does not come back from it");
  const bool ended = WIFEXITED(answer.status);
  if (ended && WEXITSTATUS(answer.status) == 0) return std::move(answer.output);
  while (!answer.errors.empty() && answer.errors.back() == '\n') answer.errors.pop_back();
  if (ended && WEXITSTATUS(answer.status) == 2) fail(answer.errors);
  fail(program.library + " fails on it: it is damaged");
  return {};
}

}  // namespace lapwing
