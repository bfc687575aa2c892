// SPDX-License-Identifier: Apache-2.0
// The strategies of films without a solver: outcomes are made up, and the requests that follow
// from them are looked at.
#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

class FilmStrategies : public MissionTest {
 protected:
  // What the function of this body returns, as text.
  std::string result(const std::string& body) {
    return load(R"(
      local requests = require "mission.film_request"
      local stretching = require "mission.film_stretch"
      local passages = require "mission.passages"
      local checks = { name = "clearance", required = true, pass = false, at = 3 }
      local function outcome(request, holds, legs)
        return requests.outcome { request = request, holds = holds, legs = legs or request.legs,
          solution = { status = "optimal", message = "", violations = {} },
          verdict = { feasible = holds, failures = holds and {} or { "clearance of 0.1 m" },
                      checks = holds and {} or { checks } } }
      end
      local run = { options = { passages = 2 }, cancelled = function() return false end }
      local function result() )" +
                body + R"( end
      return { kind = "test", name = tostring(result()), options = {}, plan = function() end })")
        ->name();
  }
  // The message of the error that the body ends in.
  std::string refused(const std::string& body) {
    return result("return select(2, pcall(function() " + body + " end))");
  }
};

TEST_F(FilmStrategies, RequestsAreNeverChanged) {
  EXPECT_NE(refused("requests.first {}.stretch = 2").find("a request cannot be changed"),
            std::string::npos);
  EXPECT_NE(refused("return requests.first {}.strech").find("a request has no field 'strech'"),
            std::string::npos);
  EXPECT_NE(refused("requests.first { camera = 1 }").find("a request has no field 'camera'"),
            std::string::npos);
  EXPECT_EQ(result(R"(
      local request = requests.first { duration = 8 }
      local longer = requests.with(request, { stretch = 2 })
      return request.stretch .. " " .. longer.stretch .. " " .. longer.duration)"),
            "1 2 8");
  EXPECT_NE(refused("outcome(requests.first {}, true).holds = false")
                .find("an outcome cannot be changed"),
            std::string::npos);
}

// The flight holds from `flight` on, the film with its camera from `film` on.
constexpr const char* kStretches = R"(
      local function found(flight, film, least, cancelled_after)
        local run = { cancelled = function() return false end }
        local request, tries = stretching.first(requests.first { stretch = 1 }, least), 0
        local last
        while request do
          tries = tries + 1
          local needed = request.scope == "flight" and flight or film
          last = outcome(request, request.stretch >= needed)
          request = stretching.next(run, last)
        end
        return last, tries
      end )";

TEST_F(FilmStrategies, TheSmallestStretchIsFoundToOnePercent) {
  EXPECT_EQ(result(std::string(kStretches) + R"(
      for i = 0, 60 do
        local flight = 1.001 * 1.07 ^ i
        if flight < 37 then
          local last, tries = found(flight, flight, 0)
          local share = last.request.stretch / flight
          if not last.holds or last.request.scope ~= "film" or share < 1 or share > 1.0101
             or tries > 20 then
            return string.format("%.4g: %.4g after %d", flight, last.request.stretch, tries)
          end
        end
      end
      return "all")"),
            "all");
}

TEST_F(FilmStrategies, TheCameraMayNeedMoreAndNothingMayDo) {
  EXPECT_EQ(result(std::string(kStretches) + R"(
      local last = found(2, 2.3, 0)
      local enough = last.holds and last.request.stretch >= 2.3 and last.request.stretch < 2.45
      local start = stretching.first(requests.first { stretch = 1 }, 6)
      local never = found(100, 100, 0)
      return string.format("%s %s %.4g %s", enough, start.scope, start.stretch, never.holds))"),
            "true flight 6.3 false")
      << "below `least` no flight is tried";
}

// Two legs; the second one fails at 3 s.
constexpr const char* kPassages = R"(
      local function way(y)
        return { lapwing.vector(0, 0, 0), lapwing.vector(1, y, 0), lapwing.vector(2, 0, 0) }
      end
      local keyframes = { { time = 0 }, { time = 2 }, { time = 4 } }
      local request = requests.first { keyframes = keyframes }
      local function legs(y)
        return { { failed = {}, way = way(0) }, { failed = {}, way = way(y) } }
      end
      local first = outcome(request, false, legs(1)) )";

TEST_F(FilmStrategies, APassageIsTriedInACorridorAndThenAnother) {
  EXPECT_EQ(result(std::string(kPassages) + R"(
      local within = passages.next(run, first)
      local inside = outcome(within, false)
      local other, told = passages.next(run, inside)
      local closed = other.legs[2]
      local text = string.format("%s %s %s %d %s %d |", within.corridor, within.legs[2].way ~= nil,
        other.corridor, #closed.failed, closed.way, #inside.legs[2].failed)
      for _, note in ipairs(told.notes) do text = text .. note .. "|" end
      return text)"),
            "true true false 1 nil 0 |passage 1 of leg 2, 2.83 m long: clearance of 0.1 m|"
            "passage 1 of leg 2 in a corridor, 2.83 m long: clearance of 0.1 m|")
      << "the outcome itself keeps its way";
}

TEST_F(FilmStrategies, PassagesEndWhereOneHoldsOrNoneIsLeft) {
  const std::string search = std::string(kPassages) + R"(
      local function search(certified, planned)
        local request, told = passages.next(run, first)
        local tries, last = 1, first
        while request do
          tries = tries + 1
          local legs = request.legs
          if not legs[2].way then
            legs = { legs[1], { failed = legs[2].failed, why = not planned and "no way" or nil,
                                way = planned and way(tries) or nil } }
          end
          last = outcome(request, tries == certified, legs)
          request, told = passages.next(run, last)
        end
        local entry = told.entries[#told.entries]
        return string.format("%d %d %d %s %s", tries, #told.entries, entry.number, entry.corridor,
                             entry.certified) .. (told.notes[#told.notes] or "")
      end )";
  EXPECT_EQ(result(search + "return search(2, true)").substr(0, 15), "2 2 1 true true");
  EXPECT_EQ(result(search + "return search(3, true)").substr(0, 16), "3 3 2 false true");
  // Two passages, each in the open and in a corridor, and the third one in the open.
  EXPECT_EQ(result(search + "return search(9, true)").substr(0, 16), "5 4 2 true false");
  EXPECT_EQ(result(search + "return search(3, false)").substr(0, 16), "3 3 2 false true")
      << "the straight way will do, where it is certified";
  EXPECT_EQ(result(search + "return search(9, false)"), "3 2 1 true falseleg 2: no way");
}

}  // namespace
}  // namespace lapwing
