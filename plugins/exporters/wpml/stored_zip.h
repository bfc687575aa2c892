// SPDX-License-Identifier: Apache-2.0
// Zip archives without compression, and the contents of such.
#pragma once

#include <string>

#include "framework/core/folders.h"

namespace lapwing::wpml_file {

// Names may have folders: "wpmz/template.kml". Equal files give equal bytes; the date is 1980.
std::string zip_bytes(const NamedContents& files);
// Of an archive that was stored so. InputError where it holds no file of that name.
std::string file_in_zip(const std::string& zip, const std::string& name);

}  // namespace lapwing::wpml_file
