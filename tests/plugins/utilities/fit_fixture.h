// SPDX-License-Identifier: Apache-2.0
// Training on samples that are easy to learn, in a folder of its own.
#pragma once

#include "framework/core/error.h"
#include "plugins/utilities/learned/fit.h"

namespace lapwing {

struct TrainingFolder {
  using WriteSamples = void (*)(const std::filesystem::path& folder, int files, std::uint64_t seed);

  const Trainable& trainable;
  std::filesystem::path folder;
  FitRequest request;
  Value given = Value::map();

  TrainingFolder(const Trainable& trained, const char* name, WriteSamples write, int files)
      : trainable(trained), folder(std::filesystem::path(testing::TempDir()) / name) {
    std::filesystem::remove_all(folder);
    write(folder / "training", files, 1);
    write(folder / "validation", 1, 2);
    request.training = sample_files({folder / "training"});
    request.validation = sample_files({folder / "validation"});
    request.model = folder / "a.model";
    request.checkpoint = folder / "a.checkpoint";
  }
  ~TrainingFolder() { std::filesystem::remove_all(folder); }

  Value run() { return trainable.fit(check(trainable.fit_parameters(), given), request); }
  // What it says; empty where it does not refuse.
  std::string refusal() {
    try {
      run();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

}  // namespace lapwing
