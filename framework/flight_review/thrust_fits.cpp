// SPDX-License-Identifier: Apache-2.0
// Thrust and lag of the rotors: specific force along the thrust against the commands before it.
#include <cmath>

#include "framework/core/units.h"
#include "framework/flight_review/fit_blocks.h"
#include "framework/flight_review/shown_fits.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kCommandHeld = 0.5;  // s, that a command counts without a newer one
constexpr double kLongestLag = 0.3;   // s

// What the flight shows along the body's z axis at a time.
struct LiftRow {
  double time = 0, lift = 0;   // s, m/s^2
  double rise = 0;             // m/s, velocity along the body's z axis
  double east = 0, north = 0;  // of that axis: the share of the wind along it
};

// Velocity between two states, from those and their accelerations.
Vector3d velocity_between(const ShownState& a, const ShownState& b, double share, double step) {
  const double u = share, u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * a.velocity + (u3 - 2 * u2 + u) * step * a.acceleration +
         (3 * u2 - 2 * u3) * b.velocity + (u3 - u2) * step * b.acceleration;
}

void add_row(const ShownMotion& motion, const FlightLog& log, double time, double lift,
             std::vector<LiftRow>& rows) {
  const double place = (time - motion.states.front().time) / motion.step;
  if (place < 0 || place + 1 >= static_cast<double>(motion.states.size())) return;
  const auto i = static_cast<std::size_t>(place);
  const ShownState &before = motion.states[i], &after = motion.states[i + 1];
  if (!before.airborne || !after.airborne) return;
  const Vector3d velocity = velocity_between(before, after, place - std::floor(place), motion.step);
  Vector3d axis = Vector3d::UnitZ();
  if (const auto q = value_at(log, "orientation", time))
    axis = Eigen::Quaterniond((*q)[0], (*q)[1], (*q)[2], (*q)[3]) * axis;
  rows.push_back({time, lift, axis.dot(velocity), axis.x(), axis.y()});
}

// As the accelerometer shows it; without one, as attitude and acceleration do.
std::vector<LiftRow> lift_rows(const FlightLog& log, const ShownMotion& motion) {
  std::vector<LiftRow> rows;
  if (const LogSeries* force = log.find("specific_force")) {
    for (std::size_t i = 0; i < force->size(); ++i)
      add_row(motion, log, force->times[i], force->values[3 * i + 2], rows);
    return rows;
  }
  for (const ShownState& s : motion.states)
    if (s.orientation)
      add_row(motion, log, s.time,
              (s.orientation->conjugate() * (s.acceleration + Vector3d(0, 0, kGravity))).z(), rows);
  return rows;
}

// A lag and an exponent that are tried.
struct TriedLaw {
  double lag = 0, exponent = 1;
};

// Calls `take` with each row and throttle^p behind its lag, for each that is tried. Commands are
// held until the next; what follows them is exact between them.
void follow(const LogSeries& throttle, const std::vector<LiftRow>& rows,
            const std::vector<TriedLaw>& tried,
            const std::function<void(const LiftRow&, const Eigen::ArrayXd&)>& take) {
  const auto count = static_cast<Eigen::Index>(tried.size());
  Eigen::ArrayXd lag(count), exponent(count), input(count), followed(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    lag[k] = std::max(1e-6, tried[static_cast<std::size_t>(k)].lag);
    exponent[k] = tried[static_cast<std::size_t>(k)].exponent;
  }
  double now = 0;
  std::size_t next = 0;
  const auto advance = [&](double to) {
    if (to > now) followed = input + (followed - input) * (-(to - now) / lag).exp();
    now = to;
  };
  for (const LiftRow& row : rows) {
    for (; next < throttle.size() && throttle.times[next] <= row.time; ++next) {
      if (next > 0) advance(throttle.times[next]);
      input = (exponent * std::log(std::max(1e-9, throttle.values[next]))).exp();
      if (next == 0) followed = input, now = throttle.times[0];
    }
    if (next == 0 || row.time - throttle.times[next - 1] > kCommandHeld) continue;
    advance(row.time);
    take(row, followed);
  }
}

// Sums of one block for each number of an even grid.
template <int N>
struct GridSums {
  double first = 0, step = 0;
  std::vector<NormalSums<N>> sums;
  double rows = 0;

  void add(const GridSums& other) {
    if (sums.empty()) {
      *this = other;
      return;
    }
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k].add(other.sums[k]);
    rows += other.rows;
  }
  // The place in the grid with the least squares, by the parabola through three.
  double place() const {
    std::vector<double> misses;
    for (const auto& one : sums) misses.push_back(one.misses());
    const auto at =
        static_cast<std::size_t>(std::min_element(misses.begin(), misses.end()) - misses.begin());
    if (at == 0 || at + 1 == sums.size()) return static_cast<double>(at);
    const double a = misses[at - 1], b = misses[at], c = misses[at + 1], bend = a - 2 * b + c;
    return static_cast<double>(at) + (bend > 0 ? 0.5 * (a - c) / bend : 0);
  }
  double best() const { return first + step * place(); }
  // m/s^2 of the full throttle there.
  double full() const {
    const double at = place();
    const auto i = std::min(static_cast<std::size_t>(at), sums.size() - 2);
    const double a = sums[i].solved()[0], b = sums[i + 1].solved()[0];
    return a + (at - static_cast<double>(i)) * (b - a);
  }
};

struct GridOf {
  double first = 0, step = 0;
  int count = 0;
};

class ThrustData {
 public:
  ThrustData(const FlightLog& log, const ShownMotion& motion)
      : motion_(motion), throttle_(log.find("throttle")), measured_(log.find("specific_force")) {
    if (throttle_) rows_ = lift_rows(log, motion);
  }

