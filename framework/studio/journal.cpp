// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

std::string reason() {
  return std::strerror(errno);
}

// So that a new file's name is on disk as well.
void sync_folder(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

// Whether the file's name is still of what is open: whoever had it before may have removed it.
bool has_name(int descriptor, const fs::path& file) {
  struct stat open {
  }, named{};
  return ::fstat(descriptor, &open) == 0 && ::lstat(file.c_str(), &named) == 0 &&
         open.st_dev == named.st_dev && open.st_ino == named.st_ino;
}

int open_locked(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (descriptor < 0)
    throw InputError("cannot write '" + file.string() + "', the journal of edits: " + reason());
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  const bool taken = errno == EWOULDBLOCK;
  const std::string why = reason();
  ::close(descriptor);
  throw InputError(taken ? "another studio has this mission open ('" + file.string() +
                               "' is in use); its address is where that was started"
                         : "cannot lock '" + file.string() + "': " + why);
}

}  // namespace

Journal::Journal(fs::path file) : file_(std::move(file)) {
  descriptor_ = open_locked(file_);
  while (!has_name(descriptor_, file_)) {
    ::close(descriptor_);
    descriptor_ = open_locked(file_);
  }
  try {
    read();
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

Journal::~Journal() {
  if (lines_ <= 1 && has_name(descriptor_, file_)) ::unlink(file_.c_str());
  ::close(descriptor_);
}

void Journal::read() {
  const std::string text = read_file(file_, kLargest);
  while (length_ < text.size()) {
    const std::size_t end = text.find('\n', length_);
    if (end == text.npos && lines_ > 0) return drop_rest(text.size() - length_);
    try {
      if (end == text.npos) throw InputError("it has no end");
      read_line(text.substr(length_, end - length_), lines_ + 1);
    } catch (const InputError& error) {
      throw InputError("'" + file_.string() + "', line " + std::to_string(lines_ + 1) +
                       ": not a journal's: " + error.what() +
                       "; move it away to begin without its edits");
    }
    length_ = end + 1;
    ++lines_;
  }
}

void Journal::drop_rest(std::size_t bytes) {
  if (::ftruncate(descriptor_, static_cast<off_t>(length_)) < 0)
    throw InputError("cannot mend '" + file_.string() + "': " + reason());
  remark_ = "the last line of '" + file_.string() + "' was cut off (" + std::to_string(bytes) +
            " bytes): what it said is lost";
}

void Journal::read_line(const std::string& line, std::size_t number) {
  const Value value = without_origins(from_json(line, "journal"));
  if (number > 1) {
    document_->add(history_entry(value));
    return;
  }
  if (value.at("lapwing_studio_journal") != Value(kFormat))
    throw InputError("expected format " + std::to_string(kFormat));
  document_.emplace(value.at("script"));
}

void Journal::begin(const Value& script) {
  Value line = Value::map();
  line.set("lapwing_studio_journal", kFormat);
  line.set("script", script);
  write(to_json(line, -1));
  sync_folder(file_);
}

void Journal::append(const HistoryEntry& entry) {
  write(to_json(to_value(entry), -1));
}

void Journal::write(std::string line) {
  line += '\n';
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t count = ::pwrite(descriptor_, line.data() + done, line.size() - done,
                                   static_cast<off_t>(length_ + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  if (done == line.size() && ::fdatasync(descriptor_) == 0) {
    length_ += line.size();
    ++lines_;
    return;
  }
  const std::string why = reason();
  if (::ftruncate(descriptor_, static_cast<off_t>(length_)) < 0) {
    // Dropped as cut off when it is opened again, and written over until then.
  }
  throw InputError("cannot write '" + file_.string() + "': " + why);
}

}  // namespace lapwing
