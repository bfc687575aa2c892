// SPDX-License-Identifier: Apache-2.0
// A flight as polynomials of time in pieces: x, y, z and yaw.
//
//   lapwing export out/hello/plan.json --format poly4d:layout=yaml -o hello.yaml
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/camera_track.h"
#include "framework/export/exporter.h"
#include "framework/plugin/plugin.h"
#include "framework/trajectory/interpolate.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {
namespace {

constexpr int kCoefficients = 8;
constexpr double kStep = 0.02;         // s, at most, between samples of the flight
constexpr double kRounding = 1e-6;     // m/s, rad/s
constexpr int kTried = 24;             // places of a piece that are compared
constexpr std::size_t kLongest = 600;  // samples of a piece

using Coefficients = std::array<double, kCoefficients>;  // of 1, t, t^2, ...

struct Piece {
  double duration = 0;                 // s
  std::array<Coefficients, 4> axes{};  // x, y, z, yaw
};

double value_of(const Coefficients& c, double t) {
  double value = 0;
  for (int i = kCoefficients; i-- > 0;) value = value * t + c[static_cast<std::size_t>(i)];
  return value;
}

double rate_of(const Coefficients& c, double t) {
  double rate = 0;
  for (int i = kCoefficients; i-- > 1;) rate = rate * t + i * c[static_cast<std::size_t>(i)];
  return rate;
}

// The largest rates of a flight: m/s across, up and down, rad/s of yaw.
struct Rates {
  double across = 0, up = 0, down = 0, yaw = 0;

  void take(const Eigen::Vector3d& velocity, double yaw_rate) {
    across = std::max(across, velocity.head<2>().norm());
    up = std::max(up, velocity.z());
    down = std::max(down, -velocity.z());
    yaw = std::max(yaw, std::abs(yaw_rate));
  }
  bool within(const Rates& most) const {
    const auto fits = [](double rate, double limit) { return rate <= limit + kRounding; };
    return fits(across, most.across) && fits(up, most.up) && fits(down, most.down) &&
           fits(yaw, most.yaw);
  }
};

// What pieces may have: the vehicle's limits, or what the plan itself has beyond them.
Rates most_rates(const Plan& plan) {
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  Rates most{vehicle.speed_across_max, vehicle.climb_speed_max, vehicle.descent_speed_max,
             vehicle.yaw_rate_max};
  for (const Sample& s : plan.trajectory.samples) most.take(s.velocity, s.yaw_rate);
  return most;
}

Rates rates_of(const Piece& piece) {
  Rates rates;
  for (int i = 0; i <= kTried; ++i) {
    const double t = piece.duration * i / kTried;
    rates.take({rate_of(piece.axes[0], t), rate_of(piece.axes[1], t), rate_of(piece.axes[2], t)},
               rate_of(piece.axes[3], t));
  }
  return rates;
}

// The polynomial of fifth order with these values, rates and second rates at both ends.
Coefficients quintic(double p0, double v0, double a0, double p1, double v1, double a1, double h) {
  const double d = p1 - p0 - v0 * h - a0 / 2 * h * h;
  const double dv = v1 - v0 - a0 * h, da = a1 - a0;
  return {p0,
          v0,
          a0 / 2,
          (10 * d - 4 * dv * h + da / 2 * h * h) / (h * h * h),
          (-15 * d + 7 * dv * h - da * h * h) / (h * h * h * h),
          (6 * d - 3 * dv * h + da / 2 * h * h) / (h * h * h * h * h),
          0,
          0};
}

Coefficients cubic(double p0, double v0, double p1, double v1, double h) {
  const double d = p1 - p0;
  return {p0, v0, (3 * d / h - 2 * v0 - v1) / h, (v0 + v1 - 2 * d / h) / (h * h), 0, 0, 0, 0};
}

Piece piece_between(const Sample& a, const Sample& b, bool moves) {
  Piece piece;
  const double h = piece.duration = b.time - a.time;
  for (int axis = 0; axis < 3; ++axis) {
    const double slope = (b.position[axis] - a.position[axis]) / h;
    piece.axes[static_cast<std::size_t>(axis)] =
        moves ? quintic(a.position[axis], a.velocity[axis], a.acceleration[axis], b.position[axis],
                        b.velocity[axis], b.acceleration[axis], h)
              : Coefficients{a.position[axis], slope};
  }
  piece.axes[3] = moves ? cubic(a.yaw, a.yaw_rate, b.yaw, b.yaw_rate, h)
                        : Coefficients{a.yaw, (b.yaw - a.yaw) / h};
  return piece;
}

struct PieceError {
  double distance = 0, yaw = 0;  // m, rad
};

PieceError error_of(const Piece& piece, const Trajectory& trajectory, double start) {
  PieceError worst;
  for (int i = 0; i <= kTried; ++i) {
    const double t = piece.duration * i / kTried;
    const double time = std::min(start + t, trajectory.samples.back().time);
    const Sample wanted = sample_at(trajectory, time);
    const Eigen::Vector3d shown(value_of(piece.axes[0], t), value_of(piece.axes[1], t),
                                value_of(piece.axes[2], t));
    worst.distance = std::max(worst.distance, (shown - wanted.position).norm());
    worst.yaw = std::max(worst.yaw, std::abs(value_of(piece.axes[3], t) - wanted.yaw));
  }
  return worst;
}

void put(std::string& out, double number) {
  char buffer[40];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, number + 0.0);
  out.append(buffer, result.ptr);
}

