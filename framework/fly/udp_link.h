// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "framework/fly/link.h"

namespace lapwing {

// Of `open_link`. Over IPv4. One that listens may have port 0: any that is free.
std::unique_ptr<Link> open_udp(const LinkAddress& address);
std::unique_ptr<Link> open_serial(const LinkAddress& address);

}  // namespace lapwing
