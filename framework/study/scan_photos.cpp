// SPDX-License-Identifier: Apache-2.0
#include "framework/study/scan_photos.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/parallel.h"
#include "framework/core/png.h"
#include "framework/geometry/stereo_depth.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr double kPhotoRange = 300;             // m, beyond which a photograph shows sky
constexpr const char* kMostFeatures = "2000";   // of an image: matching takes their square
constexpr useconds_t kColmapPatience = 20'000;  // between looks at a running program

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

// Runs a program with its output appended to `log`; its exit status.
int run_program(std::vector<std::string> words, const fs::path& log,
                const CancellationToken* cancellation) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::vector<char*> environment;
  static char platform[] = "QT_QPA_PLATFORM=offscreen";
  for (char** entry = environ; *entry; ++entry) {
    if (std::strncmp(*entry, "QT_QPA_PLATFORM=", 16) != 0) environment.push_back(*entry);
  }
  environment.push_back(platform);
  environment.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t child = 0;
  const int failed =
      ::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed) throw InputError(words[0] + ": " + std::strerror(failed));
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (cancellation && cancellation->cancelled()) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      throw Cancelled();
    }
    ::usleep(kColmapPatience);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

void run_colmap(const std::string& step, std::vector<std::string> options, const fs::path& folder,
                const CancellationToken* cancellation) {
  std::vector<std::string> words{"colmap", step};
  words.insert(words.end(), options.begin(), options.end());
  const fs::path log = folder / "colmap.log";
  if (run_program(std::move(words), log, cancellation) == 0) return;
  throw InputError("colmap " + step + " failed; see '" + log.string() + "'");
}

// A model's images.bin begins with how many images it has.
int images_in(const fs::path& model) {
  std::ifstream file(model / "images.bin", std::ios::binary);
  unsigned char bytes[8] = {};
  if (!file.read(reinterpret_cast<char*>(bytes), sizeof bytes)) return 0;
  std::uint64_t count = 0;
  for (int i = 7; i >= 0; --i) count = count << 8 | bytes[i];
  return static_cast<int>(std::min<std::uint64_t>(count, 1'000'000));
}

void take_photos(const MeshScene& surface, const std::vector<Pose>& cameras, const Pinhole& pinhole,
                 const fs::path& folder, int threads, const CancellationToken* cancellation) {
  parallel_for(cameras.size(), threads, [&](std::size_t i) {
    if (cancellation && cancellation->cancelled()) throw Cancelled();
    const GreyPicture grey = render_textured(surface, cameras[i], pinhole, kPhotoRange, 1);
    Picture picture{grey.width, grey.height, {}};
    for (const std::uint8_t value : grey.pixels) {
      picture.rgb.insert(picture.rgb.end(), 3, value);
    }
    char name[32];
    std::snprintf(name, sizeof name, "view_%04zu.png", i + 1);
    write_file_atomically(folder / name, encode_png(picture));
  });
}

}  // namespace

void require_colmap() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (::access((fs::path(folder) / "colmap").c_str(), X_OK) == 0) return;
  }
  throw InputError(
      "--photos needs the program colmap, which is not on the path: install Debian's "
      "package colmap, or leave --photos out");
}

Registered register_photos(const MeshScene& surface, const std::vector<Pose>& cameras,
                           const Pinhole& pinhole, const fs::path& folder, int threads,
                           const CancellationToken* cancellation) {
  fs::remove_all(folder);  // what an ended run left
  fs::create_directories(folder / "sparse");
  take_photos(surface, cameras, pinhole, folder / "images", threads, cancellation);
  const std::string database = (folder / "database.db").string();
  const std::string images = (folder / "images").string(), count = std::to_string(threads);
  // COLMAP's pixels count from the corner of the upper left one.
  const std::string camera = number(pinhole.focal_x) + "," + number(pinhole.focal_y) + "," +
                             number(pinhole.principal_x + 0.5) + "," +
                             number(pinhole.principal_y + 0.5);
  run_colmap("feature_extractor",
             {"--database_path", database, "--image_path", images, "--ImageReader.single_camera",
              "1", "--ImageReader.camera_model", "PINHOLE", "--ImageReader.camera_params", camera,
              "--SiftExtraction.use_gpu", "0", "--SiftExtraction.num_threads", count,
              "--SiftExtraction.max_num_features", kMostFeatures},
             folder, cancellation);
  run_colmap("exhaustive_matcher",
             {"--database_path", database, "--SiftMatching.use_gpu", "0",
              "--SiftMatching.num_threads", count},
             folder, cancellation);
  run_colmap("mapper",
             {"--database_path", database, "--image_path", images, "--output_path",
              (folder / "sparse").string(), "--Mapper.num_threads", count,
              "--Mapper.ba_refine_focal_length", "0", "--Mapper.ba_refine_extra_params", "0"},
             folder, cancellation);
  Registered result{.images = static_cast<int>(cameras.size())};
  for (const auto& model : fs::directory_iterator(folder / "sparse")) {
    const int registered = images_in(model.path());
    result.models += registered > 0;
    result.largest = std::max(result.largest, registered);
  }
  return result;
}

}  // namespace lapwing
