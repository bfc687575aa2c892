// SPDX-License-Identifier: Apache-2.0
// Surfaces for the obstacles of a plan document, which records only what they are made from.
#pragma once

#include <filesystem>

#include "framework/plugin/registry.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// Opens the shape of every obstacle that needs no file, by the plugin that it names; of a mesh it
// reads the triangles of the file in `folder`, where the plan lies. What cannot be opened stays as
// it is: the certificate says what is wrong with it.
void open_surfaces(Environment& environment, const Registry& registry,
                   const std::filesystem::path& folder);

}  // namespace lapwing
