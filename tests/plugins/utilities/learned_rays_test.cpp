// SPDX-License-Identifier: Apache-2.0
// The network that reads rays: its derivatives against differences, its training, its utility.
#include <gtest/gtest.h>

#include <numeric>
#include <regex>
#include <set>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/map/plain_map.h"
#include "framework/study/training_recipe.h"
#include "plugins/utilities/learned/model_file.h"
#include "tests/plugins/utilities/fit_fixture.h"

namespace lapwing {
namespace {

using namespace learned;
namespace fs = std::filesystem;

RayNetworkShape little() {
  RayNetworkShape shape;
  shape.rays = {6, 5};
  shape.width = 8;
  shape.convolutions = 2;
  return shape;
}

std::vector<std::uint8_t> random_image(const RayShape& rays, Random& random) {
  std::vector<std::uint8_t> bytes(rays.size());
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.integer(0, 255));
  return bytes;
}

// The same network in double precision, voxel by voxel as ray_network.h states it.
class SlowNetwork {
 public:
  SlowNetwork(const RayNetworkLayout& layout, const std::vector<float>& parameters)
      : layout_(layout), p_(parameters.begin(), parameters.end()) {}
  std::vector<double> p() const { return p_; }
  std::vector<double>& p() { return p_; }

  std::vector<double> answer(const std::vector<std::uint8_t>& bytes) const {
    const int columns = layout_.shape.rays.columns, rows = layout_.shape.rays.rows;
    const int width = layout_.shape.width;
    std::vector<float> inputs(static_cast<std::size_t>(layout_.rays() * RayNetworkLayout::kInputs));
    decode_rays(layout_, bytes.data(), false, inputs.data());
    std::vector<double> now;
    for (int ray = 0; ray < layout_.rays(); ++ray) {
      const float* in = inputs.data() + ray * RayNetworkLayout::kInputs;
      for (int o = 0; o < width; ++o) {
        double sum = at(layout_.first + bias(RayNetworkLayout::kInputs, width) + o);
        for (int i = 0; i < RayNetworkLayout::kInputs; ++i)
          sum += static_cast<double>(in[i]) * at(layout_.first + index(i, width, o));
        now.push_back(std::max(sum, 0.0));
      }
    }
    for (int k = 0; k < layout_.shape.convolutions; ++k) {
      const std::size_t begin = layout_.convolutions[static_cast<std::size_t>(k)];
      std::vector<double> next = now;
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
          for (int o = 0; o < width; ++o) {
            double sum = at(begin + bias(9 * width, width) + o);
            for (int tap = 0; tap < 9; ++tap) {
              const int v = y + (tap / 3 - 1) * (1 << k), u = x + (tap % 3 - 1) * (1 << k);
              if (v < 0 || u < 0 || v >= rows || u >= columns) continue;
              for (int i = 0; i < width; ++i)
                sum += now[index(v * columns + u, width, i)] *
                       at(begin + index(tap * width + i, width, o));
            }
            next[index(y * columns + x, width, o)] += std::max(sum, 0.0);
          }
      now = next;
    }
    std::vector<double> answers;
    for (int ray = 0; ray < layout_.rays(); ++ray) {
      double z = at(layout_.output + static_cast<std::size_t>(width));
      for (int o = 0; o < width; ++o) {
        double sum = at(layout_.last + bias(width, width) + o);
        for (int i = 0; i < width; ++i)
          sum += now[index(ray, width, i)] * at(layout_.last + index(i, width, o));
        z += std::max(sum, 0.0) * at(layout_.output + static_cast<std::size_t>(o));
      }
      answers.push_back(std::log1p(std::exp(z)));
    }
    return answers;
  }
  double loss(const std::vector<std::uint8_t>& bytes, const std::vector<float>& targets) const {
    const std::vector<double> told = answer(bytes);
    double sum = 0, all = 0, there = 0;
    for (std::size_t k = 0; k < told.size(); ++k) {
      const double t = static_cast<double>(targets[k]);
      sum += told[k] - t * std::log(told[k] + 1e-4);
      all += told[k];
      there += t;
    }
    return (sum + (all - there) * (all - there) / (there + 5)) / static_cast<double>(told.size());
  }

 private:
  static std::size_t index(int row, int width, int column) {
    return static_cast<std::size_t>(row * width + column);
  }
  static int bias(int inputs, int outputs) { return inputs * outputs; }
  double at(std::size_t k) const { return p_[k]; }

