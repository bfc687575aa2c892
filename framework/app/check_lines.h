// SPDX-License-Identifier: Apache-2.0
// Checks of a certificate on standard output, a line each.
#pragma once

#include "framework/verify/certificate.h"

namespace lapwing {

void print_check(const Check& check);
void print_failures(const Certificate& certificate);

}  // namespace lapwing
