// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/frames.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "framework/core/json.h"
#include "framework/studio/patch.h"

namespace lapwing {
namespace {

bool write_all(int descriptor, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t count = ::write(descriptor, data, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    data += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

bool read_all(int descriptor, char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t count = ::read(descriptor, data, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    data += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

bool read_text(int descriptor, std::uint32_t size, std::string& text) {
  text.resize(size);
  return read_all(descriptor, text.data(), size);
}

}  // namespace

bool write_frame(int descriptor, const Frame& frame) {
  const std::string header = to_json(frame.header, -1);
  std::vector<std::uint32_t> sizes{static_cast<std::uint32_t>(frame.parts.size()),
                                   static_cast<std::uint32_t>(header.size())};
  std::size_t total = header.size();
  for (const std::string& part : frame.parts) {
    sizes.push_back(static_cast<std::uint32_t>(part.size()));
    total += part.size();
  }
  if (total > kLargestFrame || frame.parts.size() > kMostParts)
    throw Error("an answer of " + std::to_string(total) + " bytes is more than a studio takes");
  std::string bytes(sizes.size() * sizeof sizes[0], '\0');
  std::memcpy(bytes.data(), sizes.data(), bytes.size());
  bytes += header;
  for (const std::string& part : frame.parts) bytes += part;
  return write_all(descriptor, bytes.data(), bytes.size());
}

std::optional<Frame> read_frame(int descriptor) {
  std::uint32_t head[2] = {};  // parts, bytes of the header
  if (!read_all(descriptor, reinterpret_cast<char*>(head), sizeof head)) return std::nullopt;
  if (head[0] > kMostParts || head[1] > kLargestFrame) throw Error("not a frame");
  std::vector<std::uint32_t> sizes(head[0]);
  if (!read_all(descriptor, reinterpret_cast<char*>(sizes.data()), sizes.size() * sizeof sizes[0]))
    return std::nullopt;
  std::size_t total = head[1];
  for (const std::uint32_t size : sizes) total += size;
  if (total > kLargestFrame) throw Error("not a frame");
  std::string header;
  Frame frame;
  if (!read_text(descriptor, head[1], header)) return std::nullopt;
  frame.header = without_origins(from_json(header, "frame"));
  for (const std::uint32_t size : sizes)
    if (!read_text(descriptor, size, frame.parts.emplace_back())) return std::nullopt;
  return frame;
}

}  // namespace lapwing
