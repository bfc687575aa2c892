// SPDX-License-Identifier: Apache-2.0
#include "framework/view/orienteering_file.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

constexpr int kMostNodes = 10'000;  // a matrix of 800 MB

struct Node {
  double x = 0, y = 0;
};
using Distance = double (*)(const Node&, const Node&);

double rounded(const Node& a, const Node& b) {
  return std::floor(std::hypot(a.x - b.x, a.y - b.y) + 0.5);
}
double rounded_up(const Node& a, const Node& b) {
  return std::ceil(std::hypot(a.x - b.x, a.y - b.y));
}
double exact(const Node& a, const Node& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

// Degrees and minutes, as DDD.MM, with TSPLIB's own pi.
double geographic(const Node& a, const Node& b) {
  constexpr double kPi = 3.141592, kEarth = 6378.388;
  const auto radians = [&](double x) {
    const double degrees = std::trunc(x);
    return kPi * (degrees + 5 * (x - degrees) / 3) / 180;
  };
  const double q1 = std::cos(radians(a.y) - radians(b.y));
  const double q2 = std::cos(radians(a.x) - radians(b.x));
  const double q3 = std::cos(radians(a.x) + radians(b.x));
  return std::trunc(kEarth * std::acos(0.5 * ((1 + q1) * q2 - (1 - q1) * q3)) + 1);
}

double pseudo_euclidean(const Node& a, const Node& b) {
  const double r = std::sqrt(((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y)) / 10);
  const double t = std::floor(r + 0.5);
  return t < r ? t + 1 : t;
}

std::vector<double> matrix_of(const std::vector<Node>& nodes, Distance distance) {
  const std::size_t n = nodes.size();
  std::vector<double> legs(n * n, 0);
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      legs[a * n + b] = legs[b * n + a] = distance(nodes[a], nodes[b]);
    }
  }
  return legs;
}

