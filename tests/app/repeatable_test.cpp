// SPDX-License-Identifier: Apache-2.0
// The same script gives the same plan in every process, also where it asks for what Lua makes of
// addresses, of a random seed or of the clock.
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

using Repeatable = CommandLine;

// Each line adds to `out` what one way of asking gives.
constexpr const char* kAsking = R"lua(
local film = require 'mission.film'
local out = {}
local function note(...) out[#out + 1] = table.concat({...}, ' ') end
local objects = {}
for i = 1, 40 do objects[i] = i % 4 == 0 and function() return i end or {} end

-- next and pairs, over texts, texts that hold NUL, numbers that doubles confuse, and objects
local names, whole, mixed = {}, {}, {}
for i = 1, 60 do names['a\0' .. i] = i whole[(1 << 53) + i] = i end
for i, o in ipairs(objects) do mixed[o] = i end
mixed[coroutine.create(print)] = 41
mixed[true], mixed[2.5], mixed.text, mixed[print], mixed[math.sin] = 42, 43, 44, 45, 46
for _, t in ipairs { names, whole, mixed } do
  for _, v in pairs(t) do note(v) end
  for _, v in next, t do note(v) end
  local k, v = next(t)
  while k do note(v) k, v = next(t, k) end
end

-- texts of objects
note(tostring(objects[3]), tostring(objects[4]), tostring(print), tostring(coroutine.running()))
note(string.format('%p %s %10s', objects[5], objects[6], objects[8]), tostring(lapwing.options))
note(tostring(setmetatable({}, { __name = 'own' })), string.format('%s', note))
note(select(2, pcall(error, objects[1])) == objects[1] and 'same' or 'other')

-- entries that compare equal, and a comparison that contradicts itself
local ties, ramp, state = {}, {}, 1
for i = 1, 3000 do ties[i], ramp[i] = { i % 7, i }, i end
table.sort(ties, function(a, b) return a[1] < b[1] end)
local function contradictory()
  state = (state * 1103515245 + 12345) % 2147483648
  return state % 3 == 0
end
table.sort(ramp, contradictory)
for i = 1, 60 do note(ties[i * 50][2], ramp[i * 50]) end

-- what a weak table still holds
local weak, kept = setmetatable({}, { __mode = 'k' }), 0
for i = 1, 150000 do weak[{ name = 'n' .. i % 100, [i] = i }] = i end
for _ in pairs(weak) do kept = kept + 1 end
note(kept)

-- chance
note(math.random(), math.random(1000))

return film.shot {
  name = 'asking',
  keyframes = { { position = {0, 0, 2} }, { position = {6, 0, 4} } },
  obstacles = { { type = 'sphere', name = table.concat(out, ' '), center = {3, 9, 9},
                  radius = 1 } },
}
)lua";

TEST_F(Repeatable, SixProcessesGiveOnePlan) {
  write("asking.lua", kAsking);
  std::string first;
  for (int i = 0; i < 6; ++i) {
    fs::remove_all(folder_ / "out");
    const Finished finished = run({"run", "asking.lua"});
    ASSERT_EQ(finished.status, 0) << finished.err;
    const std::string plan = read_file(folder_ / "out/asking/plan.json");
    ASSERT_NE(plan.find("own: 0x"), std::string::npos);
    if (i == 0) first = plan;
    EXPECT_EQ(plan, first) << "run " << i + 1;
  }
}

// Messages as well: they may stand in notes, and people compare them.
TEST_F(Repeatable, SixProcessesGiveOneMessage) {
  write("failing.lua",
        "local t = {}\nfor i = 1, 9 do t[{}] = i end\n"
        "for k, v in pairs(t) do if v > 3 then error(tostring(k) .. v) end end");
  std::string first;
  for (int i = 0; i < 6; ++i) {
    const Finished finished = run({"run", "failing.lua"});
    EXPECT_EQ(finished.status, 2);
    if (i == 0) first = finished.err;
    EXPECT_EQ(finished.err, first);
  }
  EXPECT_NE(first.find("failing.lua:3: table: 0x"), std::string::npos) << first;
}

}  // namespace
}  // namespace lapwing
