// SPDX-License-Identifier: Apache-2.0
#include "framework/app/progress_line.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace lapwing {
namespace {

struct ProgressLineTest : testing::Test {
  double now = 100;
  std::ostringstream out;

  ProgressLine make(ProgressStyle style, int columns = 80) {
    return ProgressLine("solve", out, style, columns, [this] { return now; });
  }
  std::string taken() {
    std::string text = out.str();
    out.str("");
    return text;
  }
};

TEST_F(ProgressLineTest, RedrawsWithElapsedAndEstimate) {
  ProgressLine line = make(ProgressStyle::redrawn);
  line.report(0.0, "iteration 0");
  EXPECT_EQ(taken(), "\r\x1b[Ksolve  iteration 0  0 %  0:00");
  now += 12;
  line.report(0.375, "iteration 4");
  EXPECT_EQ(taken(), "\r\x1b[Ksolve  iteration 4  37 %  0:12, about 0:20 left");
  now += 3600;
  line.report(1, "done");
  EXPECT_EQ(taken(), "\r\x1b[Ksolve  done  100 %  1:00:12");
}

TEST_F(ProgressLineTest, RedrawsAtMostTenTimesASecond) {
  ProgressLine line = make(ProgressStyle::redrawn);
  int drawn = 0;
  for (int i = 0; i < 1000; ++i) {
    now += 0.001;
    line.report(0.5, "x");
    drawn += taken().empty() ? 0 : 1;
  }
  EXPECT_GE(drawn, 9);
  EXPECT_LE(drawn, 10);
}

TEST_F(ProgressLineTest, WipesItselfAtTheEndAndOnClear) {
  {
    ProgressLine line = make(ProgressStyle::redrawn);
    line.report(0.5, "x");
    taken();
    line.clear();
    EXPECT_EQ(taken(), "\r\x1b[K");
    line.clear();
    EXPECT_EQ(taken(), "");
    now += 1;
    line.report(0.6, "x");
    taken();
  }
  EXPECT_EQ(taken(), "\r\x1b[K");
}

TEST_F(ProgressLineTest, PlainLinesAtMostOneInTwoSeconds) {
  {
    ProgressLine line = make(ProgressStyle::plain);
    for (int i = 0; i < 19; ++i) {
      now += 0.1;
      line.report(i / 100.0, "early");
    }
    EXPECT_EQ(taken(), "");
    for (int i = 0; i < 100; ++i) {
      line.report(0.5, "half");
      now += 0.1;
    }
  }
  const std::string text = taken();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5) << text;
  EXPECT_EQ(text.find('\r'), std::string::npos);
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
  EXPECT_EQ(text.substr(0, text.find('\n')), "solve  half  50 %  0:02, about 0:02 left");
}

TEST_F(ProgressLineTest, SilentSaysNothing) {
  {
    ProgressLine line = make(ProgressStyle::silent);
    now += 10;
    line.report(0.5, "x");
  }
  EXPECT_EQ(taken(), "");
}

TEST_F(ProgressLineTest, UnknownFractionGivesNoEstimate) {
  ProgressLine line = make(ProgressStyle::redrawn);
  for (const double unknown : {-1.0, std::numeric_limits<double>::quiet_NaN(), 1.5}) {
    now += 5;
    line.report(unknown, "mapping");
    const std::string text = taken();
    EXPECT_EQ(text.find('%'), std::string::npos) << text;
    EXPECT_EQ(text.find("left"), std::string::npos) << text;
  }
}

TEST_F(ProgressLineTest, FitsTheTerminalWithoutBreakingACharacter) {
  ProgressLine line = make(ProgressStyle::redrawn, 12);
  line.report(-1, "\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9");
  EXPECT_EQ(taken(), "\r\x1b[Ksolve  \u00e9\u00e9\u00e9\u00e9");
}

TEST_F(ProgressLineTest, ControlCharactersStayOut) {
  ProgressLine line = make(ProgressStyle::redrawn);
  line.report(-1, "a\nb\x1b[2Jc");
  EXPECT_EQ(taken(), "\r\x1b[Ksolve  a b [2Jc  0:00");
}

TEST_F(ProgressLineTest, PhasesLeaveALineEachAndSharesOfTheirOwn) {
  {
    ProgressLine line = make(ProgressStyle::redrawn);
    line.expect({{"look", 10}, {"views", 30}, {"files", 1}});
    line.begin("look");
    line.report(0.5, "image 5 of 10");
    EXPECT_EQ(taken(), "\r\x1b[Ksolve  1/3 look  image 5 of 10, 50 %  0:00");
    now += 10;
    line.begin("views");
    EXPECT_EQ(taken(), "\r\x1b[Ksolve  1/3 look: 0:10\n");
    now += 15;
    line.report(0.5, "view 50 of 100");
    EXPECT_EQ(taken(),
              "\r\x1b[Ksolve  2/3 views  view 50 of 100, 50 %;  all 60 %  0:25, about 0:16 left");
    now += 15;
    line.begin("files");
    taken();
    now += 1;
    line.report(-1, "");
    EXPECT_EQ(taken(), "\r\x1b[Ksolve  3/3 files;  all 100 %  0:41");
  }
  EXPECT_EQ(taken(), "\r\x1b[K");
}

TEST_F(ProgressLineTest, PlainPhasesAreLinesWithoutEscapes) {
  ProgressLine line = make(ProgressStyle::plain);
  line.begin("look\x1b[2J");
  now += 1;
  line.begin("short");
  now += 3;
  line.begin("last");
  const std::string text = taken();
  EXPECT_EQ(text, "solve  short: 0:03\n");
}

TEST(ProgressStyleOfStderr, QuietIsSilent) {
  EXPECT_EQ(progress_style_of_stderr(true), ProgressStyle::silent);
}

}  // namespace
}  // namespace lapwing
