// SPDX-License-Identifier: Apache-2.0
// Training, and models as files.
#include <gtest/gtest.h>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/map/plain_map.h"
#include "plugins/utilities/learned/model_file.h"
#include "tests/plugins/utilities/fit_fixture.h"

namespace lapwing {
namespace {

using namespace learned;

TEST(LearnedFit, LearnsWhatIsEasy) {
  GridTraining fixture;
  const Value figures = fixture.run();
  EXPECT_GT(figures.at("validation_rho").as_number(), 0.95);
  const SampleSet set = read_samples(fixture.request.validation.front());
  const Prediction predicted = kGridTrainable.predict(fixture.request.model, set, 1);
  EXPECT_NEAR(rank_correlation(predicted.values, set.targets),
              figures.at("validation_rho").as_number(), 1e-6);
  const double loss = figures.at("validation_loss").as_number();
  EXPECT_NEAR(predicted.loss, loss, 1e-5 * loss);
}

// The same order of values, and values of the same size, by way of their square roots.
TEST(LearnedFit, LearnsRootsAsWell) {
  GridTraining fixture;
  fixture.given.set("targets", "root");
  const Value figures = fixture.run();
  EXPECT_GT(figures.at("validation_rho").as_number(), 0.95);
  const SampleSet set = read_samples(fixture.request.validation.front());
  const Prediction predicted = kGridTrainable.predict(fixture.request.model, set, 1);
  double error = 0;
  for (std::size_t k = 0; k < set.size(); ++k)
    error += std::abs(static_cast<double>(predicted.values[k] - set.targets[k])) /
             static_cast<double>(set.size());
  EXPECT_LT(error, 10) << "of targets from 0 to 100";
  const double loss = figures.at("validation_loss").as_number();
  EXPECT_NEAR(predicted.loss, loss, 1e-5 * loss);
  const Model model = read_model(fixture.request.model);
  for (const double target : {0.0, 1.0, 64.0})
    EXPECT_NEAR(model.target_of(model.answer_of(target)), target, 1e-9);
}

// One epoch more of what was learned is better than one of nothing.
TEST(LearnedFit, SaysThatItCameToNothing) {
  GridTraining fixture;
  fixture.given.set("rate", 1e30);
  try {
    fixture.run();
    ADD_FAILURE() << "a rate of 1e30";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("a rate lower than 1e+30"), std::string::npos)
        << error.what();
  }
}

TEST(LearnedFit, BeginsWithAModel) {
  GridTraining fixture;
  const double whole = fixture.run().at("validation_loss").as_number();
  std::filesystem::rename(fixture.request.model, fixture.folder / "first.model");
  fixture.given.set("epochs", 1);
  const double fresh = fixture.run().at("validation_loss").as_number();
  const auto first = fixture.folder / "first.model";
  fixture.given.set("begin", first.string());
  const double begun = fixture.run().at("validation_loss").as_number();
  const Value told = read_model(fixture.request.model).provenance.at("begin");
  EXPECT_EQ(told.at("sha256").as_text(), sha256(read_file(first)));
  EXPECT_EQ(told.at("samples").as_integer(), 128);
  EXPECT_LT(begun, 0.5 * fresh);
  EXPECT_LT(begun, 4 * whole);
  fixture.given.set("hidden1", 24);
  EXPECT_THROW(fixture.run(), InputError);
}

// The schedule is that of all epochs: what is left may follow.
TEST(LearnedFit, EndsWhereItIsAskedTo) {
  GridTraining fixture;
  fixture.given.set("schedule", "cosine");
  fixture.run();
  const std::string whole = read_file(fixture.request.model);
  std::filesystem::remove(fixture.request.model);
  std::filesystem::remove(fixture.request.checkpoint);
  fixture.given.set("until", 2);
  EXPECT_LE(fixture.run().at("epoch").as_integer(), 2);
  EXPECT_EQ(read_model(fixture.request.checkpoint).progress.at("epoch").as_integer(), 2);
  fixture.given.set("until", 0);
  fixture.request.resume = true;
  fixture.run();
  EXPECT_EQ(read_file(fixture.request.model), whole);
}

// The checkpoint holds the last weights; without the best ones there is nothing to go on with.
TEST(LearnedFit, GoesOnWithItsModelAlone) {
  GridTraining fixture;
  fixture.given.set("epochs", 2);
  fixture.request.resume = true;  // of nothing: it begins
  fixture.run();
  const auto& model = fixture.request.model;
  const std::string whole = read_file(model);
  fixture.given.set("epochs", 3);
  std::filesystem::remove(model);
  EXPECT_NE(fixture.refusal().find("is not there: train anew"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(model));
  write_file_atomically(model, whole);
  Model other = read_model(model);
  other.provenance.set("epoch", 77);
  write_model(other, model);
  EXPECT_NE(fixture.refusal().find("is not the model that its checkpoint goes with"),
            std::string::npos);
  write_file_atomically(model, whole);
  EXPECT_EQ(fixture.refusal(), "");
}

TEST(LearnedFit, ResumedItIsAsIfNeverStopped) {
  GridTraining fixture;
  fixture.run();
  const std::string whole = read_file(fixture.request.model);
  std::filesystem::remove(fixture.request.model);
  CancellationToken token;
  fixture.request.cancellation = &token;
  int lines = 0;
  fixture.request.log = [&](const std::string&) {
    if (++lines == 5) token.cancel();
  };
  EXPECT_THROW(fixture.run(), Cancelled);
  fixture.request.cancellation = nullptr;
  fixture.request.resume = true;
  fixture.run();
  EXPECT_EQ(read_file(fixture.request.model), whole);
}

TEST(LearnedFit, GoesOnWithTheSameAlone) {
  GridTraining fixture;
  fixture.given.set("epochs", 1);
  fixture.run();
  fixture.request.resume = true;
  EXPECT_EQ(fixture.refusal(), "");
  fixture.request.seed = 2;
  EXPECT_NE(fixture.refusal().find("another seed: 1, not 2"), std::string::npos)
      << fixture.refusal();
  fixture.request.seed = 1;
  fixture.given.set("rate", 0.02);
  EXPECT_NE(fixture.refusal().find("another rate"), std::string::npos) << fixture.refusal();
  fixture.given.set("rate", 0.01);
  write_grid_samples(fixture.folder / "validation", 1, 3);
  fixture.request.validation = sample_files({fixture.folder / "validation"});
  EXPECT_NE(fixture.refusal().find("another validation samples"), std::string::npos)
      << fixture.refusal();
  fixture.request.resume = false;
  fixture.request.validation = fixture.request.training;
  EXPECT_NE(fixture.refusal().find("must differ"), std::string::npos) << fixture.refusal();
  fixture.request.training.push_back(fixture.folder / "training" / "copy.samples");
  std::filesystem::copy_file(fixture.request.training.front(), fixture.request.training.back());
  EXPECT_NE(fixture.refusal().find("leave one of them out"), std::string::npos)
      << fixture.refusal();
}

// What the shipped model is, header and weights; its figures in the readme are of this one.
TEST(LearnedModel, TheShippedGridIsWhatItWas) {
  const auto path =
      std::filesystem::path(LAPWING_SOURCE_DIR) / "plugins/utilities/learned/learned_grid.model";
  const Model model = read_model(path);
  const std::string bytes = read_file(path);
  const std::size_t numbers =
      sizeof(float) * (model.state.parameters.size() + model.state.statistics.size());
  EXPECT_EQ(sha256(bytes.substr(bytes.size() - numbers)),
            "176dfdb697b6db13584b29252bc31969278e0a233481c4eb5f16884e8920567f");
  EXPECT_EQ(model.target_mean, 140.06549994927536);
  EXPECT_EQ(model.target_deviation, 151.24743494552564);
  EXPECT_FALSE(model.root);
  EXPECT_EQ(model.mapping.at("pitch").as_number(), -0.17453292519943295);
  const Value& begun = model.provenance.at("begin");
  EXPECT_EQ(begun.at("samples").as_integer(), 89770);
  EXPECT_EQ(begun.at("begin").at("model").as_text(), "second.model");
}

TEST(LearnedModel, DamageIsFound) {
  GridTraining fixture;
  fixture.given.set("epochs", 1);
  fixture.run();
  const auto path = fixture.request.model;
  const std::string bytes = read_file(path);
  EXPECT_NO_THROW(read_model(path));
  const auto refusal = [&](const std::string& damaged) {
    write_file_atomically(path, damaged);
    try {
      read_model(path);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  std::string damaged = bytes;
  damaged[damaged.size() - 9] ^= 0x40;
  EXPECT_NE(refusal(damaged).find("damaged"), std::string::npos);
  EXPECT_NE(refusal(bytes.substr(0, bytes.size() - 100)).find("damaged"), std::string::npos);
  // The header as well: what the network's answers mean.
  damaged = bytes;
  damaged.replace(damaged.find("\"mean\":"), 9, "\"mean\":9");
  EXPECT_NE(refusal(damaged).find("damaged"), std::string::npos);
  write_file_atomically(path, bytes);
  Model whole = read_model(path);
  whole.mapping = Value::map();
  write_model(whole, path);
  EXPECT_NE(refusal(read_file(path)).find("it has no resolution"), std::string::npos);
  EXPECT_NE(refusal("lapwing").find("first line"), std::string::npos);
  write_file_atomically(path, bytes);
  whole = read_model(path);
  whole.state.parameters.front() = std::nanf("");
  write_model(whole, path);
  EXPECT_NE(refusal(read_file(path)).find("a number that is not finite"), std::string::npos);
  EXPECT_NE(refusal(""), "");
  SampleSet other = read_samples(fixture.request.validation.front());
  write_file_atomically(path, bytes);
  other.mapping.set("resolution", 0.2);
  try {
    kGridTrainable.predict(path, other, 1);
    ADD_FAILURE() << "a model of another resolution";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("resolution is 0.2 m, the model's 0.4 m"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace lapwing
