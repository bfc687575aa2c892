// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/page_assets.h"

#include <algorithm>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/studio/embedded_page.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFiles = 1000, kLargestFile = 32 << 20;

// "" for a file that is none of a page.
std::string type_of(const fs::path& name) {
  static const std::map<std::string, std::string> kTypes{{".html", "text/html; charset=utf-8"},
                                                         {".js", "text/javascript; charset=utf-8"},
                                                         {".css", "text/css; charset=utf-8"},
                                                         {".json", "application/json"},
                                                         {".svg", "image/svg+xml"},
                                                         {".png", "image/png"},
                                                         {".ico", "image/x-icon"},
                                                         {".woff2", "font/woff2"},
                                                         {".txt", "text/plain; charset=utf-8"},
                                                         {".map", "application/json"}};
  const auto found = kTypes.find(name.extension().string());
  return found == kTypes.end() ? "" : found->second;
}

}  // namespace

PageAssets PageAssets::of_folder(const fs::path& folder) {
  std::error_code code;
  if (!fs::is_regular_file(folder / "index.html", code))
    throw InputError("--assets " + folder.string() + ": there is no index.html in it");
  PageAssets assets;
  for (const auto& item : fs::recursive_directory_iterator(folder, code)) {
    const std::string type = type_of(item.path());
    if (type.empty() || !item.is_regular_file(code) || item.is_symlink(code)) continue;
    const std::string path = "/" + item.path().lexically_relative(folder).generic_string();
    assets.table_[path] = {type, item.path(), nullptr};
    if (assets.table_.size() > kMostFiles)
      throw InputError("--assets " + folder.string() + ": more than " + std::to_string(kMostFiles) +
                       " files");
  }
  assets.table_["/"] = assets.table_.at("/index.html");
  return assets;
}

PageAssets PageAssets::built_in() {
  PageAssets assets;
  for (const EmbeddedFile& file : embedded_page()) {
    const std::string path(file.path);
    assets.table_[path] = {type_of(path), "",
                           std::make_shared<const std::string>(file.begin, file.end)};
  }
  if (!assets.table_.count("/index.html"))
    throw InputError(
        "this build has no page: `bash scripts/studio.sh MISSION.lua` builds it and opens it, and "
        "--assets DIR serves one from a folder");
  assets.table_["/"] = assets.table_.at("/index.html");
  return assets;
}

bool PageAssets::has_page() {
  const auto files = embedded_page();
  return std::any_of(files.begin(), files.end(),
                     [](const EmbeddedFile& file) { return file.path == "/index.html"; });
}

std::optional<WebContent> PageAssets::find(std::string_view path) const {
  const auto found = table_.find(path);
  if (found == table_.end()) return std::nullopt;
  const Asset& asset = found->second;
  if (asset.bytes) return WebContent{asset.type, asset.bytes, false};
  try {
    return WebContent{asset.type,
                      std::make_shared<const std::string>(read_file(asset.file, kLargestFile)),
                      false};
  } catch (const InputError&) {  // gone meanwhile
    return std::nullopt;
  }
}

}  // namespace lapwing
