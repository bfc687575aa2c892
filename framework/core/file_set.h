// Files of one folder that change together: after a full disk, a crash or a kill the folder holds
// all of the new ones or all of the old ones.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/folders.h"

namespace lapwing {

struct FileSet {
  NamedContents files;
  std::vector<std::string> removed = {};  // names that an older set had; whatever is not there, too
};

// Writes all files into a hidden folder within `folder` (the same file system), flushes them, puts
// a list of what is to be done beside them, and only then moves them to their names and removes the
// others. Up to that list, an error or a kill leaves the old files as they were; from it on,
// `finish_exchange` completes the change. Other files of the folder are not touched. Creates the
// folder; keeps the permissions of files that are replaced; a link is replaced, not what it points
// to. Throws InputError naming the path and the system's reason. One writer at a time: see
// FolderClaim.
void write_files_together(const std::filesystem::path& folder, const FileSet& set);

// Completes a change of `write_files_together` that was ended in its last step, and does nothing
// where there is none. To be called before files of such a folder are read. Throws InputError when
// it cannot.
void finish_exchange(const std::filesystem::path& folder);

// Keeps a folder for one process as long as it lives. Makes the folder; when nothing was put into
// it, takes it away again. Where the file system has no locks, nobody is refused.
class FolderClaim {
 public:
  // InputError when another process has it, or when the folder cannot be made.
  explicit FolderClaim(const std::filesystem::path& folder);
  ~FolderClaim();
  FolderClaim(const FolderClaim&) = delete;
  FolderClaim& operator=(const FolderClaim&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  // outermost first
  int descriptor_ = -1;
};

}  // namespace lapwing
