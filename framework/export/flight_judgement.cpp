// SPDX-License-Identifier: Apache-2.0
#include "framework/export/flight_judgement.h"

#include "framework/core/visible_text.h"
#include "framework/export/flown_comparison.h"

namespace lapwing {

std::vector<std::string> judge_written_flight(const Exporter& exporter, const Plan& plan,
                                              const std::string& written,
                                              const std::filesystem::path& folder,
                                              const std::string& what) {
  const std::optional<FlownFile> flown =
      in_plugin(exporter, "flown", [&] { return exporter.flown(plan, written); });
  if (!flown) return {};
  const FlownComparison compared = compare_flown(plan, *flown, folder);
  if (compared.refusals.empty()) return compared.sentences;
  std::string all;
  for (const std::string& refusal : compared.refusals) all += "\n  " + visible_line(refusal);
  throw InputError(what + ": the file would break what the plan keeps; a smaller `tolerance` " +
                   "brings its flight nearer to the plan" + all);
}

}  // namespace lapwing