// Words with the line that each stands in.
class Words {
 public:
  Words(std::string_view text, std::string source, int line = 1)
      : text_(text), source_(std::move(source)), line_(line) {}
  // The number in a text that stood in this line.
  Words part(std::string_view text) const { return {text, source_, line_}; }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(Origin{source_, line_}, what);
  }
  // The next word, "" at the end.
  std::string_view next() {
    while (at_ < text_.size() && blank(text_[at_])) {
      if (text_[at_++] == '\n') ++line_;
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && !blank(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  std::size_t left() const { return text_.size() - at_; }  // bytes
  // What is left of this line, without blanks around it.
  std::string rest() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end;
    while (!line.empty() && (blank(line.front()) || line.front() == ':')) line.remove_prefix(1);
    while (!line.empty() && blank(line.back())) line.remove_suffix(1);
    return std::string(line);
  }
  double number(const char* what) {
    const std::string_view word = next();
    double value = 0;
    const auto end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (word.empty() || stop != end || error != std::errc() || !std::isfinite(value)) {
      fail(std::string(what) + " must be a finite number, not '" + std::string(word) + "'");
    }
    return value;
  }
  int integer(const char* what, int low, int high) {
    const double value = number(what);
    if (value != std::floor(value) || value < low || value > high) {
      fail(std::string(what) + " must be a whole number from " + std::to_string(low) + " to " +
           std::to_string(high));
    }
    return static_cast<int>(value);
  }

 private:
  static bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  std::string_view text_;
  std::string source_;
  std::size_t at_ = 0;
  int line_;
};

class TsplibReader {
 public:
  TsplibReader(std::string_view text, const std::string& source) : words_(text, source) {}

  OrienteeringInstance read() {
    for (;;) {
      std::string key(words_.next());
      if (key.empty() || key == "EOF") break;
      if (key.back() == ':') key.pop_back();
      if (!section(key)) fields_[key] = header(key);
    }
    return finish();
  }

 private:
  std::string header(const std::string& key) {
    for (const char* known :
         {"NAME", "TYPE", "COMMENT", "DIMENSION", "COST_LIMIT", "EDGE_WEIGHT_TYPE",
          "EDGE_WEIGHT_FORMAT", "DISPLAY_DATA_TYPE", "NODE_COORD_TYPE"}) {
      if (key != known) continue;
      const std::string value = words_.rest();
      if (key == "DIMENSION") take_dimension(value);
      if (key == "TYPE" && value != "OP") words_.fail("TYPE must be OP, not " + value);
      return value;
    }
    words_.fail("'" + key + "' is not a field of an orienteering problem");
  }

  void take_dimension(const std::string& value) {
    n_ = words_.part(value).integer("DIMENSION", 1, kMostNodes);
  }

  bool section(const std::string& key) {
    const bool known = key == "NODE_COORD_SECTION" || key == "DISPLAY_DATA_SECTION" ||
                       key == "EDGE_WEIGHT_SECTION" || key == "NODE_SCORE_SECTION" ||
                       key == "DEPOT_SECTION";
    if (!known) return false;
    if (n_ == 0) words_.fail(key + " comes before DIMENSION");
    if (key == "NODE_COORD_SECTION") nodes_ = nodes();
    if (key == "DISPLAY_DATA_SECTION") nodes();
    if (key == "EDGE_WEIGHT_SECTION") weights();
    if (key == "NODE_SCORE_SECTION") scores();
    if (key == "DEPOT_SECTION") depot();
    return true;
  }

  int node() { return words_.integer("a node's number", 1, n_) - 1; }

  std::vector<Node> nodes() {
    std::vector<Node> nodes(n_);
    for (int i = 0; i < n_; ++i) {
      const int v = node();
      nodes[v].x = words_.number("a coordinate");
      nodes[v].y = words_.number("a coordinate");
    }
    return nodes;
  }

  void weights() {
    const std::string format = fields_["EDGE_WEIGHT_FORMAT"];
    const std::size_t n = n_;
    // The smallest of the formats has a number, and a blank, for every two nodes.
    if (n * (n - 1) > words_.left() + 1) {
      words_.fail("the file ends before the distances between " + std::to_string(n) +
                  " nodes (DIMENSION) could");
    }
    legs_.assign(n * n, 0);
    const auto take = [&](std::size_t a, std::size_t b) {
      legs_[a * n + b] = words_.number("a distance");
      if (format != "FULL_MATRIX") legs_[b * n + a] = legs_[a * n + b];
    };
    for (std::size_t a = 0; a < n; ++a) {
      if (format == "FULL_MATRIX") {
        for (std::size_t b = 0; b < n; ++b) take(a, b);
      } else if (format == "LOWER_DIAG_ROW" || format == "LOWER_ROW") {
        for (std::size_t b = 0; b < a + (format == "LOWER_DIAG_ROW"); ++b) take(a, b);
      } else if (format == "UPPER_DIAG_ROW" || format == "UPPER_ROW") {
        for (std::size_t b = a + (format == "UPPER_ROW"); b < n; ++b) take(a, b);
      } else {
        words_.fail("EDGE_WEIGHT_FORMAT '" + format + "' is not known; LOWER_DIAG_ROW is");
      }
    }
  }

  void scores() {
    scores_.assign(n_, 0);
    for (int i = 0; i < n_; ++i) {
      const int v = node();
      scores_[v] = words_.number("a score");
    }
  }

  void depot() {
    depot_ = node();
    if (words_.number("the end of the depots") != -1) words_.fail("there must be one depot");
  }

  OrienteeringInstance finish() {
    static const std::map<std::string, Distance> kDistances{{"EUC_2D", rounded},
                                                            {"CEIL_2D", rounded_up},
                                                            {"GEO", geographic},
                                                            {"ATT", pseudo_euclidean}};
    if (n_ == 0) words_.fail("there is no DIMENSION");
    if (scores_.empty()) words_.fail("there is no NODE_SCORE_SECTION");
    if (!depot_) words_.fail("there is no DEPOT_SECTION");
    const std::string type = fields_["EDGE_WEIGHT_TYPE"];
    OrienteeringInstance instance;
    TourDefinition& d = instance.definition;
    if (type == "EXPLICIT") {
      if (legs_.empty()) words_.fail("there is no EDGE_WEIGHT_SECTION");
      d.legs = std::move(legs_);
    } else {
      const auto found = kDistances.find(type);
      if (found == kDistances.end()) words_.fail("EDGE_WEIGHT_TYPE '" + type + "' is not known");
      if (nodes_.empty()) words_.fail("there is no NODE_COORD_SECTION");
      d.legs = matrix_of(nodes_, found->second);
    }
    d.budget = words_.part(fields_["COST_LIMIT"]).number("COST_LIMIT");
    d.score = std::make_shared<const ViewScore>(additive_score(scores_));
    d.view_seconds = {0};
    d.start = d.end = *depot_;
    instance.name = fields_["NAME"];
    return instance;
  }

  Words words_;
  std::map<std::string, std::string> fields_;
  int n_ = 0;
  std::vector<Node> nodes_;
  std::vector<double> legs_, scores_;
  std::optional<int> depot_;
};

OrienteeringInstance read_plain(std::string_view text, const std::string& source) {
  Words words(text, source);
  OrienteeringInstance instance;
  instance.definition.budget = words.number("the budget");
  if (words.integer("the number of paths", 0, 1'000) != 1) words.fail("one path only");
  std::vector<Node> nodes;
  std::vector<double> scores;
  for (;;) {
    Words ahead = words;
    if (ahead.next().empty()) break;
    nodes.push_back({words.number("x"), words.number("y")});
    scores.push_back(words.number("a score"));
    if (nodes.size() > static_cast<std::size_t>(kMostNodes)) words.fail("too many points");
  }
  if (nodes.size() < 2) words.fail("there must be two points at least: start and end");
  instance.definition.legs = matrix_of(nodes, exact);
  instance.definition.score = std::make_shared<const ViewScore>(additive_score(scores));
  instance.definition.view_seconds = {0};
  instance.definition.start = 0;
  instance.definition.end = 1;
  return instance;
}

}  // namespace

OrienteeringInstance read_orienteering(std::string_view text, const std::string& source) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) throw InputError(Origin{source, 1}, "the file is empty");
  const bool number = text[first] == '-' || text[first] == '.' ||
                      std::isdigit(static_cast<unsigned char>(text[first]));
  return number ? read_plain(text, source) : TsplibReader(text, source).read();
}

OrienteeringInstance read_orienteering_file(const std::filesystem::path& path) {
  return read_orienteering(read_file(path), path.string());
}

}  // namespace lapwing
