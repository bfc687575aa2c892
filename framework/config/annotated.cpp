// SPDX-License-Identifier: Apache-2.0
#include "framework/config/annotated.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "framework/config/yaml.h"
#include "framework/core/json.h"

namespace lapwing {

namespace {

constexpr std::size_t kWidestAligned = 60;  // longer lines do not push everybody's comment away

struct Line {
  std::string text;
  std::string comment;
};

std::string shown_origin(const Origin& origin) {
  if (origin.source.empty()) return "";
  if (origin.source.starts_with("--"))  // "--set step=0.1": the value stands beside it
    return origin.source.substr(0, origin.source.find(' '));
  if (origin.line == 0) return origin.source;  // "default"
  return "from " + origin.to_string();
}

// Plain where YAML reads the same text back; a JSON string is also a YAML string.
std::string shown_text(const std::string& text) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-' || c == '.' || c == '/';
  };
  const bool is_plain = !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0]))) &&
                        std::all_of(text.begin(), text.end(), plain);
  if (is_plain && from_yaml("[" + text + "]", "").as_list().front() == Value(text)) return text;
  return to_json(Value(text), -1);
}

bool holds_map(const Value& value) {
  if (value.is_map()) return !value.as_map().empty();
  if (!value.is_list()) return false;
  return std::any_of(value.as_list().begin(), value.as_list().end(), holds_map);
}

std::string shown_flow(const Value& value) {
  if (value.is_text()) return shown_text(value.as_text());
  if (value.is_map()) return "{}";
  if (!value.is_list()) return to_json(value, -1);
  std::string text = "[";
  for (const Value& entry : value.as_list()) {
    text += (text.size() > 1 ? ", " : "") + shown_flow(entry);
  }
  return text + "]";
}

// Sources of entries that are not the list's own, as a --set of one entry leaves them.
void add_other_sources(const Value& list, const std::string& own, std::vector<std::string>& found) {
  for (const Value& entry : list.as_list()) {
    const Origin& origin = entry.origin();
    const std::string shown = shown_origin(origin);
    if (!shown.empty() && origin.source != own &&
        std::find(found.begin(), found.end(), shown) == found.end()) {
      found.push_back(shown);
    }
    if (entry.is_list()) add_other_sources(entry, own, found);
  }
}

std::string comment_of(const Value& value) {
  std::vector<std::string> sources;
  const std::string own = shown_origin(value.origin());
  if (!own.empty()) sources.push_back(own);
  if (value.is_list()) add_other_sources(value, value.origin().source, sources);
  std::string comment;
  for (const std::string& source : sources) comment += (comment.empty() ? "# " : ", ") + source;
  return comment;
}

// Lists of more tables than anybody reads: a measured track.
constexpr std::size_t kLongestShown = 100;

// A table on one line: "{time: 0, position: [0, 0, 2]}".
std::string shown_inline(const Value& value) {
  if (value.is_list()) {
    std::string text = "[";
    for (const Value& entry : value.as_list())
      text += (text.size() > 1 ? ", " : "") + shown_inline(entry);
    return text + "]";
  }
  if (!value.is_map()) return shown_flow(value);
  std::string text = "{";
  for (const auto& [key, child] : value.as_map())
    text += (text.size() > 1 ? ", " : "") + shown_text(key) + ": " + shown_inline(child);
  return text + "}";
}

bool too_long(const Value& value) {
  return value.is_list() && value.as_list().size() > kLongestShown &&
         std::all_of(value.as_list().begin(), value.as_list().end(),
                     [](const Value& entry) { return entry.is_map() || entry.is_list(); });
}

class Printer {
 public:
  explicit Printer(LongLists lists) : lists_(lists) {}

  // `first` begins the first line ("- " of a list entry), the others begin with as many spaces.
  void print(const Value& value, const std::string& first) {
    if (!holds_map(value)) {
      lines_.push_back({first + shown_flow(value), comment_of(value)});
      return;
    }
    std::string prefix = first;
    const std::string indent(first.size(), ' ');
    if (value.is_map()) {
      for (const auto& [key, child] : value.as_map()) {
        if (lists_ == LongLists::shortened && too_long(child)) {
          print_ends(indent + "# " + shown_text(key) + ": ", child.as_list());
          continue;
        }
        print_entry(prefix + shown_text(key) + ":", child, indent);
        prefix = indent;
      }
      if (prefix == first && prefix != indent) lines_.push_back({first + "{}", ""});
    } else {
      for (const Value& child : value.as_list()) {
        print(child, prefix + "- ");
        prefix = indent;
      }
    }
  }

  std::string text() const {
    std::size_t column = 0;
    for (const Line& line : lines_) {
      if (line.comment.empty() || line.text.size() > kWidestAligned) continue;
      column = std::max(column, line.text.size());
    }
    std::string all;
    for (const Line& line : lines_) {
      all += line.text;
      if (!line.comment.empty()) {
        const std::size_t padding = line.text.size() < column ? column - line.text.size() : 0;
        all += std::string(padding + 2, ' ') + line.comment;
      }
      all += '\n';
    }
    return all;
  }

 private:
  void print_ends(const std::string& start, const Value::List& list) {
    lines_.push_back({start + std::to_string(list.size()) + " entries, from " +
                          shown_inline(list.front()) + " to " + shown_inline(list.back()) +
                          "; all of it in a file: > FILE.yaml",
                      ""});
  }

  void print_entry(const std::string& start, const Value& child, const std::string& indent) {
    if (!holds_map(child)) {
      lines_.push_back({start + " " + shown_flow(child), comment_of(child)});
      return;
    }
    lines_.push_back({start, ""});
    print(child, indent + "  ");
  }

  LongLists lists_;
  std::vector<Line> lines_;
};

}  // namespace

std::string annotated_yaml(const Value& value, LongLists lists) {
  Printer printer(lists);
  printer.print(value, "");
  return printer.text();
}

}  // namespace lapwing
