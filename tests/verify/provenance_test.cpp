// SPDX-License-Identifier: Apache-2.0
// What a certificate says of provenance, and how limits of either sense read.
#include "framework/verify/provenance.h"

#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

TEST(ProvenanceCheck, IsLeftOpenByTheNumbersAndStatedByWhoKnows) {
  Certificate certificate = verify(reference_plan());
  EXPECT_EQ(certificate.checks.at(1).name, "provenance");
  EXPECT_FALSE(certificate.checks.at(1).skipped.empty());
  state_provenance({"as planned", {}}, certificate);
  EXPECT_TRUE(certificate.feasible());
  EXPECT_EQ(to_line(certificate.checks.at(1)), "provenance: as planned");
  state_provenance({"as planned", {"its mass is another", "a box is missing"}}, certificate);
  ASSERT_EQ(certificate.failures().size(), 1u);
  EXPECT_EQ(to_line(certificate.failures().at(0)),
            "provenance: its mass is another; a box is missing");
  EXPECT_EQ(Certificate::from_value(certificate.to_value()).to_value(), certificate.to_value());
}

TEST(ProvenanceCheck, StaysOpenWhereTheDocumentDoesNotHold) {
  Plan plan = reference_plan();
  plan.trajectory.samples.clear();
  Certificate certificate = verify(plan);
  state_provenance({"", {"x"}}, certificate);
  EXPECT_FALSE(certificate.find("provenance")->skipped.empty());
}

TEST(ProvenanceCheck, ChangesAgainstAnOlderCertificateAreNamed) {
  Plan plan = reference_plan();
  const Value stored = verify(plan).to_value();
  EXPECT_TRUE(changes_since(stored, verify(plan)).empty());
  plan.vehicle.find("limits")->set("speed_across", 20.0);
  plan.budget = 7.9;
  EXPECT_EQ(changes_since(stored, verify(plan)),
            (std::vector<std::string>{
                "speed_across was judged by a limit of 10 at planning, and is now by 20 m/s",
                "budget passed at planning, and is now failed"}));
  EXPECT_TRUE(changes_since(Value(), verify(plan)).empty());
}

TEST(Wording, FollowsTheSenseOfTheLimit) {
  const Certificate certificate = verify(reference_plan());
  for (const Check& check : certificate.checks) {
    const std::string line = to_line(check);
    EXPECT_EQ(line.find("within"), std::string::npos) << line;
    if (!check.skipped.empty() || check.name == "document") continue;
    EXPECT_NE(line.find(check.at_least ? ", at least " : ", at most "), std::string::npos) << line;
  }
  EXPECT_NE(to_line(*certificate.find("thrust_min")).find(", at least 4 N"), std::string::npos);
  EXPECT_EQ(to_line(*certificate.find("document")), "document: holds together");
}

}  // namespace
}  // namespace lapwing
