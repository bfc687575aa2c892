// SPDX-License-Identifier: Apache-2.0
// Messages as values, by the names of their fields: for logs and for comparison with other
// implementations.
#pragma once

#include "framework/core/value.h"
#include "framework/mavlink/packet.h"

namespace lapwing::mavlink {

// {"message": NAME, "system", "component", "sequence", "fields": {...}}. Fields are in the order of
// the definition; those of characters are texts, to the first zero; a float that is not finite is
// the text "nan", "inf" or "-inf". Throws Error for a message that is not in the table.
Value to_value(const Packet& packet);

// The inverse; fields that are absent are zero. Throws InputError for a message or a field that is
// unknown, and for a number that its field cannot hold.
Packet packet_from_value(const Value& value);

}  // namespace lapwing::mavlink
