// SPDX-License-Identifier: Apache-2.0
// Long work that has phases: what each of them takes, and what is left of the whole.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/progress.h"

namespace lapwing {

// `weight`: what it takes, in any unit that the phases share; 0 where nobody can say.
struct Phase {
  std::string name;  // a few words: "first flight"
  double weight = 0;
};

// Progress that knows of phases. What `report` says is of the phase that has begun.
class PhasedProgress : public Progress {
 public:
  // All phases of the work, in their order; before the first one begins.
  virtual void expect(std::vector<Phase> phases) = 0;
  // The phase before has ended. One that was not expected, or comes again, is taken as it comes.
  virtual void begin(const std::string& phase) = 0;
};

// For whoever holds any progress, or none.
void expect_phases(Progress* progress, std::vector<Phase> phases);
void begin_phase(Progress* progress, const std::string& phase);

// How far work has come, from what was measured. Times are s since it began.
//
// Of the phase that runs its own share done says what it takes; of later phases their weights, by
// what the measured ones took for theirs. Where these guesses are more than a fifth of all there
// is no estimate, for nobody knows.
class PhaseTimes {
 public:
  void expect(std::vector<Phase> phases);
  // What the phase before took, and its name; nothing where there was none.
  std::optional<std::pair<std::string, double>> begin(const std::string& phase, double now);
  void report(double fraction, double now);  // negative or NaN: unknown

  struct Standing {
    std::string phase;               // "" before the first one
    int number = 0, count = 0;       // of the expected phases; 0 where it is none of them
    std::optional<double> fraction;  // of the phase; never falls while it runs
    std::optional<double> whole;     // never falls
    std::optional<double> left;      // s
  };
  Standing standing(double now);

 private:
  struct Measured {
    double weight = 0, seconds = 0;
  };

  double weight_of(std::size_t place) const { return phases_[place].weight; }
  // s that the phase takes in all, so far as its own share tells.
  std::optional<double> own_total(double now) const;

  std::vector<Phase> phases_;
  std::size_t next_ = 0;            // the first expected phase that has not begun
  std::optional<std::size_t> now_;  // the expected phase that runs
  std::string name_;
  bool begun_ = false, ended_ = false;  // of phases, expected or not: one has
  double began_ = 0;
  std::optional<double> fraction_;
  bool fell_ = false;  // the phase began again by itself: its share tells nothing
  double whole_ = 0;
  Measured measured_;
};

}  // namespace lapwing
