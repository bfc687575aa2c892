// SPDX-License-Identifier: Apache-2.0
// The digest of a plan document: tells that something in it was changed after it was written, and
// in which section. It is no signature: whoever edits a plan can compute it anew.
#pragma once

#include <string>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

// {"sha256": of the whole document, "sections": {"samples": ..., "vehicle.limits": ..., ...}}, of
// everything but the key `digest`. Taken of the canonical form: keys in order, no spaces, numbers
// as short as they read back, 10.0 as 10; so it does not depend on how the file is laid out. The
// sections are the keys of the document, and of its tables, each by 16 digits. Throws Error where
// a number is not finite.
Value digest_of(const Value& document);

// The key of an obstacle's record that holds the SHA-256 of the canonical form of all its others,
// so that a record that was changed can be named.
inline constexpr const char* kRecordChecksum = "sha256";

// SHA-256 of one value's canonical form, 64 hexadecimal digits.
std::string canonical_sha256(const Value& value);

struct DigestFindings {
  bool stated = false;  // the document has a digest
  std::string sha256;   // of what the document holds now
  // Sections, "task.keyframes", and records, "environment.obstacles[0]"; empty where it holds.
  std::vector<std::string> changed;
};
DigestFindings check_digest(const Value& document);

}  // namespace lapwing
