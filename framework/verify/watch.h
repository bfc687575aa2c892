// SPDX-License-Identifier: Apache-2.0
// How far the verifier has come, for whoever waits, and whether it is to end.
//
// Internal to this room.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "framework/core/progress.h"

namespace lapwing {

// A part of the verifier's work. `weight`: what it takes, in any unit that the parts share.
struct VerifierPart {
  std::string name;  // a few words: "clearance"
  double weight = 0;
};

// Reports the share of all parts that is done, which never falls. `done` may be called from several
// threads; the rest belongs to one.
class Watch {
 public:
  // Either may be null.
  Watch(const CancellationToken* cancellation, Progress* progress)
      : cancellation_(cancellation), progress_(progress) {}

  // What is to be done, in this order, before the first `begin`.
  void expect(std::vector<VerifierPart> parts);
  // The next part begins; the one before has ended. Cancelled when told to end.
  void begin();
  // So much of the part that runs is done, in [0, 1]. Cancelled when told to end.
  void done(double share);
  // All parts have ended.
  void end();

 private:
  void obey() const;
  void report(double whole, const std::string& name);

  const CancellationToken* cancellation_;
  Progress* progress_;
  std::vector<VerifierPart> parts_;
  std::size_t next_ = 0;         // the first part that has not begun
  double all_ = 0, before_ = 0;  // weights of all parts, and of those that have ended
  std::mutex reporting_;
  double reported_ = 0;
};

}  // namespace lapwing
