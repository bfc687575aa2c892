#include "framework/core/file_set.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/temporary_names.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReady = ".lapwing-exchange";  // a set that is whole and not yet in its place
constexpr const char* kOrders = ".orders";  // in it: "put NAME" and "drop NAME", a line each

[[noreturn]] void cannot_exchange(const fs::path& path, const std::string& why) {
  throw InputError("cannot write '" + path.string() + "': " + why);
}

// A file's plain name, which no list of lines can mistake.
void require_plain(const std::string& name) {
  if (name.empty() || name[0] == '.' || fs::path(name).filename() != name ||
      name.find('\n') != std::string::npos)
    throw Error("a file of a set is named '" + name + "'");
}

void flush_directory(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);  // some file systems refuse; the files themselves are safe
  ::close(descriptor);
}

// Gone unless it was put in its place.
class Staging {
 public:
  explicit Staging(const fs::path& folder) : path_(folder / temporary_name("set")) {
    if (::mkdir(path_.c_str(), 0777) != 0) cannot_exchange(folder, std::strerror(errno));
  }
  ~Staging() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;
  const fs::path& path() const { return path_; }
  void keep() { path_.clear(); }

 private:
  fs::path path_;
};

// What is there must be a file, or the last step could not replace it.
void require_replaceable(const fs::path& path) {
  struct stat there {};
  if (::lstat(path.c_str(), &there) != 0) return;
  if (!S_ISREG(there.st_mode) && !S_ISLNK(there.st_mode))
    cannot_exchange(path, S_ISDIR(there.st_mode) ? "it is a folder" : "it is not a regular file");
}

void keep_permissions(const fs::path& old, const fs::path& made) {
  struct stat there {};
  if (::stat(old.c_str(), &there) == 0 && S_ISREG(there.st_mode) &&
      ::chmod(made.c_str(), there.st_mode & 07777) != 0)
    cannot_exchange(old, std::strerror(errno));
}

// Errors name the file that was asked for, not where it is made.
void write_staged(const fs::path& staging, const std::string& name, const std::string& contents,
                  const fs::path& folder) {
  try {
    write_file_atomically(staging / name, contents);
  } catch (const InputError& error) {
    std::string message = error.what();
    const std::string made = staging.string();
    if (const std::size_t at = message.find(made); at != std::string::npos)
      message.replace(at, made.size(), folder.string());
    throw InputError(message);
  }
}

void make_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) cannot_exchange(folder, code.message());
  if (!fs::is_directory(folder, code)) cannot_exchange(folder, "it is no folder");
}

}  // namespace

void finish_exchange(const fs::path& folder) {
  const fs::path ready = folder / kReady;
  std::error_code code;
  if (!fs::is_directory(fs::symlink_status(ready, code))) return;
  std::string orders;
  // Without the list nothing is to be done any more: it is the last that is taken away.
  if (fs::exists(ready / kOrders, code)) orders = read_file(ready / kOrders);
  std::istringstream lines(orders);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.find(' ');
    const std::string what = line.substr(0, space);
    const std::string name = space == std::string::npos ? "" : line.substr(space + 1);
    if (name.empty() || name[0] == '.' || fs::path(name).filename() != name)
      throw InputError("'" + ready.string() + "' holds a list that nobody wrote; delete it");
    // What is no longer there was moved before the change was ended.
    const bool put = what == "put";
    const int failed = put ? ::rename((ready / name).c_str(), (folder / name).c_str())
                           : ::unlink((folder / name).c_str());
    if (failed != 0 && errno != ENOENT) cannot_exchange(folder / name, std::strerror(errno));
  }
  flush_directory(folder);
  fs::remove(ready / kOrders, code);
  if (!code) fs::remove_all(ready, code);
  if (code) cannot_exchange(ready, code.message());
}

void write_files_together(const fs::path& folder, const FileSet& set) {
  for (const auto& [name, contents] : set.files) require_plain(name);
  for (const std::string& name : set.removed) require_plain(name);
  make_folder(folder);
  clear_dead_temporaries(folder);
  finish_exchange(folder);
  std::string orders;
  for (const std::string& name : set.removed) {
    const bool written = std::any_of(set.files.begin(), set.files.end(),
                                     [&](const auto& file) { return file.first == name; });
    if (written) continue;
    require_replaceable(folder / name);
    orders += "drop " + name + "\n";
  }
  Staging staging(folder);
  for (const auto& [name, contents] : set.files) {
    require_replaceable(folder / name);
    write_staged(staging.path(), name, contents, folder);
    keep_permissions(folder / name, staging.path() / name);
    orders += "put " + name + "\n";
  }
  write_staged(staging.path(), kOrders, orders, folder);
  // The change is decided here.
  if (::rename(staging.path().c_str(), (folder / kReady).c_str()) != 0)
    cannot_exchange(folder, std::strerror(errno));
  staging.keep();
  flush_directory(folder);
  finish_exchange(folder);
}

FolderClaim::FolderClaim(const fs::path& folder) {
  std::error_code code;
  fs::path at = folder;
  for (; !at.empty() && !fs::exists(fs::symlink_status(at, code)); at = at.parent_path())
    if (!at.filename().empty()) made_.insert(made_.begin(), at);
  make_folder(folder);
  descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) cannot_exchange(folder, std::strerror(errno));
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw InputError("another process is writing into '" + folder.string() +
                   "'; wait until it has ended, or choose another folder");
}

FolderClaim::~FolderClaim() {
  // Only what is empty goes.
  for (auto at = made_.rbegin(); at != made_.rend(); ++at)
    if (::rmdir(at->c_str()) != 0) break;
  ::close(descriptor_);
}

}  // namespace lapwing
