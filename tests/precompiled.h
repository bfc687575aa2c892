// SPDX-License-Identifier: Apache-2.0
// Headers that nearly every test reads, compiled once per test program's flags.
#pragma once

#include "framework/core/precompiled.h"

#include <gtest/gtest.h>
