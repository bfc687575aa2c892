// What a network that was trained on an oracle's scores says of a view.
//
//   utility: learned
//   utility: {type: learned, model: my.model}
#include "framework/core/error.h"
#include "framework/core/library_path.h"
#include "framework/core/parallel.h"
#include "framework/plugin/plugin.h"
#include "plugins/utilities/learned/fit.h"
#include "plugins/utilities/learned/model_file.h"

namespace lapwing {
namespace {

using learned::Model;

// Beside this library, in a build tree or an installed one.
std::filesystem::path shipped_model() {
  const std::filesystem::path folder = library_folder();
  for (const char* tree : {"plugins", "lapwing/plugins"}) {
    const auto path = folder / tree / "utilities" / "learned.model";
    if (std::filesystem::exists(path)) return path;
  }
  throw InputError(
      "utility 'learned': the shipped model is not beside its library; name one "
      "with model: FILE");
}

class Learned final : public ViewUtility {
 public:
  static constexpr PluginText kText{"learned", "1.0.0",
                                    "a network that was trained on an oracle's scores",
                                    "thesis 5.4.3, 5.5.1"};
  static ParameterTable parameters() {
    return ParameterTable()
        .text("model", "", "file of a trained model; empty: the one that is shipped")
        .boolean("blank", false, "see nothing of the map: what a model knows without it");
  }
  static std::span<const Extension> extensions() {
    static const Trainable trainable{&learned::fit_parameters, &learned::fit_shape, &learned::fit,
                                     &learned::predict, &learned::loss_of};
    static const Extension all[] = {{kTrainable, &trainable}};
    return all;
  }
  explicit Learned(const Parameters& p)
      : model_(learned::read_model(
            p.text("model").empty() ? shipped_model() : std::filesystem::path(p.text("model")))),
        network_(learned::NetworkLayout(model_.shape), model_.state),
        blank_(p.boolean("blank")) {}

  void require_fit(const EpisodeView& known) const override {
    const std::string difference = mapping_difference(mapping_of(known), model_.mapping);
    if (!difference.empty())
      throw InputError("utility 'learned' was trained with another mapping: " + difference);
  }

 protected:
  void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                 std::span<double> values) const override {
    const GridShape& shape = model_.shape.grid;
    known.means->refresh(shape.levels);
    parallel_for(views.size(), known.threads, [&](std::size_t i) {
      thread_local std::vector<float> grid;
      grid.resize(shape.size());
      if (blank_)
        for (std::size_t k = 0; k < grid.size(); ++k) grid[k] = k % 2 == 0 ? 0.5f : 1.0f;
      else
        sample_grid(known, views[i], shape, grid);
      values[i] = model_.target_of(static_cast<double>(network_.answer(grid)));
    });
  }

 private:
  Model model_;
  learned::FoldedNetwork network_;
  bool blank_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Learned)
