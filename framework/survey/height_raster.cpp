// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/height_raster.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/core/library_path.h"

extern char** environ;

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr double kPatience = 120;  // s without a byte

fs::path raster_program() {
  return library_folder() / "lapwing" / "lapwing_raster";
}

[[noreturn]] void fail_raster(const fs::path& file, const std::string& why) {
  throw InputError("'" + file.string() + "': " + why);
}

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

// What the program prints of the file.
std::string asked(const fs::path& file, const std::vector<std::string>& question) {
  if (!rasters_available())
    fail_raster(file,
                "Lapwing was built without GDAL, which reads rasters. On Debian, as root: "
                "apt-get install libgdal-dev, then build again (cmake --fresh --preset "
                "release)");
  std::error_code error;
  if (!fs::is_regular_file(file, error)) fail_raster(file, "it is no file that can be read");
  std::vector<std::string> words{raster_program().string(), question[0], file.string()};
  words.insert(words.end(), question.begin() + 1, question.end());
  Answer answer = answer_of(words);
  if (!answer.patient) fail_raster(file, "GDAL does not come back from it");
  const bool ended = WIFEXITED(answer.status);
  if (ended && WEXITSTATUS(answer.status) == 0) return std::move(answer.output);
  while (!answer.errors.empty() && answer.errors.back() == '\n') answer.errors.pop_back();
  if (ended && WEXITSTATUS(answer.status) == 2) fail_raster(file, answer.errors);
  fail_raster(file, "GDAL fails on it: it is damaged");
}

}  // namespace

bool rasters_available() {
  std::error_code error;
  return fs::is_regular_file(raster_program(), error);
}

RasterInfo raster_info(const fs::path& file) {
  const Value told = from_json(asked(file, {"info"}), "lapwing_raster");
  RasterInfo info;
  info.format = told.at("format").as_text();
  info.width = static_cast<int>(told.at("width").as_integer());
  info.height = static_cast<int>(told.at("height").as_integer());
  const Value::List& numbers = told.at("transform").as_list();
  Eigen::Matrix<double, 2, 3> matrix;
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column)
      matrix(row, column) = numbers[static_cast<std::size_t>(3 * row + column)].as_number();
  info.to_coordinates.linear() = matrix.rightCols<2>();
  info.to_coordinates.translation() = matrix.col(0);
  if (!(std::abs(info.to_coordinates.linear().determinant()) > 0))
    fail_raster(file, "its pixels have no area: its georeferencing is damaged");
  info.system = told.at("system").as_text();
  info.height_unit = told.at("height_unit").as_number();
  info.lowest = told.at("lowest").as_number();
  return info;
}

std::vector<float> raster_values(const fs::path& file, const RasterWindow& window) {
  const std::string bytes =
      asked(file, {"read", std::to_string(window.column), std::to_string(window.row),
                   std::to_string(window.width), std::to_string(window.height)});
  std::vector<float> values(static_cast<std::size_t>(window.width) *
                            static_cast<std::size_t>(window.height));
  if (bytes.size() != values.size() * sizeof(float))
    fail_raster(file, "GDAL read " + std::to_string(bytes.size()) + " bytes of " +
                          std::to_string(values.size() * sizeof(float)));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

}  // namespace lapwing
