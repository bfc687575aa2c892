// SPDX-License-Identifier: Apache-2.0
// Bytes as text: base64 with padding (RFC 4648, section 4).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lapwing {

std::string base64(std::string_view bytes);

// None where the text is no padded base64.
std::optional<std::string> bytes_of_base64(std::string_view text);

}  // namespace lapwing
