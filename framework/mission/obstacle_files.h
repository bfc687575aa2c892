// SPDX-License-Identifier: Apache-2.0
// The shapes that flights keep away from: opened once a mission. Files of theirs are copied to a
// folder of the mission's own as the plan will name them.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "framework/shape/shape.h"

namespace lapwing {

class ObstacleFiles {
 public:
  ObstacleFiles();
  ~ObstacleFiles();  // the folder goes with it
  ObstacleFiles(ObstacleFiles&&) noexcept;

  // Shapes by all that they were made from, so that problems that are stated again share them.
  std::shared_ptr<const Shape>& shape(const std::string& key);

  // Keeps the bytes under a name of the caller's own, in place of what had it: their SHA-256.
  std::string keep(const std::string& name, const std::string& bytes);
  // Under the next name with this ending: obstacle_1.ply, obstacle_2.ot. Equal bytes are kept once.
  KeptFile keep_copy(const std::string& bytes, const std::string& ending);

  // Of all that is kept. Empty while there is nothing.
  const std::filesystem::path& folder() const;
  const std::vector<std::string>& files() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lapwing