  const RayNetworkLayout& layout_;
  std::vector<double> p_;
};

TEST(RayNetwork, AnswersAsItsFormulaDoes) {
  const RayNetworkLayout layout(little());
  const std::vector<float> parameters = initial_parameters(layout, Random(2));
  const RayNetwork network(layout, parameters);
  const SlowNetwork slow(layout, parameters);
  Random random(3);
  for (int k = 0; k < 5; ++k) {
    const auto bytes = random_image(layout.shape.rays, random);
    std::vector<float> cells(static_cast<std::size_t>(layout.rays())), image;
    network.answer(bytes.data(), cells);
    const std::vector<double> expected = slow.answer(bytes);
    for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_NEAR(cells[i], expected[i], 1e-5);
    for (const std::uint8_t byte : bytes) image.push_back(static_cast<float>(byte) / 255);
    std::vector<float> again(cells.size());
    network.answer(image, again);
    for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_NEAR(cells[i], again[i], 1e-5);
  }
}

TEST(RayNetwork, EveryDerivativeIsThatOfTheLoss) {
  const RayNetworkLayout layout(little());
  const std::vector<float> parameters = initial_parameters(layout, Random(2));
  constexpr int kBatch = 11;
  RayBackpropagation network(layout, kBatch, 2);
  Random random(5);
  std::vector<std::vector<std::uint8_t>> images;
  std::vector<std::vector<float>> targets;
  for (int n = 0; n < kBatch; ++n) {
    images.push_back(random_image(layout.shape.rays, random));
    std::vector<float>& cells = targets.emplace_back();
    for (int k = 0; k < layout.rays(); ++k)
      cells.push_back(random.uniform() < 0.4 ? 0.0f : static_cast<float>(random.uniform(0, 6)));
    decode_rays(layout, images.back().data(), false, network.input(n));
    std::copy(cells.begin(), cells.end(), network.target(n));
  }
  std::vector<float> gradient(layout.parameters);
  const double loss = network.loss(parameters, gradient);
  SlowNetwork slow(layout, parameters);
  const auto slow_loss = [&] {
    double sum = 0;
    for (std::size_t n = 0; n < images.size(); ++n) sum += slow.loss(images[n], targets[n]);
    return sum / kBatch;
  };
  EXPECT_NEAR(loss, slow_loss(), 1e-5 * loss);
  double largest = 0;
  for (const float g : gradient) largest = std::max(largest, std::abs(static_cast<double>(g)));
  for (std::size_t k = 0; k < layout.parameters; ++k) {
    constexpr double kStep = 1e-6;
    double& p = slow.p()[k];
    const double was = p;
    p = was + kStep;
    const double above = slow_loss();
    p = was - kStep;
    const double below = slow_loss();
    p = was;
    EXPECT_NEAR(gradient[k], (above - below) / (2 * kStep), 2e-4 * largest) << "parameter " << k;
  }
}

TEST(RayNetwork, ThreadsChangeNothing) {
  const RayNetworkLayout layout(little());
  const std::vector<float> parameters = initial_parameters(layout, Random(2));
  std::vector<float> gradients[2];
  for (const int threads : {1, 3}) {
    RayBackpropagation network(layout, 20, threads);
    Random random(6);
    for (int n = 0; n < 20; ++n) {
      decode_rays(layout, random_image(layout.shape.rays, random).data(), n % 2 == 0,
                  network.input(n));
      std::fill_n(network.target(n), layout.rays(), static_cast<float>(n));
    }
    auto& gradient = gradients[threads / 2];
    gradient.resize(layout.parameters);
    network.loss(parameters, gradient);
  }
  EXPECT_EQ(gradients[0], gradients[1]);
}

TEST(RayNetwork, ShapesWithoutSenseAreRefused) {
  RayNetworkShape shape = little();
  shape.width = 12;
  EXPECT_THROW(RayNetworkLayout{shape}, InputError);
  shape = little();
  shape.convolutions = 9;
  EXPECT_THROW(RayNetworkLayout{shape}, InputError);
  EXPECT_TRUE(ray_network_shape_from(to_value(little())) == little());
}

TEST(LearnedRays, LearnsWhatIsEasy) {
  RayTraining fixture;
  const Value figures = fixture.run();
  EXPECT_GT(figures.at("validation_rho").as_number(), 0.97);
  const SampleSet set = read_samples(fixture.request.validation.front());
  const Prediction told = kRayTrainable.predict(fixture.request.model, set, 1);
  EXPECT_NEAR(told.loss, figures.at("validation_loss").as_number(), 1e-5);
  EXPECT_NEAR(rank_correlation(told.values, set.gains()), figures.at("validation_rho").as_number(),
              1e-6);
  const std::vector<float> gains = set.gains();
  double error = 0, all = 0;
  for (std::size_t k = 0; k < gains.size(); ++k) {
    error += std::abs(static_cast<double>(told.values[k] - gains[k]));
    all += static_cast<double>(gains[k]);
  }
  EXPECT_LT(error, 0.1 * all);
}

TEST(LearnedRays, ResumedItIsAsIfNeverStopped) {
  RayTraining fixture;
  fixture.given.set("epochs", 4);
  fixture.given.set("schedule", "cosine");
  fixture.run();
  const std::string whole = read_file(fixture.request.model);
  std::filesystem::remove(fixture.request.model);
  std::filesystem::remove(fixture.request.checkpoint);
  fixture.given.set("until", 2);
  fixture.run();
  fixture.given.set("until", 0);
  fixture.request.resume = true;
  fixture.request.threads = 2;
  fixture.run();
  EXPECT_EQ(read_file(fixture.request.model), whole);
}

TEST(LearnedRays, ModelsOfBothNetworksAreToldApart) {
  RayTraining fixture;
  fixture.given.set("epochs", 1);
  fixture.run();
  const SampleSet set = read_samples(fixture.request.validation.front());
  try {
    kGridTrainable.predict(fixture.request.model, set, 1);
    ADD_FAILURE() << "a model of rays is taken for one of a grid";
  } catch (const InputError& error) {
    const std::string told = error.what();
    EXPECT_NE(told.find("a.model' is a model that reads rays"), std::string::npos) << told;
  }
  fixture.given.set("rays", to_value(RayShape{7, 5}));
  fixture.request.model = fixture.folder / "b.model";
  fixture.request.checkpoint = fixture.folder / "b.checkpoint";
  const std::string other = fixture.refusal();
  EXPECT_NE(other.find("holds samples of another input"), std::string::npos) << other;
}

TEST(LearnedRays, ABuildWithoutLibtorchSaysWhichHasIt) {
  RayTraining training;
  training.given.set("backend", "libtorch");
  const std::string told = training.refusal();
  EXPECT_NE(told.find("cmake --preset learn"), std::string::npos) << told;
  EXPECT_FALSE(std::filesystem::exists(training.request.model));
}

// Of four rounds of its recipe, each begun with the model of the one before; no world that is
// validated or judged by is among those that it was trained in.
const fs::path kShipped = fs::path(LAPWING_SOURCE_DIR) / "plugins/utilities/learned";

void add_worlds(const Value& provenance, std::set<std::string>& worlds) {
  for (const Value& world : provenance.at("worlds").as_list()) worlds.insert(world.as_text());
  if (const Value* begin = provenance.find("begin")) add_worlds(*begin, worlds);
}

// Rows such as "| street 1 | `learned` | ..." of the file of experiments.
TEST(LearnedRays, NoWorldOfTheFiguresWasSeenInTraining) {
  const std::string text = read_file(kShipped / "EXPERIMENTS.md");
  const std::regex row("\\n\\| ([a-z]+ [0-9]+) \\| `(learned|learned_grid)` \\|");
  std::set<std::string> figures;
  for (std::sregex_iterator at(text.begin(), text.end(), row), end; at != end; ++at)
    figures.insert((*at)[1]);
  EXPECT_EQ(figures.size(), 10u);
  for (const char* file : {"learned.model", "learned_grid.model"}) {
    std::set<std::string> trained;
    add_worlds(read_model(kShipped / file).provenance, trained);
    EXPECT_GT(trained.size(), 20u) << file;
    for (const std::string& world : figures) EXPECT_FALSE(trained.contains(world)) << world;
    // Of the tables of the thesis.
    for (const char* world : {"downtown 801", "district 801", "courtyard 801", "towers 801",
                              "suburb 801", "district 201"})
      EXPECT_FALSE(trained.contains(world)) << world << " " << file;
  }
}

TEST(LearnedRays, TheShippedModelIsThatOfItsRecipe) {
  const fs::path folder = kShipped;
  const Model model = read_model(folder / "learned.model");
  EXPECT_TRUE(model.ray_network(folder / "learned.model") == RayNetworkShape{});
  EXPECT_EQ(model.mapping.at("resolution").as_number(), 0.4);
  EXPECT_LT(fs::file_size(folder / "learned.model"), 4u << 20);
  const std::string log = read_file(folder / "learned.model.log");
  // `lapwing train all --hours 1`: each round is trained with its worlds and those before it.
  const TrainingRecipe recipe =
      read_recipe(fs::path(LAPWING_SOURCE_DIR) / "configs/train/learned.yaml").within(1);
  ASSERT_EQ(recipe.rounds.size(), 4u);
  const Value* from = &model.provenance;
  for (std::size_t round = 4; round >= 1; --round) {
    ASSERT_NE(from, nullptr) << round;
    const std::string rho = to_json(from->at("validation_rho"), -1);
    EXPECT_NE(log.find("\"validation_rho\":" + rho), std::string::npos) << rho;
    std::set<std::string> said, trained;
    for (std::size_t k = 0; k < round; ++k)
      for (const RecipeSamples& samples : recipe.rounds[k].samples)
        for (const std::string& scene : samples.scenes)
          for (std::int64_t seed = samples.first; seed <= samples.last; ++seed)
            said.insert(scene + " " + std::to_string(seed));
    for (const Value& world : from->at("worlds").as_list()) trained.insert(world.as_text());
    EXPECT_EQ(trained, said) << round;
    from = from->find("begin");
  }
  EXPECT_EQ(from, nullptr);
}

}  // namespace
}  // namespace lapwing
