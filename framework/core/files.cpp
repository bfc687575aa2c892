// SPDX-License-Identifier: Apache-2.0
#include "framework/core/files.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <thread>

#include "framework/core/error.h"
#include "framework/core/temporary_names.h"

namespace lapwing {

namespace fs = std::filesystem;

namespace {

std::string reason(int code) {
  return std::strerror(code);
}

[[noreturn]] void cannot_write(const fs::path& path, const std::string& why) {
  throw InputError("cannot write '" + path.string() + "': " + why);
}

[[noreturn]] void cannot_read(const fs::path& path, const std::string& why) {
  throw InputError("cannot read '" + path.string() + "': " + why);
}

// Owns the temporary until it is renamed into place.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!path_.empty() && created_) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  bool opened() {
    created_ = descriptor_ >= 0;
    return created_;
  }
  bool keep_mode(mode_t mode) { return ::fchmod(descriptor_, mode) == 0; }
  bool write(std::string_view contents) {
    while (!contents.empty()) {
      const ssize_t written = ::write(descriptor_, contents.data(), contents.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return false;
      contents.remove_prefix(static_cast<std::size_t>(written));
    }
    return ::fsync(descriptor_) == 0;
  }
  bool move_to(const fs::path& target) {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (::close(descriptor) != 0) return false;
    if (::rename(path_.c_str(), target.c_str()) != 0) return false;
    created_ = false;
    return true;
  }
  // False with errno EEXIST where there is such a file. A file system without hard links has a gap
  // between the look and the move.
  bool move_to_new(const fs::path& target) {
    if (::link(path_.c_str(), target.c_str()) == 0) return true;
    if (errno != EPERM && errno != EOPNOTSUPP && errno != ENOSYS) return false;
    if (::access(target.c_str(), F_OK) != 0) return move_to(target);
    errno = EEXIST;
    return false;
  }

 private:
  fs::path path_;
  int descriptor_ = -1;
  bool created_ = false;
};

// The name must survive a power cut as well as the contents do.
void flush_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);  // some file systems refuse; the file itself is safe
  ::close(descriptor);
}

// Where a file goes. A link is followed, so that it still points to the file afterwards.
fs::path target_of(const fs::path& path) {
  if (path.filename().empty()) cannot_write(path, "the path names no file");
  std::error_code code;
  const fs::path target = fs::is_symlink(path, code) ? fs::weakly_canonical(path, code) : path;
  // A file where a folder should be is named below.
  if (code && code != std::errc::no_such_file_or_directory && code != std::errc::not_a_directory)
    cannot_write(path, code.message());
  return target;
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// The permissions of the file that is there already, if one is.
std::optional<mode_t> mode_there(const fs::path& path, const fs::path& target) {
  struct stat existing {};
  if (::stat(target.c_str(), &existing) != 0) return std::nullopt;
  if (S_ISDIR(existing.st_mode)) cannot_write(path, "it is a folder");
  if (!S_ISREG(existing.st_mode)) cannot_write(path, "it is not a regular file");
  return existing.st_mode & 07777;
}

// The lowest place above a file that can be seen. What lies in a folder that may not be entered
// cannot be seen: then it is that folder.
fs::path nearest_there(const fs::path& file) {
  fs::path folder = folder_of(file);
  std::error_code code;
  while (!fs::exists(folder, code) && folder != folder_of(folder)) folder = folder_of(folder);
  return folder;
}

void require_access(const fs::path& path, const fs::path& folder, int access) {
  if (::faccessat(AT_FDCWD, folder.c_str(), access, AT_EACCESS) != 0)
    cannot_write(path, "folder '" + folder.string() + "': " + reason(errno));
}

// Something that can be waited for: a pipe, a terminal. Opened so that nothing blocks.
class Source {
 public:
  Source(const fs::path& path, int descriptor, bool pipe)
      : path_(path), descriptor_(descriptor), pipe_(pipe) {}

  // Bytes read; 0 at the end. A pipe may have nobody at its other end, and would be waited for
  // without end. Where somebody has it open, what comes is waited for, however long that takes.
  std::size_t read(char* buffer, std::size_t size) {
    for (int waited = 0; waited <= kPatience;) {
      const ssize_t count = ::read(descriptor_, buffer, size);
      if (count > 0) begun_ = true;
      if (count > 0 || (count == 0 && (!pipe_ || begun_ || was_left()))) {
        return static_cast<std::size_t>(count);
      } else if (count == 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(kStep));
        waited += kStep;
      } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
        begun_ = true;  // somebody has it open
        pollfd state{descriptor_, POLLIN, 0};
        ::poll(&state, 1, -1);
      } else if (errno != EINTR) {
        cannot_read(path_, reason(errno));
      }
    }
    cannot_read(path_, "nobody has written into it for 5 s");
  }

 private:
  static constexpr int kPatience = 5000, kStep = 20;  // ms

  // Somebody had the pipe open for writing and closed it.
  bool was_left() const {
    pollfd state{descriptor_, POLLIN, 0};
    return ::poll(&state, 1, 0) > 0 && (state.revents & POLLHUP);
  }

  const fs::path& path_;
  int descriptor_;
  bool pipe_, begun_ = false;
};

}  // namespace