class Poly4d final : public Exporter {
 public:
  static constexpr PluginText kText{"poly4d", "1.0.0",
                                    "polynomials of x, y, z and yaw in pieces (.csv, .yaml)",
                                    "https://crazyswarm.readthedocs.io, "
                                    "https://github.com/ethz-asl/mav_trajectory_generation"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .choice("layout", "csv", {"csv", "yaml"},
                "csv of Crazyswarm, or yaml of mav_trajectory_generation")
        .number("tolerance", 0.005, "m", "largest distance from the plan", between(1e-5, 1))
        .number("yaw_tolerance", 0.5, "deg", "largest difference in yaw", between(1e-3, 90));
  }
  explicit Poly4d(const Parameters& parameters)
      : yaml_(parameters.text("layout") == "yaml"),
        tolerance_(parameters.number("tolerance")),
        yaw_tolerance_(radians(parameters.number("yaw_tolerance"))) {}

  std::string file_extension() const override { return yaml_ ? ".yaml" : ".csv"; }

  std::string write(const Plan& plan) const override {
    const std::vector<Piece> pieces = pieces_of(plan);
    return yaml_ ? yaml_text(pieces, plan) : csv_text(pieces, plan);
  }

  std::vector<std::string> losses(const Plan& plan, const std::string& written) const override {
    const std::vector<Piece> pieces = pieces_in(written);
    PieceError worst;
    double at = plan.trajectory.samples.front().time, when = at;
    for (const Piece& piece : pieces) {
      const PieceError error = error_of(piece, plan.trajectory, at);
      if (error.distance > worst.distance) worst.distance = error.distance, when = at;
      worst.yaw = std::max(worst.yaw, error.yaw);
      at += piece.duration;
    }
    return {std::to_string(pieces.size()) + " pieces of order 7 or less; frame: x east, y north, " +
                "z up of the plan's world, in metres",
            "evaluated, they are at most " + plain_number(1000 * worst.distance, 3) +
                " mm (in the piece at " + plain_number(when, 4) + " s) and " +
                plain_number(degrees(worst.yaw), 3) + " deg of yaw from the plan",
            "the camera is not in it"};
  }

  // The pieces, evaluated. The camera is not in them.
  std::optional<FlownFile> flown(const Plan& plan, const std::string& written) const override {
    FlownFile flown;
    flown.start = plan.trajectory.samples.front().time;
    flown.finish = plan.trajectory.samples.back().time;
    flown.trajectory.motion = path_motion();
    double start = 0;
    for (const Piece& piece : pieces_in(written)) {
      const int steps = std::max(1, static_cast<int>(std::ceil(piece.duration / kStep)));
      for (int i = flown.trajectory.samples.empty() ? 0 : 1; i <= steps; ++i) {
        const double t = piece.duration * i / steps;
        Sample s;
        s.time = start + t;
        for (int axis = 0; axis < 3; ++axis)
          s.position[axis] = value_of(piece.axes[static_cast<std::size_t>(axis)], t);
        s.yaw = value_of(piece.axes[3], t);
        flown.trajectory.samples.push_back(s);
      }
      start += piece.duration;
    }
    if (flown.trajectory.samples.empty()) throw InputError("poly4d: expected a piece, got none");
    return flown;
  }

 private:
  std::vector<Piece> pieces_in(const std::string& written) const {
    return yaml_ ? yaml_pieces(written) : csv_pieces(written);
  }

  // Each as long as it holds the tolerances; ends are samples of the plan.
  std::vector<Piece> pieces_of(const Plan& plan) const {
    const auto& samples = plan.trajectory.samples;
    if (samples.size() < 2)
      throw InputError("poly4d: the flight of '" + plan.mission + "' has no length");
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (!samples[i].position.allFinite() || !std::isfinite(samples[i].yaw) ||
          (i > 0 && !(samples[i].time > samples[i - 1].time)))
        throw InputError("poly4d: expected finite numbers, at increasing times");
    std::vector<Piece> pieces;
    const Rates most = most_rates(plan);
    for (std::size_t i = 0; i + 1 < samples.size();) {
      const std::size_t end = last_end(plan.trajectory, most, i);
      pieces.push_back(piece_between(samples[i], samples[end], plan.trajectory.motion.moves));
      i = end;
    }
    return pieces;
  }

