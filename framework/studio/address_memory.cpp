// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/address_memory.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTokenLength = 32, kLargestNote = 1000;

// Of this user, and open to nobody else.
bool is_private(const fs::path& path, mode_t kind) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0 && (found.st_mode & S_IFMT) == kind &&
         found.st_uid == ::geteuid() && (found.st_mode & 077) == 0;
}

}  // namespace

AddressMemory::AddressMemory(const fs::path& script) {
  const char* folder = std::getenv("XDG_RUNTIME_DIR");
  std::error_code code;
  const fs::path whole = fs::canonical(script, code);
  if (!folder || !*folder || code || !is_private(folder, S_IFDIR)) return;
  file_ = fs::path(folder) / ("lapwing_studio_" + sha256(whole.string()) + ".json");
}

AddressMemory::~AddressMemory() {
  if (!file_.empty()) ::unlink(file_.c_str());
}

std::optional<StudioPlace> AddressMemory::find() const {
  if (file_.empty() || !is_private(file_, S_IFREG)) return std::nullopt;
  try {
    const Value value = from_json(read_file(file_, kLargestNote), file_.string());
    const std::int64_t port = value.at("port").as_integer();
    const std::string& token = value.at("token").as_text();
    const bool hexadecimal = token.find_first_not_of("0123456789abcdef") == token.npos;
    if (port < 1 || port > 65535 || token.size() != kTokenLength || !hexadecimal)
      return std::nullopt;
    return StudioPlace{static_cast<std::uint16_t>(port), token};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// Never readable for others, not even for a moment. What cannot be kept is not.
void AddressMemory::keep(const StudioPlace& place) const {
  if (file_.empty()) return;
  ::unlink(file_.c_str());
  const int file =
      ::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0) return;
  Value value = Value::map();
  value.set("port", static_cast<std::int64_t>(place.port));
  value.set("token", place.token);
  const std::string text = to_json(value, -1);
  const bool whole = ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  ::close(file);
  if (!whole) ::unlink(file_.c_str());
}

}  // namespace lapwing
