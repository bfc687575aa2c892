// SPDX-License-Identifier: Apache-2.0
// Parts of Lapwing in libraries of their own, because what they need is heavy or optional.
#pragma once

namespace lapwing {

// The function of this name in the library lapwing/NAME beside liblapwing, or in the folder of the
// build. The library is opened by the first call and stays open. Null where it was not built.
// Error with the loader's reason where it cannot be opened, or has no such function.
void* side_function(const char* library, const char* function);

}  // namespace lapwing
