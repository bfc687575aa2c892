// SPDX-License-Identifier: Apache-2.0
#include "plugins/exporters/gltf/playback.h"

#include <algorithm>
#include <cstring>

#include "framework/core/json.h"
#include "framework/export/camera_track.h"

namespace lapwing::gltf_file {
namespace {

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  if (at + 4 > bytes.size()) throw Error("gltf: the file is cut short");
  std::memcpy(&number, bytes.data() + at, 4);
  return number;
}

const Value& entry(const Value& document, const char* list, const Value& number) {
  return document.at(list).as_list().at(static_cast<std::size_t>(number.as_integer()));
}

std::vector<double> numbers(const Value& document, const std::string& buffer,
                            const Value& accessor_number) {
  const Value& accessor = entry(document, "accessors", accessor_number);
  const Value& view = entry(document, "bufferViews", accessor.at("bufferView"));
  const std::string& type = accessor.at("type").as_text();
  const auto width = type == "SCALAR" ? 1u : static_cast<unsigned>(type.back() - '0');
  const auto count = static_cast<std::size_t>(accessor.at("count").as_integer()) * width;
  const auto offset = static_cast<std::size_t>(view.at("byteOffset").as_integer());
  if (offset + 4 * count > buffer.size()) throw Error("gltf: the buffer is cut short");
  std::vector<float> read(count);
  std::memcpy(read.data(), buffer.data() + offset, 4 * count);
  return {read.begin(), read.end()};
}

}  // namespace

AnimatedNode animated_node(const std::string& file) {
  const std::size_t json_size = word(file, 12);
  const Value document = from_json(std::string_view(file).substr(20, json_size), "gltf");
  const std::string buffer = file.substr(28 + json_size, word(file, 20 + json_size));
  AnimatedNode node;
  const Value& animation = document.at("animations").as_list().front();
  for (const Value& channel : animation.at("channels").as_list()) {
    if (channel.at("target").at("node").as_integer() != 0) continue;
    const Value& sampler = entry(animation, "samplers", channel.at("sampler"));
    node.times = numbers(document, buffer, sampler.at("input"));
    const std::vector<double> out = numbers(document, buffer, sampler.at("output"));
    if (channel.at("target").at("path").as_text() == "translation")
      for (std::size_t i = 0; i + 2 < out.size(); i += 3)
        node.places.emplace_back(out[i], out[i + 1], out[i + 2]);
    else
      for (std::size_t i = 0; i + 3 < out.size(); i += 4)
        node.turns.emplace_back(out[i + 3], out[i], out[i + 1], out[i + 2]);
  }
  if (node.places.empty() || node.places.size() != node.times.size() ||
      node.turns.size() != node.times.size())
    throw Error("gltf: the first node is not animated");
  return node;
}

Pose AnimatedNode::at(double time) const {
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  const std::size_t i =
      next == times.begin() ? 0 : static_cast<std::size_t>(next - times.begin()) - 1;
  const std::size_t j = std::min(i + 1, times.size() - 1);
  const double share = j == i ? 0 : std::clamp((time - times[i]) / (times[j] - times[i]), 0.0, 1.0);
  return from_y_up(places[i] + share * (places[j] - places[i]),
                   turns[i].slerp(share, turns[j]).normalized());
}

}  // namespace lapwing::gltf_file
