// SPDX-License-Identifier: Apache-2.0
// Text from outside within HTML and XML.
#pragma once

#include <string>
#include <string_view>

namespace lapwing {

// The text as content or as an attribute's value of HTML and of XML: & < > " ' as references; what
// neither of them may hold (control characters but line breaks and tabs, U+FFFE, U+FFFF, bytes that
// are no UTF-8) as U+FFFD.
std::string markup_text(std::string_view text);

}  // namespace lapwing
