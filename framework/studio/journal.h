// SPDX-License-Identifier: Apache-2.0
// A studio's journal: one line of JSON for every entry of a document's history, synced to disk.
//
// The first line names the format and holds the script's configuration that the document began
// with. A later line that a crash cut off, one without its end, is dropped when the journal is
// opened, and said. Anything else that cannot be read is an error, and the file stays as it is.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "framework/studio/document.h"

namespace lapwing {

class Journal {
 public:
  static constexpr int kFormat = 1;
  static constexpr std::size_t kLargest = std::size_t{256} << 20;  // bytes

  // Opens or creates it, and keeps it for this process. Throws InputError where another process has
  // it, where it cannot be written, and, naming the line, where it holds anything else.
  explicit Journal(std::filesystem::path file);
  ~Journal();  // takes away a journal without an entry
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  const std::filesystem::path& file() const { return file_; }
  // The document that it told of when it was opened; none of an empty one.
  const std::optional<StudioDocument>& document() const { return document_; }
  // A sentence on what was dropped, or "".
  const std::string& remark() const { return remark_; }

  // The first line, of an empty journal, and an entry of the document. Both return once it is on
  // disk. Throw InputError with the system's reason; the journal is then as it was.
  void begin(const Value& script);
  void append(const HistoryEntry& entry);

 private:
  void read();
  void drop_rest(std::size_t bytes);
  void read_line(const std::string& line, std::size_t number);
  void write(std::string line);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::size_t length_ = 0, lines_ = 0;  // bytes that are whole, and their lines
  std::optional<StudioDocument> document_;
  std::string remark_;
};

}  // namespace lapwing
