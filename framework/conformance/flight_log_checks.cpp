// SPDX-License-Identifier: Apache-2.0
// What every reader of flight logs must pass.
#include "framework/conformance/every_case.h"
#include "framework/core/random.h"
#include "framework/flight_log/flight_log_reader.h"

namespace lapwing {
namespace {

// Bytes that are a log of no format.
std::vector<std::pair<std::string, std::string>> foreign_bytes() {
  return {{"no bytes", ""},
          {"a text", "not a log at all\n"},
          {"zeros", std::string(4096, '\0')},
          {"ones", std::string(4096, '\xff')},
          {"a document", "{\"format\": 2, \"samples\": [[1, 2, 3]]}\n"}};
}

bool same(const FlightLog& a, const FlightLog& b) {
  if (a.series.size() != b.series.size() || a.photographs != b.photographs) return false;
  for (const auto& [name, series] : a.series) {
    const LogSeries* other = b.find(name);
    if (!other || other->times != series.times || other->values != series.values) return false;
  }
  return a.damage == b.damage && a.remarks == b.remarks && a.bytes_read == b.bytes_read;
}

// Reads bytes that may be damaged: a sound log, or an InputError that says something.
void read_anything(const FlightLogReader& reader, const std::string& bytes,
                   const std::string& check, const std::string& what, Findings& findings) {
  try {
    reader.recognizes(bytes);
    const FlightLog log = reader.read(bytes);
    for (const std::string& fault : faults_of(log))
      findings.expect(check, false, [&] { return what + ": " + fault; });
    findings.expect(check, log.bytes == bytes.size(),
                    [&] { return what + ": it says another size than the file has"; });
  } catch (const InputError& error) {
    findings.expect(check, std::string(error.what()).size() > 10,
                    [&] { return what + " is refused without a reason"; });
  }
}

void check_example(const FlightLogReader& reader, Findings& findings) {
  const std::string bytes = reader.example();
  findings.expect("example", reader.recognizes(bytes),
                  [] { return "it does not recognize its own example"; });
  const FlightLog log = reader.read(bytes);
  for (const std::string& fault : faults_of(log))
    findings.expect("example", false, [&] { return fault; });
  findings.expect("example", log.find("position") || log.find("place"),
                  [] { return "its example has neither `position` nor `place`"; });
  findings.expect("example", log.damage.empty() && log.finish() - log.start() >= 1 - 1e-9,
                  [] { return "its example is damaged, or shorter than a second"; });
  findings.expect("repeatable", same(log, reader.read(bytes)),
                  [] { return "equal bytes give another log"; });
}

void check_refusals(const FlightLogReader& reader, Findings& findings) {
  for (const auto& [name, bytes] : foreign_bytes()) {
    findings.expect("refusals", !reader.recognizes(bytes),
                    [&] { return "it takes " + name + " for a log of its format"; });
    bool refused = false;
    try {
      reader.read(bytes);
    } catch (const InputError& error) {
      refused = std::string(error.what()).size() > 10;
    }
    findings.expect("refusals", refused,
                    [&] { return "it does not refuse " + name + " with a reason"; });
  }
}

void check_cuts(const FlightLogReader& reader, Findings& findings) {
  const std::string bytes = reader.example();
  for (std::size_t size = 0; size < bytes.size(); ++size)
    read_anything(reader, bytes.substr(0, size), "cut short",
                  "cut after " + std::to_string(size) + " bytes, it", findings);
}

void check_damage(const FlightLogReader& reader, const CheckOptions& options, Findings& findings) {
  const std::string whole = reader.example();
  Random random(options.seed);
  for (int k = 0; k < 2000; ++k) {
    std::string bytes = whole;
    const int count = 1 + k % 4;
    for (int i = 0; i < count; ++i) {
      const auto at =
          static_cast<std::size_t>(random.uniform(0, static_cast<double>(bytes.size())));
      bytes[std::min(at, bytes.size() - 1)] = static_cast<char>(random.uniform(0, 256));
    }
    read_anything(reader, bytes, "damage", "with other bytes (" + std::to_string(k) + "), it",
                  findings);
  }
}

}  // namespace

std::vector<CheckResult> check_flight_log(const Specimen<FlightLogReader>& subject,
                                          const CheckOptions& options) {
  return check_every_case(subject, options, "reading a log",
                          [&](const FlightLogReader& reader, Findings& findings, bool first) {
                            if (options.wants_any({"example", "repeatable"}))
                              check_example(reader, findings);
                            if (!first) return;
                            if (options.wants("refusals")) check_refusals(reader, findings);
                            if (options.wants("cut short")) check_cuts(reader, findings);
                            if (options.wants("damage")) check_damage(reader, options, findings);
                          });
}

}  // namespace lapwing
