// What Ipopt prints, as lines of our log.
#pragma once

#include <string>

namespace lapwing {

// Text in pieces becomes lines of the log, at level debug and named "ipopt: ". Lines that tell
// processor time are left out: equal runs give equal logs.
class JournalLines {
 public:
  ~JournalLines() { flush(); }
  void write(const char* text);
  void flush();

 private:
  void line(const std::string& text);
  std::string pending_;
};

}  // namespace lapwing
