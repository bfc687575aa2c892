// SPDX-License-Identifier: Apache-2.0
// Files of one folder that change together: after a full disk, a crash or a kill the folder holds
// all of the new ones or all of the old ones.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/core/folders.h"

namespace lapwing {

// Whether a name is one that the writers of a folder give their files.
using NameTest = std::function<bool(const std::string& name)>;

struct FileSet {
  NamedContents files;
  std::vector<std::string> removed = {};  // names that an older set had; whatever is not there, too
  NameTest is_own = nullptr;  // further names that a change ended earlier may put and remove
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
// where there is none. For the one writer of a folder, before it reads files there. The list of
// what is to be done is checked as a whole first: only names that `is_own` knows are put or
// removed. Throws InputError where the list holds anything else, and when it cannot be completed.
void finish_exchange(const std::filesystem::path& folder, const NameTest& is_own);

// The same for who only reads the folder. Nothing is changed while another process has the folder
// (FolderClaim), or where the list is not one of a writer's: then a sentence says so. Empty where
// there was nothing to do or all was done. Never throws InputError.
std::string finish_exchange_to_read(const std::filesystem::path& folder, const NameTest& is_own);

// Keeps a folder for one process as long as it lives. Makes the folder; when nothing was put into
// it, takes it away again. Two locks hold it: one on the folder, which a reader looks for too, and
// one on the file ".NAME.lock" beside it, which stays where it is when the folder is renamed or
// exchanged. The file is gone afterwards; one that a killed process left holds nothing. It is left
// out where the parent cannot be written. Where the file system has no locks, nobody is refused.
//
// Several processes may share a folder if all of them ask for that. While they do, no process can
// claim it alone. They have the lock on the folder only.
enum class ClaimKind { alone, shared };
class FolderClaim {
 public:
  // InputError when another process has it, or when the folder cannot be made.
  explicit FolderClaim(const std::filesystem::path& folder, ClaimKind kind = ClaimKind::alone);
  ~FolderClaim();
  FolderClaim(const FolderClaim&) = delete;
  FolderClaim& operator=(const FolderClaim&) = delete;

 private:
  void lock_beside(const std::filesystem::path& folder);
  void release();

  std::vector<std::filesystem::path> made_;  // outermost first
  std::filesystem::path beside_;             // the lock file; empty: there is none
  int descriptor_ = -1, beside_descriptor_ = -1;
};

}  // namespace lapwing