  // Between two samples the polynomial has the rates that it has.
  bool holds(const Trajectory& trajectory, const Rates& most, std::size_t from,
             std::size_t to) const {
    const auto& samples = trajectory.samples;
    const Piece piece = piece_between(samples[from], samples[to], trajectory.motion.moves);
    const PieceError error = error_of(piece, trajectory, samples[from].time);
    if (to > from + 1 && !rates_of(piece).within(most)) return false;
    return error.distance <= 0.9 * tolerance_ && error.yaw <= 0.9 * yaw_tolerance_;
  }

  // Doubles the length until it holds no more, then halves the rest. InputError where not even one
  // step holds.
  std::size_t last_end(const Trajectory& trajectory, const Rates& most, std::size_t from) const {
    const std::size_t last = std::min(trajectory.samples.size() - 1, from + kLongest);
    if (!holds(trajectory, most, from, from + 1))
      throw InputError("poly4d: between " + plain_number(trajectory.samples[from].time) +
                       " s and the next sample no polynomial is within the tolerance of " +
                       plain_number(1000 * tolerance_) + " mm; a larger `tolerance` is needed");
    std::size_t good = from + 1, bad = last + 1;
    for (std::size_t step = 2; good < last && bad > last; step *= 2) {
      const std::size_t next = std::min(from + step, last);
      if (holds(trajectory, most, from, next))
        good = next;
      else
        bad = next;
    }
    while (bad - good > 1 && bad <= last) {
      const std::size_t middle = (good + bad) / 2;
      (holds(trajectory, most, from, middle) ? good : bad) = middle;
    }
    return good;
  }

  // The first row is a header, which readers skip.
  static std::string csv_text(const std::vector<Piece>& pieces, const Plan& plan) {
    std::string out = "duration";
    for (const char* axis : {"x", "y", "z", "yaw"})
      for (int i = 0; i < kCoefficients; ++i)
        out += std::string(",") + axis + "^" + std::to_string(i);
    if (!states_certified(plan)) out += ",not certified";
    out += '\n';
    for (const Piece& piece : pieces) {
      put(out, piece.duration);
      for (const Coefficients& axis : piece.axes)
        for (const double c : axis) {
          out += ',';
          put(out, c);
        }
      out += '\n';
    }
    return out;
  }

  static std::vector<Piece> csv_pieces(const std::string& text) {
    std::vector<Piece> pieces;
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream words(line);
      Piece piece;
      words >> piece.duration;
      for (Coefficients& axis : piece.axes)
        for (double& c : axis) words >> c;
      if (!words) throw InputError("poly4d: a row has fewer than 33 numbers");
      pieces.push_back(piece);
    }
    return pieces;
  }

  // Times are whole nanoseconds.
  static std::string yaml_text(const std::vector<Piece>& pieces, const Plan& plan) {
    std::string out = states_certified(plan) ? "segments:\n" : "# not certified\nsegments:\n";
    for (const Piece& piece : pieces) {
      out += "  - N: 8\n    D: 4\n    time: " + std::to_string(std::llround(piece.duration * 1e9)) +
             "\n    coefficients:\n";
      for (const Coefficients& axis : piece.axes) {
        out += "      - [";
        for (std::size_t i = 0; i < axis.size(); ++i) {
          if (i > 0) out += ", ";
          put(out, axis[i]);
        }
        out += "]\n";
      }
    }
    return out;
  }

  static std::vector<Piece> yaml_pieces(const std::string& text) {
    std::vector<Piece> pieces;
    std::istringstream lines(text);
    std::size_t axis = 0;
    for (std::string line; std::getline(lines, line);) {
      if (const std::size_t at = line.find("time: "); at != std::string::npos) {
        pieces.emplace_back();
        pieces.back().duration = std::strtod(line.c_str() + at + 6, nullptr) / 1e9;
        axis = 0;
      }
      const std::size_t at = line.find('[');
      if (at == std::string::npos) continue;
      if (pieces.empty() || axis > 3) throw InputError("poly4d: coefficients of no segment");
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream words(line.substr(at + 1));
      for (double& c : pieces.back().axes[axis]) words >> c;
      if (!words) throw InputError("poly4d: fewer than 8 coefficients");
      ++axis;
    }
    return pieces;
  }

  bool yaml_;
  double tolerance_, yaw_tolerance_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Poly4d)