  // No constant: it would take the place of the exponent.
  std::vector<GridSums<4>> by_exponent(const GridOf& grid, double lag) const {
    std::vector<TriedLaw> tried;
    for (int k = 0; k < grid.count; ++k) tried.push_back({lag, grid.first + grid.step * k});
    return collected<4>(grid, tried, [](const LiftRow& row, double followed) {
      return Eigen::Vector4d(followed, -row.rise, row.east, row.north);
    });
  }
  std::vector<GridSums<5>> by_lag(const GridOf& grid, double exponent) const {
    std::vector<TriedLaw> tried;
    for (int k = 0; k < grid.count; ++k) tried.push_back({grid.first + grid.step * k, exponent});
    return collected<5>(grid, tried, [](const LiftRow& row, double followed) {
      return Eigen::Matrix<double, 5, 1>(followed, -row.rise, row.east, row.north, 1);
    });
  }
  // s; NaN where there are no data.
  double lag(double exponent) const { return found(by_lag(kLags, exponent)); }
  double exponent(double lag) const { return found(by_exponent(kExponents, lag)); }

  double time() const {
    double sum = 0;
    for (std::size_t i = 1; i < rows_.size(); ++i)
      sum += std::min(0.1, rows_[i].time - rows_[i - 1].time);
    return sum;
  }
  bool measured() const { return measured_; }

  static constexpr GridOf kLags{0, 0.005, 61}, kExponents{0.2, 0.1, 31};

 private:
  template <int N>
  static double found(const std::vector<GridSums<N>>& blocks) {
    GridSums<N> all;
    for (const auto& block : blocks) all.add(block);
    return blocks.empty() ? NAN : all.best();
  }

  template <int N, class RowOf>
  std::vector<GridSums<N>> collected(const GridOf& grid, const std::vector<TriedLaw>& tried,
                                     const RowOf& row_of) const {
    std::map<std::size_t, GridSums<N>> blocks;
    if (!throttle_) return {};
    follow(*throttle_, rows_, tried, [&](const LiftRow& row, const Eigen::ArrayXd& followed) {
      GridSums<N>& block = blocks[block_of(motion_, row.time)];
      if (block.sums.empty()) {
        block.first = grid.first, block.step = grid.step;
        block.sums.resize(tried.size());
      }
      for (std::size_t k = 0; k < tried.size(); ++k)
        block.sums[k].add(row_of(row, followed[static_cast<Eigen::Index>(k)]), row.lift);
      ++block.rows;
    });
    return filled(std::move(blocks));
  }

  const ShownMotion& motion_;
  const LogSeries* throttle_;
  bool measured_;
  std::vector<LiftRow> rows_;
};

// Around a number, within bounds.
GridOf around(double middle, double step, int each_way, double least, double most) {
  const double first = std::max(least, middle - step * each_way);
  const double last = std::min(most, middle + step * each_way);
  return {first, step, std::max(3, static_cast<int>(std::lround((last - first) / step)) + 1)};
}

}  // namespace

std::optional<ThrustFit> fit_thrust(const FlightLog& log, const ShownMotion& motion) {
  const ThrustData data(log, motion);
  // Lag and exponent hardly depend on each other.
  double lag = data.lag(1), exponent = NAN;
  for (int round = 0; round < 2 && std::isfinite(lag); ++round) {
    exponent = data.exponent(lag);
    lag = data.lag(exponent);
  }
  if (!std::isfinite(exponent)) return std::nullopt;
  const auto fine = data.by_lag(around(lag, 0.0005, 20, 0, kLongestLag), exponent);
  GridSums<5> lags;
  for (const auto& block : fine) lags.add(block);
  const auto blocks = data.by_exponent(around(exponent, 0.02, 20, 0.1, 4), lags.best());
  if (blocks.size() < kLeastBlocks) return std::nullopt;
  ThrustFit fit;
  using Sums = GridSums<4>;
  fit.full = interval<Sums>(blocks, data.time(), [](const Sums& b) { return b.full(); });
  fit.exponent = interval<Sums>(blocks, data.time(), [](const Sums& b) { return b.best(); });
  fit.full.measured = fit.exponent.measured = data.measured();
  const bool clear = fit.exponent.low > 0.3 && fit.exponent.high < 3 &&
                     fit.exponent.high - fit.exponent.low < 0.6 &&
                     fit.full.high - fit.full.low < 0.3 * fit.full.value;
  return clear ? std::optional(fit) : std::nullopt;
}

std::optional<FitResult> fit_lag(const FlightLog& log, const ShownMotion& motion, double exponent) {
  if (!log.find("specific_force")) return std::nullopt;
  const ThrustData data(log, motion);
  const double coarse = data.lag(exponent);
  if (!std::isfinite(coarse)) return std::nullopt;
  using Sums = GridSums<5>;
  const auto figure = [](const Sums& b) { return b.best(); };
  std::vector<Sums> blocks = data.by_lag(ThrustData::kLags, exponent);
  if (blocks.size() < kLeastBlocks) return std::nullopt;
  FitResult fit = interval<Sums>(blocks, data.time(), figure);
  if (fit.high - fit.low < 0.02)  // fine enough that the parabola does not matter
    fit = interval<Sums>(data.by_lag(around(coarse, 0.0005, 40, 0, kLongestLag), exponent),
                         data.time(), figure);
  const bool clear = fit.high - fit.low < 0.05 && fit.low > 0.005 && fit.value < 0.29;
  return clear ? std::optional(fit) : std::nullopt;
}

}  // namespace lapwing
