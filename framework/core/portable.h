// SPDX-License-Identifier: Apache-2.0
// Numbers that are the same on every processor of one architecture.
//
// The C library, Embree and others choose their code by what the processor has: with and without
// FMA and AVX2, results of `sin`, `exp` or a ray differ in their last bits. What they choose can be
// limited by the environment, which has to be set before the program starts.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lapwing {

// Variables that limit every library to what all x86-64 processors have, and mark the process.
std::vector<std::pair<std::string, std::string>> portable_environment();

// Whether this process was started with them.
bool is_portable();

// What numbers of this process depend on beside the program: version and behaviour of the C
// library's functions, and the instruction sets that libraries may choose; one line. Two processes
// with equal texts compute equal bits. It ends with "portable" if `is_portable`.
const std::string& machine_of_numbers();

}  // namespace lapwing
