// SPDX-License-Identifier: Apache-2.0
// The program's version; CMakeLists.txt reads it from here.
#pragma once

#define LAPWING_VERSION "0.2.0"
