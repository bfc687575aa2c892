// SPDX-License-Identifier: Apache-2.0
// The program with missions of other kinds than films: what a page is told of them.
#pragma once

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
};

}  // namespace lapwing
