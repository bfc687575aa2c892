// SPDX-License-Identifier: Apache-2.0
// A route on an instance of the orienteering problem, judged from the text of its file: TSPLIB 95
// section 2, read again by code that shares nothing with the reader.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace lapwing {

class RouteJudge {
 public:
  explicit RouteJudge(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string key;
      words >> key;
      if (const std::size_t colon = line.find(':'); colon != line.npos) {
        if (key.back() == ':') key.pop_back();
        std::istringstream(line.substr(colon + 1)) >> fields_[key];
        continue;
      }
      const auto n = static_cast<std::size_t>(std::stoi("0" + fields_["DIMENSION"]));
      if (key == "NODE_COORD_SECTION") read(lines, n, 2, points_);
      if (key == "NODE_SCORE_SECTION") read(lines, n, 1, scores_);
      if (key == "EDGE_WEIGHT_SECTION") read_weights(lines, n);
      if (key == "DEPOT_SECTION") lines >> depot_;
    }
  }

  // What a loop from the depot collects, with nodes from 0; negative where it is no route.
  double collected(const std::vector<int>& walk) const {
    if (walk.size() < 2 || walk.front() != depot_ - 1 || walk.back() != depot_ - 1) return -1;
    double length = 0, score = 0;
    std::vector<bool> visited(scores_.size(), false);
    for (std::size_t i = 1; i < walk.size(); ++i) {
      const auto here = static_cast<std::size_t>(walk[i]);
      if (visited.at(here)) return -1;
      visited[here] = true;
      score += scores_[here][0];
      length += distance(static_cast<std::size_t>(walk[i - 1]), here);
    }
    return length <= std::stod(fields_.at("COST_LIMIT")) ? score : -1;
  }

  double distance(std::size_t a, std::size_t b) const {
    const std::string& type = fields_.at("EDGE_WEIGHT_TYPE");
    if (type == "EXPLICIT") return weights_.at(a).at(b);
    const double x1 = points_.at(a)[0], y1 = points_[a][1], x2 = points_.at(b)[0],
                 y2 = points_[b][1];
    const double length = std::sqrt((x1 - x2) * (x1 - x2) + (y1 - y2) * (y1 - y2));
    if (type == "EUC_2D") return static_cast<double>(std::lround(length));
    if (type == "CEIL_2D") return std::ceil(length);
    if (type == "ATT") {  // the length over the root of ten, up where rounding would shorten it
      const double root = std::sqrt(((x1 - x2) * (x1 - x2) + (y1 - y2) * (y1 - y2)) / 10);
      const auto whole = static_cast<double>(std::lround(root));
      return whole < root ? whole + 1 : whole;
    }
    if (type != "GEO") throw std::runtime_error("the judge does not know " + type);
    const auto radians = [](double value) {
      const int degrees = static_cast<int>(value);
      return 3.141592 * (degrees + 5.0 * (value - degrees) / 3.0) / 180.0;
    };
    const double q1 = std::cos(radians(y1) - radians(y2));
    const double q2 = std::cos(radians(x1) - radians(x2));
    const double q3 = std::cos(radians(x1) + radians(x2));
    return static_cast<int>(6378.388 * std::acos(0.5 * ((1 + q1) * q2 - (1 - q1) * q3)) + 1);
  }

 private:
  using Rows = std::vector<std::vector<double>>;

  static void read(std::istringstream& words, std::size_t n, std::size_t count, Rows& rows) {
    rows.assign(n, std::vector<double>(count));
    std::size_t node = 0;
    for (std::size_t i = 0; i < n; ++i) {
      words >> node;
      for (double& number : rows.at(node - 1)) words >> number;
    }
  }

  void read_weights(std::istringstream& words, std::size_t n) {
    const std::string format = fields_["EDGE_WEIGHT_FORMAT"];
    weights_.assign(n, std::vector<double>(n, 0));
    for (std::size_t row = 0; row < n; ++row) {
      std::size_t from = 0, to = n;
      if (format == "LOWER_DIAG_ROW" || format == "LOWER_ROW") {
        to = row + (format == "LOWER_DIAG_ROW");
      } else if (format == "UPPER_DIAG_ROW" || format == "UPPER_ROW") {
        from = row + (format == "UPPER_ROW");
      } else if (format != "FULL_MATRIX") {
        throw std::runtime_error("the judge does not know " + format);
      }
      for (std::size_t column = from; column < to; ++column) {
        words >> weights_[row][column];
        weights_[column][row] = weights_[row][column];
      }
    }
  }

  std::map<std::string, std::string> fields_;
  Rows points_, scores_, weights_;
  int depot_ = 0;
};

}  // namespace lapwing
