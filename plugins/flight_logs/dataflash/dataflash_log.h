// SPDX-License-Identifier: Apache-2.0
// A DataFlash log of ArduPilot as a flight log.
#pragma once

#include <string>
#include <string_view>

#include "framework/flight_log/flight_log.h"

namespace lapwing::dataflash {

// InputError for bytes that are no such log, and for one without a sample of a known message.
FlightLog read(std::string_view bytes);

// A small log with a second of POS.
std::string example();

}  // namespace lapwing::dataflash
