// SPDX-License-Identifier: Apache-2.0
#include "framework/app/log_reading.h"

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/named_parameters.h"
#include "framework/flight_log/flight_log_reader.h"

namespace lapwing {
namespace {

constexpr std::size_t kLargestLog = std::size_t{2} << 30;  // bytes

std::unique_ptr<FlightLogReader> stated_reader(const std::string& format,
                                               const Registry& registry) {
  const auto chosen = named_parameters_from(format);
  if (!chosen)
    throw InputError("--format: expected NAME or NAME:KEY=VALUE,..., each key once, got '" +
                     format + "'");
  return registry.create<FlightLogReader>(chosen->name, chosen->parameters, "--format");
}

std::unique_ptr<FlightLogReader> reader_of(const std::filesystem::path& file,
                                           const std::string& bytes, const Registry& registry) {
  std::string known, fits;
  std::unique_ptr<FlightLogReader> found;
  int count = 0;
  for (const PluginEntry& entry : registry.entries()) {
    if (entry.kind != FlightLogReader::kKind) continue;
    known += (known.empty() ? "" : ", ") + entry.name;
    auto reader = registry.create<FlightLogReader>(entry.name);
    if (!in_plugin(*reader, "recognizes", [&] { return reader->recognizes(bytes); })) continue;
    fits += (fits.empty() ? "" : ", ") + entry.name;
    if (++count == 1) found = std::move(reader);
  }
  if (count == 0)
    throw InputError("'" + file.string() + "' is not a flight log of a known format; there are " +
                     (known.empty() ? "none" : known) +
                     "; --format NAME reads it as one of them and says what is wrong");
  if (count > 1)
    throw InputError("'" + file.string() + "' looks like " + fits + "; --format NAME chooses one");
  return found;
}

}  // namespace

FlightLog read_flight_log(const std::filesystem::path& file, const std::string& format,
                          const Registry& registry) {
  const std::string bytes = read_file(file, kLargestLog);
  const auto reader =
      format.empty() ? reader_of(file, bytes, registry) : stated_reader(format, registry);
  FlightLog log;
  try {
    log = in_plugin(*reader, "read", [&] { return reader->read(bytes); });
  } catch (const InputError& error) {
    throw InputError("'" + file.string() + "': " + error.what());
  }
  for (const std::string& fault : faults_of(log))
    throw plugin_failure(reader->plugin_name(), "read", "a log that is not sound: " + fault);
  return log;
}

}  // namespace lapwing
