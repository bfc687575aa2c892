// SPDX-License-Identifier: Apache-2.0
#include "framework/core/random.h"

#include "framework/core/error.h"

namespace lapwing {
namespace {

// An independent statement of the generator, from the published recurrence, in other words than the
// kernel's: a ring of four named words and explicit rotations.
struct Reference {
  std::uint64_t a, b, c, d;
  static std::uint64_t rotated(std::uint64_t x, int k) { return (x << k) + (x >> (64 - k)); }
  std::uint64_t next() {
    const std::uint64_t result = rotated(a + d, 23) + a;
    const std::uint64_t c1 = c ^ a;
    const std::uint64_t d1 = d ^ b;
    const std::uint64_t b1 = b ^ c1;
    const std::uint64_t a1 = a ^ d1;
    c = c1 ^ (b << 17);
    d = rotated(d1, 45);
    b = b1;
    a = a1;
    return result;
  }
};

TEST(Random, SeedsThroughSplitmix64) {
  // The published splitmix64 stream of seed 1234567 seeds the reference; the streams agree.
  Reference reference{6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
                      4593380528125082431ULL};
  Random random(1234567);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(random.bits(), reference.next()) << "draw " << i;
}

TEST(Random, UniformStaysInItsHalfOpenInterval) {
  Random random(1);
  double lowest = 1.0, highest = 0.0, sum = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double u = random.uniform();
    lowest = std::min(lowest, u);
    highest = std::max(highest, u);
    sum += u;
  }
  EXPECT_GE(lowest, 0.0);
  EXPECT_LT(highest, 1.0);
  EXPECT_NEAR(sum / 100000, 0.5, 0.005);
  // Two neighbouring doubles: rounding must not return the excluded end.
  const double high = std::nextafter(1.0, 2.0);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(random.uniform(1.0, high), 1.0);
  EXPECT_THROW(random.uniform(1.0, 1.0), Error);
}

TEST(Random, IntegersAreUnbiasedAndReachBothEnds) {
  Random random(2);
  std::array<int, 3> counts{};
  for (int i = 0; i < 30000; ++i) ++counts[static_cast<std::size_t>(random.integer(-1, 1) + 1)];
  for (const int count : counts) EXPECT_NEAR(count, 10000, 400);
  const std::int64_t low = std::numeric_limits<std::int64_t>::min();
  const std::int64_t high = std::numeric_limits<std::int64_t>::max();
  EXPECT_NE(random.integer(low, high), random.integer(low, high));
  EXPECT_EQ(random.integer(7, 7), 7);
  EXPECT_THROW(random.integer(1, 0), Error);
}

TEST(Random, NormalHasMeanZeroAndDeviationOne) {
  Random random(3);
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  constexpr int kCount = 200000;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 0.01);
  EXPECT_NEAR(squares / kCount, 1.0, 0.02);
  EXPECT_NEAR(fourth / kCount, 3.0, 0.1);  // a uniform or a sum of few uniforms has less
}

TEST(Random, SplitsDependOnStateAndIndexAlone) {
  const Random random(4);
  EXPECT_EQ(random.split(0).bits(), random.split(0).bits());
  EXPECT_NE(random.split(0).bits(), random.split(1).bits());
  Random later(4);
  later.bits();
  EXPECT_NE(random.split(0).bits(), later.split(0).bits());
}

}  // namespace
}  // namespace lapwing
