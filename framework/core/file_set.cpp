// SPDX-License-Identifier: Apache-2.0
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
constexpr std::size_t kLargestList = 1 << 20;        // bytes
constexpr const char* kOrders = ".orders";  // in it: "put NAME" and "drop NAME", a line each

[[noreturn]] void cannot_exchange(const fs::path& path, const std::string& why) {
  throw InputError("cannot write '" + path.string() + "': " + why);
}

bool is_plain(const std::string& name) {
  return !name.empty() && name[0] != '.' && name.find('/') == std::string::npos &&
         name.find('\n') == std::string::npos && name.find('\0') == std::string::npos;
}

// A file's plain name, which no list of lines can mistake.
void require_plain(const std::string& name) {
  if (!is_plain(name)) throw Error("a file of a set is named '" + name + "'");
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
  if (!fs::is_directory(folder, code)) cannot_exchange(folder, "it is not a folder");
}

struct Order {
  bool put = false;  // else the file is removed
  std::string name;
};

struct Descriptor {
  explicit Descriptor(int opened) : number(opened) {}
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  const int number;
};

// The whole list, before any of it is done: the folder may come from anywhere.
std::vector<Order> read_orders(const fs::path& ready, const NameTest& is_own) {
  const auto refuse = [&](const std::string& what) {
    throw InputError("'" + ready.string() + "' was not written by a run (" + what + "); delete it");
  };
  std::error_code code;
  const fs::path list = ready / kOrders;
  const fs::file_status status = fs::symlink_status(list, code);
  if (!fs::exists(status)) return {};
  if (!fs::is_regular_file(status)) refuse("its list is not a file");
  std::vector<Order> orders;
  std::istringstream lines(read_file(list, kLargestList));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.find(' ');
    const std::string what = line.substr(0, space);
    const Order order{what == "put", space == std::string::npos ? "" : line.substr(space + 1)};
    if (what != "put" && what != "drop") refuse("line '" + line + "'");
    if (!is_plain(order.name)) refuse("'" + order.name + "' is not a plain name of a file");
    if (!is_own(order.name)) refuse("'" + order.name + "' is not a file of its own");
    for (const fs::path& path : {ready / order.name, ready.parent_path() / order.name}) {
      const fs::file_status there = fs::symlink_status(path, code);
      if (fs::exists(there) && !fs::is_regular_file(there) && !fs::is_symlink(there))
        refuse("'" + order.name + "' is not a file");
    }
    orders.push_back(order);
  }
  return orders;
}

}  // namespace

void finish_exchange(const fs::path& folder, const NameTest& is_own) {
  const fs::path ready = folder / kReady;
  std::error_code code;
  if (!fs::is_directory(fs::symlink_status(ready, code))) return;
  // Without the list nothing is to be done any more: it is the last that is taken away.
  for (const Order& order : read_orders(ready, is_own)) {
    const fs::path made = ready / order.name, target = folder / order.name;
    // What is no longer there was moved before the change was ended.
    const int failed =
        order.put ? ::rename(made.c_str(), target.c_str()) : ::unlink(target.c_str());
    if (failed != 0 && errno != ENOENT) cannot_exchange(target, std::strerror(errno));
  }
  flush_directory(folder);
  fs::remove(ready / kOrders, code);
  if (!code) fs::remove_all(ready, code);
  if (code) cannot_exchange(ready, code.message());
}

