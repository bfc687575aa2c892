// SPDX-License-Identifier: Apache-2.0
// Checksums of files that a document names.
#pragma once

#include <string>
#include <string_view>

namespace lapwing {

// SHA-256 (FIPS 180-4), 64 hexadecimal digits.
std::string sha256(std::string_view bytes);

}  // namespace lapwing