void require_writable(const fs::path& path) {
  std::error_code code;
  const fs::path nearest = nearest_there(path);
  if (fs::is_directory(nearest, code)) require_access(path, nearest, X_OK);
  const fs::path target = target_of(path);
  mode_there(path, target);
  const fs::path folder = nearest_there(target);
  if (!fs::is_directory(folder, code))
    cannot_write(path, "'" + folder.string() + "' is not a folder");
  require_access(path, folder, W_OK | X_OK);
}

namespace {

void make_parent(const fs::path& path, const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) cannot_write(path, "cannot create folder '" + folder.string() + "': " + code.message());
}

}  // namespace

bool create_file_atomically(const fs::path& path, std::string_view contents) {
  const fs::path target = target_of(path), folder = folder_of(target);
  make_parent(path, folder);
  clear_dead_temporaries(folder);
  TemporaryFile temporary(folder / temporary_name(target.filename().string()));
  if (!temporary.opened() || !temporary.write(contents)) cannot_write(path, reason(errno));
  const bool made = temporary.move_to_new(target);
  if (!made && errno != EEXIST) cannot_write(path, reason(errno));
  flush_folder(folder);
  return made;
}

void write_file_atomically(const fs::path& path, std::string_view contents) {
  const fs::path target = target_of(path), folder = folder_of(target);
  make_parent(path, folder);
  const std::optional<mode_t> mode = mode_there(path, target);

  clear_dead_temporaries(folder);
  TemporaryFile temporary(folder / temporary_name(target.filename().string()));
  if (!temporary.opened()) cannot_write(path, reason(errno));
  if (mode && !temporary.keep_mode(*mode)) cannot_write(path, reason(errno));
  if (!temporary.write(contents)) cannot_write(path, reason(errno));
  if (!temporary.move_to(target)) cannot_write(path, reason(errno));
  flush_folder(folder);
}

std::string read_file(const fs::path& path, std::size_t limit_bytes) {
  // Opening a pipe would wait for whoever writes into it.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) cannot_read(path, reason(errno));
  struct Closer {
    int descriptor;
    ~Closer() { ::close(descriptor); }
  } closer{descriptor};
  struct stat info {};
  if (::fstat(descriptor, &info) != 0) cannot_read(path, reason(errno));
  if (S_ISDIR(info.st_mode)) cannot_read(path, "it is a folder");

  std::string contents;
  if (S_ISREG(info.st_mode)) {
    const auto size = static_cast<std::size_t>(info.st_size);
    // Before a byte of it takes memory.
    if (size > limit_bytes)
      cannot_read(path, "with " + std::to_string(size) + " bytes it is larger than " +
                            std::to_string(limit_bytes) + " bytes");
    contents.reserve(size);
  }
  char buffer[1 << 16];
  Source source(path, descriptor, S_ISFIFO(info.st_mode));
  while (const std::size_t count = source.read(buffer, sizeof buffer)) {
    if (contents.size() + count > limit_bytes) {
      cannot_read(path, "it is larger than " + std::to_string(limit_bytes) + " bytes");
    }
    contents.append(buffer, count);
  }
  return contents;
}

}  // namespace lapwing
