// SPDX-License-Identifier: Apache-2.0
// What results were made from: the statement of a folder, and the mark on each item's file.
//
// Results are kept only together with results of the same inputs, the same version and a machine
// that computes the same numbers (core/portable.h).
#pragma once

#include <filesystem>
#include <string>

#include "framework/core/value.h"
#include "framework/items/item_run.h"

namespace lapwing {

// Names of entries of a statement and of a mark.
inline constexpr const char* kMachineEntry = "machine";
inline constexpr const char* kMadeByEntry = "made_by";

// Why two statements (maps) differ, in words; "" if they are equal. Two machines are named, of
// other entries the names.
std::string statement_difference(const Value& there, const Value& here);

// The mark of an item's file: program, machine, and a checksum of the statement.
Value made_by(const std::string& program, const Value& statement);

// InputError unless `item`, which `file` holds, has this mark.
void require_made_by(const std::filesystem::path& file, const Value& item, const Value& mark);

// Whether the file is there. InputError if it is, but is not JSON or has another mark.
bool has_item(const std::filesystem::path& file, const Value& mark);

// Makes sure that `file` holds this statement, for the process that begins to make items: writes it
// if the file is not there (unless the items must be there), else compares it. `what` is made, as
// "study", for messages. InputError if there is another statement, or one and `options` do not
// continue it.
void open_statement(const std::filesystem::path& file, const Value& statement,
                    const ItemOptions& options, const std::string& what);

}  // namespace lapwing
