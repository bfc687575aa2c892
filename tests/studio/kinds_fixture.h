// SPDX-License-Identifier: Apache-2.0
// The program with missions of other kinds than films: what a page is told of them.
#pragma once

#include "framework/map/map_file.h"
#include "tests/studio/program_fixture.h"

namespace lapwing {

class StudioKinds : public StudioProgram {
 protected:
  // The message `world`, and the judged answer of the first revision.
  std::pair<Value, Value> told(PageClient& page) {
    Value world;
    const Value answer = page.until([&](const Value& m) {
      if (m.at("type") == Value("world")) world = m;
      return m.at("type") == Value("answer") &&
             (m.at("grade") == Value("certified") || m.at("grade") == Value("rejected") ||
              m.at("grade") == Value("refused"));
    });
    EXPECT_EQ(answer.at("grade"), Value("certified")) << to_json(answer.at("message"));
    return {world, answer};
  }
  static std::string blob(const StudioAddress& address, const Value& name) {
    const std::string got =
        answer_to(address.port, "GET /blob/" + name.as_text() +
                                    " HTTP/1.1\r\nHost: " + address.host() + "\r\n\r\n");
    return got.substr(got.find("\r\n\r\n") + 4);
  }
  static Value picture(PageClient& page, double time) {
    page.send_text(R"({"type": "picture", "edit": 1, "time": )" + std::to_string(time) +
                   R"(, "width": 64, "height": 36})");
    return page.until([](const Value& m) {
      return m.at("type") == Value("picture") || m.at("type") == Value("failed");
    });
  }
  // A settled exploration is planned anew with so many images. It is paused before its first one,
  // so that it waits after that one, however slow the page is. Its first image.
  static Value plan_paused(PageClient& page, std::int64_t steps) {
    EXPECT_TRUE(page.send_together(to_json(gesture("g", 1, {change("steps", steps)}), -1),
                                   R"({"type": "pace", "pace": "pause"})"));
    Value first = page.until_type("image");
    EXPECT_EQ(first.at("image"), Value(1));
    return first;
  }
};

// A page that asks about the map of one plan; all is compared with the map that a run writes.
class StudioAsked : public StudioKinds {
 protected:
  // The answer of the first revision.
  Value open_page(const std::vector<std::string>& options) {
    address_ = std::make_unique<StudioAddress>(serve(options));
    page_ = std::make_unique<PageClient>(*address_, "a");
    const auto [world, answer] = told(*page_);
    world_ = world;
    return answer;
  }
  Value ask(const std::string& members) {
    page_->send_text("{\"id\": \"q\", " + members + "}");
    return page_->until([](const Value& m) { return m.find("id") && m.at("id") == Value("q"); });
  }
  std::string why(const std::string& members) {
    const Value answer = ask(members);
    EXPECT_EQ(answer.at("type"), Value("failed")) << to_json(answer);
    return answer.find("why") ? answer.at("why").as_text() : "";
  }
  // What the map of the run says of a voxel; nothing where it is unknown.
  std::optional<VoxelLeaf> written(const VoxelKey& key) const {
    for (const VoxelLeaf& leaf : map_.leaves) {
      const int size = 1 << leaf.level;
      bool in = true;
      for (int i = 0; i < 3; ++i) in = in && key[i] >= leaf.key[i] && key[i] < leaf.key[i] + size;
      if (in) return leaf;
    }
    return std::nullopt;
  }

  std::unique_ptr<StudioAddress> address_;
  std::unique_ptr<PageClient> page_;
  Value world_;
  MapFile map_;  // of the run
};

}  // namespace lapwing
