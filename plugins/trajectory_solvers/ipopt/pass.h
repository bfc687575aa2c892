// SPDX-License-Identifier: Apache-2.0
// One run of Ipopt on a program. Its types stay inside `pass.cpp`.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "framework/solve/solve_record.h"
#include "plugins/trajectory_solvers/ipopt/program.h"

namespace lapwing {

struct IpoptSettings {
  int iterations = 0;
  double tolerance = 0, feasibility = 0, acceptable_tolerance = 0;
  int acceptable_iterations = 0;
  std::string hessian, mu_strategy;
  double first_barrier = 0.1;
};

struct PassRequest {
  const IpoptSettings& settings;
  const SolveRequest& request;
  int iterations = 0;       // most of this pass
  bool warm = false;        // from the request's multipliers
  bool fixed_stay = false;  // fixed numbers remain variables
};

// Ipopt's ends, as far as they mean different things here.
enum class PassEnd {
  solved,
  acceptable,
  infeasible,
  no_step,  // no better point is found, or restoration failed
  iteration_limit,
  stopped,  // by us
  too_few_variables,
  failed,
};

// What passes leave behind; one object for all passes of a solve.
struct PassOutcome {
  PassEnd end = PassEnd::failed;
  const char* name = "";               // Ipopt's own
  Eigen::VectorXd x, rows, bounds;     // x and multipliers, signed as the kernel's
  int iterations = 0;                  // of all passes
  std::optional<SolveStatus> stopped;  // cancelled or out of time
  bool converged = false;              // by our measure
  bool restoring = false;              // stopped because feasibility does not come back
  bool turned = false;                 // stopped because an orientation is far from its reference
  Stages best;                         // cheapest feasible iterate of all passes, or empty
  double best_cost = std::numeric_limits<double>::infinity();
};

// Runs Ipopt from the program's start and updates `outcome`. One at a time in a process. Throws
// std::bad_alloc where memory ran short, whatever Ipopt made of it.
void run_pass(const PassRequest& request, Program& program, SolveRecord& record,
              PassOutcome& outcome);

}  // namespace lapwing
