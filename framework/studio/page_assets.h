// SPDX-License-Identifier: Apache-2.0
// The files of the page: an exact table of paths.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "framework/studio/web_server.h"

namespace lapwing {

class PageAssets {
 public:
  // The files of a folder, those below it included, as they are when they are asked for; for who
  // works on the page. InputError where there is no index.html, or more than 1000 files.
  static PageAssets of_folder(const std::filesystem::path& folder);
  // What was built in; InputError where nothing was.
  static PageAssets built_in();

  // Whether a page was built in.
  static bool has_page();
  // "/" is index.html. Nothing for a path that is not in the table, and for what is not text, a
  // script, a style, a picture or a font.
  std::optional<WebContent> find(std::string_view path) const;

 private:
  struct Asset {
    std::string type;
    std::filesystem::path file;                // of a folder, or
    std::shared_ptr<const std::string> bytes;  // built in
  };
  std::map<std::string, Asset, std::less<>> table_;
};

}  // namespace lapwing
