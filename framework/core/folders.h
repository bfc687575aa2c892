// SPDX-License-Identifier: Apache-2.0
// Folders that appear whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lapwing {

// A file's name, without any folder, and its contents.
using NamedContents = std::vector<std::pair<std::string, std::string>>;

// Writes the files into a folder beside `folder` and then puts that in its place. An older folder
// that holds files of these names alone is replaced; on any error it is as it was, the new one is
// gone, and an InputError names the path and the reason. Creates missing parents.
void write_folder_atomically(const std::filesystem::path& folder, const NamedContents& files);

}  // namespace lapwing
