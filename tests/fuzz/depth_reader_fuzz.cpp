// SPDX-License-Identifier: Apache-2.0
// Folders of depth images: whatever the bytes of a picture, a pose or a camera, a frame of finite
// or missing depths under a rotation, or an InputError. The first byte says which file they are.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>

#include "framework/core/error.h"
#include "framework/core/png.h"
#include "framework/geometry/depth_folder.h"
#include "tests/fuzz/scratch_folder.h"

namespace {

void write(const char* name, const std::string& bytes) {
  std::ofstream(lapwing::scratch_folder() / name, std::ios::binary) << bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  if (size == 0) return 0;
  const std::string given(reinterpret_cast<const char*>(data + 1), size - 1);
  static const std::string picture = encode_grey16_png({4, 3, std::vector<std::uint16_t>(12, 900)});
  const int which = data[0] % 3;
  write("a.depth.png", which == 0 ? given : picture);
  write("a.pose.txt", which == 1 ? given : "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  write("camera-intrinsics.txt", which == 2 ? given : "585 0 2\n0 585 1.5\n0 0 1\n");
  try {
    const DepthFolder folder(scratch_folder());
    const PosedDepthImage frame = folder.read(0);
    if (std::abs(frame.camera.orientation.norm() - 1) > 1e-9) std::abort();
    const auto pixels = static_cast<std::size_t>(frame.image.pinhole.width) *
                        static_cast<std::size_t>(frame.image.pinhole.height);
    if (frame.image.depth.size() != pixels) std::abort();
    for (const float depth : frame.image.depth)
      if (std::isnan(depth) || depth < 0) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
