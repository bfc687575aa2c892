// SPDX-License-Identifier: Apache-2.0
// Nonlinear predictive control along the plan, one real-time iteration in each period (horizon.h),
// on the kernel's interior point; and the same with the plan's time as a state.
//
//   controller = "mpc"
//   controller = "contouring:command_delay=0.01"
#include <algorithm>

#include "framework/plugin/plugin.h"
#include "framework/vehicle/controller.h"
#include "framework/vehicle/state_predictor.h"
#include "plugins/controllers/predictive/horizon.h"
#include "plugins/controllers/predictive/observer.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kAtLimit = 1e-3;  // share of the range of thrusts

struct Settings {
  HorizonSettings horizon;
  KnownDelays delays;
  double observer = 0;  // rad/s
  double farthest = 0;  // m
};

class PredictiveFlight final : public ControlledFlight {
 public:
  PredictiveFlight(const Vehicle& vehicle, const BodyReference& reference, const Settings& settings)
      : vehicle_(vehicle),
        s_(settings),
        horizon_(vehicle, reference, settings.horizon),
        predictor_(vehicle, settings.delays),
        observer_(vehicle, settings.observer) {}

  RotorCommand command(double time, const BodyState& state, double step) override {
    const BodyState here = predictor_.predicted(state, step);
    observer_.see(state, predictor_.arrived(), step);
    const double clock = time + s_.delays.command;
    if (!begun_) plan_ = clock, since_ = 0;
    if (!begun_ || since_ + step / 2 >= s_.horizon.period) {
      const ModelError error{observer_.thrust(), observer_.acceleration()};
      const double at = s_.horizon.paced ? plan_ : clock;
      inputs_ = &horizon_.solve(at, begun_ ? since_ : 0, limited(here, at), error);
      since_ = 0;
      begun_ = true;
    }
    RotorCommand command;
    command.thrusts = inputs_->thrusts.front();
    const Rotors& rotors = vehicle_.rotors;
    // An interior point comes near its bounds only.
    const double near = kAtLimit * (rotors.thrust_max - rotors.thrust_min);
    command.saturated = command.thrusts.minCoeff() <= rotors.thrust_min + near ||
                        command.thrusts.maxCoeff() >= rotors.thrust_max - near;
    predictor_.sent(command.thrusts);
    since_ += step;
    plan_ += step * (s_.horizon.paced ? inputs_->paces.front() : 1.0);
    return command;
  }

  double progress(double time) const override {
    return s_.horizon.paced && begun_ ? plan_ - s_.delays.command : time;
  }

 private:
  // Far from the plan the programme is about a nearer state in the same direction.
  BodyState limited(const BodyState& state, double time) const {
    const BodyPoint point = horizon_.wanted(time);
    BodyState near = state;
    const auto limit = [](Vector3d& v, const Vector3d& about, double most) {
      const Vector3d off = v - about;
      if (!off.allFinite())
        v = about;
      else if (const double norm = off.norm(); norm > most)
        v = about + most / norm * off;
    };
    limit(near.position, point.position, s_.farthest);
    limit(near.velocity, point.velocity, 5 * s_.farthest);
    limit(near.body_rates, point.body_rates, 40);
    return near;
  }

  const Vehicle& vehicle_;
  const Settings& s_;
  Horizon horizon_;
  StatePredictor predictor_;
  ModelObserver observer_;
  const Prediction* inputs_ = nullptr;
  bool begun_ = false;
  double since_ = 0, plan_ = 0;  // s, since the last programme; of the plan
};

ParameterTable common(const HorizonSettings& usual) {
  return ParameterTable{}
      .number("horizon", usual.length, "s", "length of the horizon", between(0.05, 5))
      .integer("stages", usual.stages, "number of stages of the horizon", between(2, 100))
      .number("period", usual.period, "s", "time from one quadratic program to the next",
              between(0.001, 0.1))
      .number("position", usual.position, "m", "position error of cost 1", between(0.001, 100))
      .number("velocity", usual.velocity, "m/s", "velocity error of cost 1", between(0.001, 100))
      .number("attitude", usual.attitude, "rad", "attitude error of cost 1", between(0.001, 100))
      .number("rates", usual.rates, "rad/s", "body rate error of cost 1", between(0.001, 1000))
      .number("thrust", usual.thrust, "",
              "thrust difference of cost 1, as a fraction of the largest thrust of a rotor",
              between(0.001, 100))
      .number("terminal", usual.terminal, "s",
              "weight of the error at the end of the horizon, as a time", between(0, 10))
      .number("observer", 8, "rad/s",
              "bandwidth of the estimate of thrust factor and wind; 0: no estimate",
              between(0, 100))
      .number("farthest", 3, "m", "largest position error that is corrected in full",
              between(0.1, 100))
      .number("estimator_delay", 0, "s", "known age of the estimated state", between(0, 0.2))
      .number("command_delay", 0, "s", "known delay of commands", between(0, 0.2));
}

Settings settings_from(const Parameters& p, bool paced) {
  Settings s;
  HorizonSettings& h = s.horizon;
  h.length = p.number("horizon");
  h.stages = static_cast<int>(p.integer("stages"));
  h.period = p.number("period");
  h.position = p.number("position");
  h.velocity = p.number("velocity");
  h.attitude = p.number("attitude");
  h.rates = p.number("rates");
  h.thrust = p.number("thrust");
  h.terminal = p.number("terminal");
  h.paced = paced;
  if (paced)
    h.pace = p.number("pace"), h.slowest = p.number("slowest"), h.quickest = p.number("quickest");
  s.observer = p.number("observer");
  s.farthest = p.number("farthest");
  s.delays = {p.number("estimator_delay"), p.number("command_delay")};
  return s;
}

class Predictive : public Controller {
 public:
  explicit Predictive(const Settings& settings) : settings_(settings) {}
  void follow(const Vehicle& vehicle, const BodyReference& reference) override {
    vehicle_ = &vehicle;
    reference_ = &reference;
  }
  std::unique_ptr<ControlledFlight> begin() const override {
    return std::make_unique<PredictiveFlight>(*vehicle_, *reference_, settings_);
  }

 private:
  Settings settings_;
  const Vehicle* vehicle_ = nullptr;
  const BodyReference* reference_ = nullptr;
};

class Mpc final : public Predictive {
 public:
  static constexpr PluginText kText{"mpc", "1.0.0",
                                    "nonlinear model predictive control of rotor thrusts",
                                    "Diehl, Bock, Schloeder, SIAM J. Control Optim. 43(5), 2005"};
  static ParameterTable parameters() { return common({}); }
  explicit Mpc(const Parameters& parameters) : Predictive(settings_from(parameters, false)) {}
};

class Contouring final : public Predictive {
 public:
  static constexpr PluginText kText{"contouring", "1.0.0",
                                    "as mpc, but the plan time slows for a late vehicle",
                                    "Lam, Manzie, Good, CDC 2010"};
  static ParameterTable parameters() {
    const HorizonSettings usual;
    return common(usual)
        .number("pace", usual.pace, "", "error of the plan rate of cost 1", between(0.001, 100))
        .number("slowest", usual.slowest, "", "smallest plan rate", between(0, 1))
        .number("quickest", usual.quickest, "", "largest plan rate", between(1, 3));
  }
  explicit Contouring(const Parameters& parameters) : Predictive(settings_from(parameters, true)) {}
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Mpc, lapwing::Contouring)
