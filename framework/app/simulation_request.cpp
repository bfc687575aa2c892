// SPDX-License-Identifier: Apache-2.0
#include "framework/app/simulation_request.h"

#include <CLI/CLI.hpp>
#include <sstream>

#include "framework/core/units.h"

namespace lapwing {

namespace {

std::vector<double> numbers_of(const std::string& option, const std::string& text,
                               std::size_t least, std::size_t most, const std::string& expected) {
  std::vector<double> numbers;
  std::istringstream rest(text);
  for (std::string part; std::getline(rest, part, ',');)
    numbers.push_back(read_number(option, part));
  if (numbers.size() < least || numbers.size() > most)
    throw CLI::ValidationError(option, "expected " + expected + ", not '" + text + "'");
  return numbers;
}

void add_disturbances(CLI::App& simulate, SimulationRequest& asked) {
  const auto state = [&asked](double Disturbances::*field, double value) {
    asked.stated.emplace_back(field, value);
  };
  add_text(simulate, "--quadratic-drag", "N",
           "drag in N per (m/s)^2, in addition to the linear drag; default: as in the vehicle file",
           [state](const std::string& text) {
             state(&Disturbances::quadratic_drag, read_number("--quadratic-drag", text));
           });
  add_text(simulate, "--inertia-error", "PERCENT",
           "error of the moments of inertia, in percent; default: as in the vehicle file",
           [state](const std::string& text) {
             state(&Disturbances::inertia_error, read_number("--inertia-error", text) / 100);
           });
  add_text(
      simulate, "--battery", "LOSS[,USED]",
      "loss of thrust when the battery is empty, and part of the battery used at take-off, both "
      "in percent; default: as in the vehicle file",
      [state](const std::string& text) {
        const auto n = numbers_of("--battery", text, 1, 2, "LOSS or LOSS,USED");
        state(&Disturbances::battery_loss, n[0] / 100);
        if (n.size() > 1) state(&Disturbances::battery_used, n[1] / 100);
      });
  add_text(simulate, "--noise", "M,M/S,DEG,DEG/S",
           "standard deviations of the estimated position, velocity, attitude and body rates; "
           "default: as in the vehicle file",
           [state](const std::string& text) {
             const auto n = numbers_of("--noise", text, 4, 4, "four numbers");
             state(&Disturbances::position_noise, n[0]);
             state(&Disturbances::velocity_noise, n[1]);
             state(&Disturbances::attitude_noise, radians(n[2]));
             state(&Disturbances::rate_noise, radians(n[3]));
           });
  add_text(
      simulate, "--delay", "ESTIMATE,COMMAND",
      "age of the estimated state and delay of commands, in ms; default: as in the vehicle file",
      [state](const std::string& text) {
        const auto n = numbers_of("--delay", text, 2, 2, "two numbers in ms");
        state(&Disturbances::estimator_delay, n[0] / 1000);
        state(&Disturbances::command_delay, n[1] / 1000);
      });
}

}  // namespace

void add_simulate_command(CLI::App& app, Invocation& invocation, std::filesystem::path& plan,
                          SimulationRequest& asked, std::filesystem::path& target,
                          Command& command) {
  CLI::App* simulate =
      app.add_subcommand("simulate", "simulate a plan with the full quadrotor under control");
  add_plan(*simulate, plan);
  add_text(*simulate, "--controller", "NAME[:KEY=VALUE,...]",
           "a controller and its parameters; default: as in the plan, or thesis",
           [&](const std::string& text) { asked.controller = text; });
  add_text(
      *simulate, "--wind", "MEAN,GUST[,TO]",
      "mean wind and standard deviation of gusts in m/s, direction of flow in degrees (0: to the "
      "east); default: calm",
      [&](const std::string& text) {
        const auto n = numbers_of("--wind", text, 2, 3, "MEAN,GUST or MEAN,GUST,TO");
        asked.conditions.wind_mean = n[0];
        asked.conditions.wind_gust = n[1];
        if (n.size() > 2) asked.conditions.wind_yaw = radians(n[2]);
      });
  add_text(*simulate, "--mass-error", "PERCENT",
           "mass error, in percent of the planned mass; default: 0", [&](const std::string& text) {
             asked.conditions.mass_error = read_number("--mass-error", text) / 100;
           });
  add_disturbances(*simulate, asked);
  add_count(*simulate, "--runs", 1, 100000,
            "fly it N times with seeds SEED, SEED+1, ...; errors of mass and inertia are random, "
            "between minus and plus the stated ones; default: once, as stated",
            [&](std::uint64_t runs) { asked.runs = static_cast<int>(runs); });
  add_text(*simulate, "--keep-runs", "DIR",
           "keep the runs as files in this folder, so that they can be continued, split into "
           "shards and made by several processes; default: they are not kept",
           [&](const std::string& path) { asked.kept = path; });
  add_items(*simulate, asked.items, "keep the runs that are in --keep-runs");
  add_text(*simulate, "--tolerance", "M",
           "distance from the plan that counts as followed; default: 0.25",
           [&](const std::string& text) {
             asked.tolerance = read_number("--tolerance", text);
             if (!(*asked.tolerance > 0))
               throw CLI::ValidationError("--tolerance",
                                          "expected a number above 0, not '" + text + "'");
           });
  add_threads(*simulate, invocation, "threads to use; default: one per core");
  add_seed(*simulate, asked.conditions.seed, "seed of gusts, noise and errors; default: 1");
  add_page(*simulate, target);
  add_json(*simulate, invocation);
  simulate->callback(
      [&] { command = [&] { return simulate_plan(plan, asked, target, invocation); }; });
}

FlightConditions conditions_of(const SimulationRequest& asked, const Vehicle& vehicle) {
  FlightConditions conditions = asked.conditions;
  conditions.disturbances = vehicle.disturbances;
  for (const auto& [field, value] : asked.stated) conditions.disturbances.*field = value;
  return conditions;
}

}  // namespace lapwing
