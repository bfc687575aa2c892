// SPDX-License-Identifier: Apache-2.0
// What a verdict tells of itself on the way, how it is ended, and files that lie elsewhere.
#include "framework/verify/watch.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <set>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/mesh_file.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

struct Told : Progress {
  void report(double fraction, const std::string& what) override {
    fractions.push_back(fraction);
    names.push_back(what);
    if (fractions.size() == cancel_at && token) token->cancel();
  }
  std::vector<double> fractions;
  std::vector<std::string> names;
  std::size_t cancel_at = 0;
  CancellationToken* token = nullptr;
};

class WatchedVerdict : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lapwing_watch_" + std::to_string(::getpid()));
    fs::create_directories(folder_ / "there");
    MeshBuilder builder;
    builder.box({200, 200, 0}, {201, 201, 5});
    write_ply(builder.mesh(), folder_ / "there/block.ply");
    plan_ = reference_plan();
    Obstacle block;
    block.name = "block";
    block.type = "mesh";
    block.parameters.set("file", "judge/block.ply");
    block.parameters.set("sha256", sha256(read_file(folder_ / "there/block.ply")));
    plan_.environment.obstacles = {block};
  }
  void TearDown() override { fs::remove_all(folder_); }

  VerifyRequest request(Told* told) const {
    return {.folder = folder_,
            .elsewhere = {{"judge/block.ply", folder_ / "there/block.ply"}},
            .cancellation = nullptr,
            .progress = told};
  }

  fs::path folder_;
  Plan plan_;
};

TEST_F(WatchedVerdict, TellsASharePerCheckThatNeverFallsAndEndsAtOne) {
  Told told;
  const Certificate certificate = verify(plan_, request(&told));
  EXPECT_EQ(certificate.to_value(), verify(plan_, request(nullptr)).to_value());
  ASSERT_GT(told.fractions.size(), 20u);
  EXPECT_TRUE(std::is_sorted(told.fractions.begin(), told.fractions.end()));
  EXPECT_EQ(told.fractions.front(), 0);
  EXPECT_EQ(told.fractions.back(), 1);
  for (const char* part : {"document", "dynamics", "clearance", "closed loop", "constraints"})
    EXPECT_NE(std::find(told.names.begin(), told.names.end(), part), told.names.end()) << part;
  // Not in a few jumps: no check of this plan is most of the work, and each tells its own share.
  std::set<double> steps(told.fractions.begin(), told.fractions.end());
  EXPECT_GT(steps.size(), 20u);
}

TEST_F(WatchedVerdict, EndsWhereverItIsToldTo) {
  Told all;
  verify(plan_, request(&all));
  for (std::size_t at = 1; at < all.fractions.size(); at += all.fractions.size() / 12 + 1) {
    CancellationToken token;
    Told told;
    told.cancel_at = at;
    told.token = &token;
    VerifyRequest asked = request(&told);
    asked.cancellation = &token;
    EXPECT_THROW(verify(plan_, asked), Cancelled) << at;
    EXPECT_EQ(told.fractions.size(), at);
  }
}

TEST_F(WatchedVerdict, FilesOfAJudgeLieElsewhere) {
  const Certificate judged = verify(plan_, request(nullptr));
  EXPECT_TRUE(judged.find("document")->pass) << judged.find("document")->detail;
  EXPECT_TRUE(judged.find("clearance")->skipped.empty());
  // Nobody said where: then it is looked for beside the plan.
  const Certificate lost = verify(plan_, folder_);
  EXPECT_FALSE(lost.find("document")->pass);
  EXPECT_NE(lost.find("document")->detail.find("mesh 'block'"), std::string::npos);
}

TEST(Watch, SharesOfPartsAreTheirWeights) {
  Told told;
  Watch watch(nullptr, &told);
  watch.expect({{"one", 1}, {"three", 3}});
  watch.begin();
  watch.done(0.5);
  watch.begin();
  watch.done(0.5);
  watch.done(0.25);  // a second walk over the same part does not fall back
  watch.end();
  EXPECT_EQ(told.fractions, (std::vector<double>{0, 0.125, 0.25, 0.625, 0.625, 1}));
  EXPECT_EQ(told.names.back(), "three");
}

}  // namespace
}  // namespace lapwing