std::string finish_exchange_to_read(const fs::path& folder, const NameTest& is_own) {
  std::error_code code;
  if (!fs::is_directory(fs::symlink_status(folder / kReady, code))) return "";
  const std::string left = "'" + folder.string() + "' has files of a run that was ended while " +
                           "it moved them to their places; they were not changed: ";
  const Descriptor there(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (there.number < 0) return left + std::strerror(errno);
  if (::flock(there.number, LOCK_EX | LOCK_NB) != 0)
    return left + (errno == EWOULDBLOCK ? "another process is writing into the folder"
                                        : std::strerror(errno));
  try {
    finish_exchange(folder, is_own);
  } catch (const InputError& error) {
    return left + error.what();
  }
  return "";
}

void write_files_together(const fs::path& folder, const FileSet& set) {
  for (const auto& [name, contents] : set.files) require_plain(name);
  for (const std::string& name : set.removed) require_plain(name);
  make_folder(folder);
  clear_dead_temporaries(folder);
  const NameTest is_listed = [&](const std::string& name) {
    return std::count(set.removed.begin(), set.removed.end(), name) > 0 ||
           std::any_of(set.files.begin(), set.files.end(),
                       [&](const auto& file) { return file.first == name; });
  };
  const NameTest is_own = [&](const std::string& name) {
    return is_listed(name) || (set.is_own && set.is_own(name));
  };
  finish_exchange(folder, is_own);
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
  finish_exchange(folder, is_own);
}

namespace {

[[noreturn]] void refuse_claimed(const fs::path& folder) {
  throw InputError("another process is writing into '" + folder.string() +
                   "'; wait until it ends, or choose another folder");
}

// False where another process has it. A file system without locks refuses nobody.
bool lock_or_none(int descriptor, int kind = LOCK_EX) {
  return ::flock(descriptor, kind | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

// ".NAME.lock" beside the folder, whatever way leads to it; empty for a folder without a name.
fs::path lock_file_of(const fs::path& folder) {
  std::error_code code;
  const fs::path named = fs::absolute(folder, code).lexically_normal();
  const fs::path plain = named.filename().empty() ? named.parent_path() : named;
  const fs::path parent = fs::canonical(plain.parent_path(), code);
  const std::string name = plain.filename().string();
  if (code || name.empty() || name == "." || name == "..") return {};
  return parent / ("." + name + ".lock");
}

// Not through a link; -1 where it cannot be opened. Of somebody else's it may only be read.
int open_lock_file(const fs::path& file) {
  constexpr int kFlags = O_RDONLY | O_CLOEXEC | O_NOFOLLOW;
  const int made = ::open(file.c_str(), kFlags | O_CREAT, 0666);
  return made >= 0 ? made : ::open(file.c_str(), kFlags);
}

// Whether the path still leads to what was opened: whoever held it before may have removed it.
bool is_still_there(const fs::path& file, int descriptor) {
  struct stat opened {
  }, there{};
  return ::fstat(descriptor, &opened) == 0 && ::lstat(file.c_str(), &there) == 0 &&
         opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

}  // namespace

FolderClaim::FolderClaim(const fs::path& folder, ClaimKind kind) {
  std::error_code code;
  fs::path at = folder;
  for (; !at.empty() && !fs::exists(fs::symlink_status(at, code)); at = at.parent_path())
    if (!at.filename().empty()) made_.insert(made_.begin(), at);
  make_folder(folder);
  descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) cannot_exchange(folder, std::strerror(errno));
  try {
    const bool shared = kind == ClaimKind::shared;
    if (!lock_or_none(descriptor_, shared ? LOCK_SH : LOCK_EX)) refuse_claimed(folder);
    if (!shared) lock_beside(folder);
  } catch (...) {
    release();
    throw;
  }
}

void FolderClaim::lock_beside(const fs::path& folder) {
  const fs::path file = lock_file_of(folder);
  while (!file.empty()) {
    const int opened = open_lock_file(file);
    if (opened < 0) return;
    if (!lock_or_none(opened)) {
      ::close(opened);
      refuse_claimed(folder);
    }
    if (is_still_there(file, opened)) {
      beside_ = file;
      beside_descriptor_ = opened;
      return;
    }
    ::close(opened);
  }
}

void FolderClaim::release() {
  if (!beside_.empty()) ::unlink(beside_.c_str());  // before its lock goes: it is still ours
  if (beside_descriptor_ >= 0) ::close(beside_descriptor_);
  if (descriptor_ >= 0) ::close(descriptor_);
}

FolderClaim::~FolderClaim() {
  if (!beside_.empty()) ::unlink(beside_.c_str());  // or the parent would not be empty
  // Only what is empty goes.
  for (auto at = made_.rbegin(); at != made_.rend(); ++at)
    if (::rmdir(at->c_str()) != 0) break;
  beside_.clear();
  release();
}

}  // namespace lapwing
