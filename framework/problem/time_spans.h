// SPDX-License-Identifier: Apache-2.0
// Spans of time in which a function is asked for, or not asked: the cuts of a film.
#pragma once

#include <string_view>
#include <vector>

#include "framework/core/parameters.h"
#include "framework/problem/stage_function.h"
#include "framework/trajectory/time_span.h"

namespace lapwing {

// {start, finish}, one entry of a parameter that lists spans.
ParameterTable time_span_table();

// The spans given as `name`. InputError when one ends before it begins.
std::vector<TimeSpan> time_spans(const Parameters& parameters, std::string_view name);

// Lists in `shape` the windows of stages that lie inside one of the spans `only` (all, when there
// is none) and overlap none of the spans `except`. Where none remains the shape has no rows.
// InputError when a span begins after the last stage. With a free step, by the times of its guess.
void ask_within(FunctionShape& shape, const Horizon& horizon, const std::vector<TimeSpan>& only,
                const std::vector<TimeSpan>& except);

}  // namespace lapwing
