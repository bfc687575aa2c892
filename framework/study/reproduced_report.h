// SPDX-License-Identifier: Apache-2.0
// A reproduced table as lines of text, CSV, JSON and a page with pictures.
#pragma once

#include <string>
#include <vector>

#include "framework/export/report.h"
#include "framework/study/reproduced_table.h"

namespace lapwing {

// The blocks that are asked for, of the sections of a run's report. InputError naming what is not
// there, and what is.
Section chosen_pictures(const ReproducedPictures& asked, const std::vector<Section>& sections);

// Rows of cells for a terminal, with titles first; none of a figure of pictures alone.
std::vector<std::vector<std::string>> table_cells(const ReproducedTable& table);
// Captions, ranks and what differs, as lines of text.
std::string table_notes(const ReproducedTable& table);
std::string table_csv(const ReproducedTable& table);
Value to_value(const ReproducedTable& table);
Report table_report(const ReproducedTable& table);

}  // namespace lapwing
