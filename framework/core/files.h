// SPDX-License-Identifier: Apache-2.0
// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lapwing {

// Writes beside the target under a temporary name, flushes, then renames. On any error the target
// is as it was, the temporary is gone, and an InputError names the path and the system's reason.
// Temporaries that dead processes left in the folder are cleared.
// Creates missing parent folders; follows a link; refuses what is no regular file.
void write_file_atomically(const std::filesystem::path& path, std::string_view contents);

// The same for a file that must not be there yet: false, and nothing is written, where it is. Of
// several processes that call it at once, one writes.
bool create_file_atomically(const std::filesystem::path& path, std::string_view contents);

// Whether `write_file_atomically` could write there, as far as that is known without writing:
// InputError where the path is a folder or none can be made. To be asked before long work.
void require_writable(const std::filesystem::path& path);

// Throws InputError naming the path and the reason; refuses folders and files above `limit_bytes`,
// and a pipe into which nobody writes for 5 s.
std::string read_file(const std::filesystem::path& path, std::size_t limit_bytes = 256u << 20);

}  // namespace lapwing
