// SPDX-License-Identifier: Apache-2.0
#include "framework/app/kept_runs.h"

#include <cmath>
#include <limits>

#include "framework/app/command_line.h"
#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/portable.h"
#include "framework/items/statement.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestInput = std::size_t{4} << 30;  // bytes
constexpr std::size_t kColumns = 9;  // of a sample: time, position, wanted place, two errors

// Figures of a path, by name.
struct PathFigure {
  const char* name;
  double FlownPath::*field;
};
constexpr PathFigure kFigures[] = {{"position_error_worst", &FlownPath::position_error_worst},
                                   {"position_error_at", &FlownPath::position_error_at},
                                   {"position_error_mean", &FlownPath::position_error_mean},
                                   {"yaw_error_worst", &FlownPath::yaw_error_worst},
                                   {"yaw_error_at", &FlownPath::yaw_error_at},
                                   {"clock_error_worst", &FlownPath::clock_error_worst},
                                   {"clock_error_at", &FlownPath::clock_error_at},
                                   {"late_worst", &FlownPath::late_worst},
                                   {"saturated_share", &FlownPath::saturated_share},
                                   {"rotor_speed_worst", &FlownPath::rotor_speed_worst}};

constexpr std::pair<const char*, std::optional<bool> RunVerdict::*> kParts[] = {
    {"gates", &RunVerdict::gates},
    {"framed", &RunVerdict::framed},
    {"distance", &RunVerdict::distance}};

Value number(double value) {
  return std::isfinite(value) ? Value(value) : Value();
}
double number_from(const Value& value) {
  return value.is_null() ? std::numeric_limits<double>::infinity() : value.as_number();
}

// Of all files beside the plan that its texts name: meshes, maps, shapes.
void add_files(const Value& value, const fs::path& folder, Value& sums) {
  std::error_code code;
  if (value.is_list())
    for (const Value& entry : value.as_list()) add_files(entry, folder, sums);
  if (value.is_map())
    for (const auto& [key, entry] : value.as_map()) add_files(entry, folder, sums);
  if (!value.is_text() || value.as_text().empty() || value.as_text().size() > 1000) return;
  const fs::path file = folder / value.as_text();
  if (fs::is_regular_file(file, code) && !sums.find(value.as_text()))
    sums.set(value.as_text(), sha256(read_file(file, kLargestInput)));
}

}  // namespace

Value to_value(const KeptRun& run) {
  Value value = Value::map();
  for (const PathFigure& figure : kFigures) value.set(figure.name, number(run.path.*figure.field));
  value.set("finished", run.path.finished);
  value.set("lost", run.path.lost);
  value.set("followed", run.verdict.followed);
  for (const auto& [name, part] : kParts)
    if (run.verdict.*part) value.set(name, *(run.verdict.*part));
  Value::List samples;
  for (const FlownSample& sample : run.path.samples) {
    const Eigen::Vector3d &p = sample.state.position, &w = sample.wanted;
    Value::List row;
    for (const double one : {sample.time, p.x(), p.y(), p.z(), w.x(), w.y(), w.z(),
                             sample.position_error, sample.yaw_error})
      row.push_back(number(one));
    samples.emplace_back(std::move(row));
  }
  value.set("samples", Value(std::move(samples)));
  return value;
}

KeptRun kept_run_from(const Value& value) {
  KeptRun run;
  for (const PathFigure& figure : kFigures)
    run.path.*figure.field = number_from(value.at(figure.name));
  run.path.finished = value.at("finished").as_boolean();
  run.path.lost = value.at("lost").as_boolean();
  run.verdict.followed = value.at("followed").as_boolean();
  for (const auto& [name, part] : kParts)
    if (const Value* there = value.find(name)) run.verdict.*part = there->as_boolean();
  for (const Value& entry : value.at("samples").as_list()) {
    const Value::List& row = entry.as_list();
    if (row.size() != kColumns)
      throw InputError("a sample has " + std::to_string(row.size()) + " numbers, not " +
                       std::to_string(kColumns));
    std::array<double, kColumns> n{};
    for (std::size_t k = 0; k < kColumns; ++k) n[k] = number_from(row[k]);
    FlownSample& sample = run.path.samples.emplace_back();
    sample.time = n[0];
    sample.state.position = {n[1], n[2], n[3]};
    sample.wanted = {n[4], n[5], n[6]};
    sample.position_error = n[7];
    sample.yaw_error = n[8];
  }
  return run;
}

Value statement_of(const RunInputs& inputs) {
  const std::string text = read_file(inputs.plan, kLargestInput);
  Value statement = Value::map();
  statement.set("program", std::string("lapwing ") + program_version());
  statement.set(kMachineEntry, machine_of_numbers());
  statement.set("plan_sha256", sha256(text));
  add_files(from_json(text, inputs.plan.string()), inputs.plan.parent_path(),
            statement.set("files", Value::map()));
  statement.set("controller", inputs.controller);
  Value conditions = Value::map();
  for (const auto& [name, value] : inputs.conditions.as_map())
    if (name != "seed") conditions.set(name, value);
  statement.set("conditions", std::move(conditions));
  statement.set("tolerance", inputs.tolerance);
  return statement;
}

ItemList run_items_of(const fs::path& folder, std::uint64_t first, std::size_t count,
                      const Value& mark, std::function<KeptRun(std::uint64_t seed)> fly) {
  ItemList list;
  list.folder = folder;
  for (std::size_t i = 0; i < count; ++i)
    list.items.push_back({"runs/seed_" + std::to_string(first + i) + ".json", 0, {}});
  list.is_made = [folder, mark, items = list.items](std::size_t item) {
    return has_item(folder / items[item].file, mark);
  };
  list.make = [folder, mark, first, items = list.items, fly = std::move(fly)](std::size_t item,
                                                                              const void*) {
    Value value = to_value(fly(first + item));
    value.set(kMadeByEntry, mark);
    write_file_atomically(folder / items[item].file, to_json(value, -1) + "\n");
  };
  return list;
}

std::vector<KeptRun> read_runs(const ItemList& list) {
  std::vector<KeptRun> runs;
  for (const Item& item : list.items) {
    const fs::path file = list.folder / item.file;
    runs.push_back(kept_run_from(from_json(read_file(file), file.string())));
  }
  return runs;
}

}  // namespace lapwing
