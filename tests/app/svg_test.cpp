// SPDX-License-Identifier: Apache-2.0
// What of an SVG picture is drawn, and that the rest is said: nothing is left out in silence.
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

class Svg : public CommandLine {
 protected:
  // First the ends of every stroke, one a line, then the notes; or the error.
  std::string read(const std::string& inside) {
    write("p.svg", "<svg xmlns='http://www.w3.org/2000/svg'" + root_ + ">\n" + inside + "\n</svg>");
    write("read.lua",
          "local strokes, notes = require('mission.svg').strokes(lapwing.read_text('p.svg'))\n"
          "local out = {''}\n"
          "for _, s in ipairs(strokes) do\n"
          "  out[#out + 1] = ('%.3g,%.3g to %.3g,%.3g'):format(s[1][1], s[1][2], s[#s][1], "
          "s[#s][2])\n"
          "end\n"
          "for _, n in ipairs(notes) do out[#out + 1] = n end\n"
          "lapwing.fail(table.concat(out, '\\n'))");
    const Finished finished = run({"run", "read.lua"});
    EXPECT_EQ(finished.status, 2);
    const std::size_t at = finished.err.find("read.lua:");
    return at == std::string::npos ? finished.err
                                   : finished.err.substr(finished.err.find(": ", at) + 2);
  }

  void gives(const std::string& inside, const std::string& result) {
    EXPECT_EQ(read(inside), "\n" + result + (result.empty() ? "" : "\n")) << inside;
  }
  std::string root_;  // attributes of the root

  void refuses(const std::string& inside, const std::string& fragment) {
    const std::string message = read(inside);
    EXPECT_NE(message.find(fragment), std::string::npos) << inside << "\ngave: " << message;
  }
};

TEST_F(Svg, WhatIsNotDrawnIsSaidWithItsLines) {
  gives(
      "<text>a</text>\n<path stroke='black' d='M0,0 L1,0'/><text>b</text>\n<image href='x'/><odd/>",
      "0,0 to 1,0\nlines 2, 3: <text> is not drawn: convert text to paths\n"
      "line 4: <image> is not drawn: trace it to paths\n"
      "line 4: <odd> is not drawn: only paths, basic shapes and their groups are");
  gives("<path d='M0,0 L1,0' stroke='red'/>\n<path d='M0,0 L2,0' style='stroke:#00F'/>",
        "0,0 to 1,0\n0,0 to 2,0\nline 2: the colour red is drawn in the colour of the light\n"
        "line 3: the colour #00F is drawn in the colour of the light");
  gives("<path d='M0,0 L1,0'/><path fill='none' d='M0,0 L2,0'/>",
        "0,0 to 1,0\nline 2: a filled shape without a line is drawn by its outline\n"
        "line 2: an invisible shape (neither line nor fill) is not drawn");
  gives(
      "<g stroke='black'><g style='display : none'><path d='M0,0 L1,0'/></g>\n"
      "<path opacity='0' d='M0,0 L1,0'/><path visibility='hidden' d='M0,0 L1,0'/></g>",
      "line 2: <g> is hidden and not drawn\nline 3: <path> is hidden and not drawn");
  gives(
      "<path stroke='black' d='M0,0 L1,0' clip-path='url(#c)' stroke-dasharray='3' "
      "marker-end='url(#m)'/>",
      "0,0 to 1,0\nline 2: clip-path is ignored: the parts that it hides are drawn\n"
      "line 2: marker-end is ignored: arrow heads are not drawn\n"
      "line 2: stroke-dasharray is ignored: lines are drawn without gaps");
}

TEST_F(Svg, ShapesOfNoSizeAreSaid) {
  gives("<circle r='0'/><rect width='3' height='0'/>", "line 2: a shape of size 0 is not drawn");
}

TEST_F(Svg, WhatLiesOutsideThePictureIsLeftOutOrCutOff) {
  const std::string inside =
      "<rect fill='none' stroke='black' x='10' y='10' width='80' height='80'/>\n"
      "<path stroke='black' d='M500 500 l9 0'/>\n<path stroke='black' d='M50,50 h100 v9 h-90'/>";
  const std::string cut = "line 4: the parts of <path> outside the picture are cut off";
  const std::string left_out = "line 3: <path> lies outside the picture and is not drawn\n";
  root_ = " viewBox='0 0 100 100'";
  gives(inside, "10,10 to 10,10\n50,50 to 100,50\n100,59 to 60,59\n" + left_out + cut);
  // A window wider than the viewBox shows more on both sides, or where the alignment puts it.
  root_ = " viewBox='0 0 100 100' width='400' height='200'";
  gives(inside, "10,10 to 10,10\n50,50 to 60,59\n" + left_out.substr(0, left_out.size() - 1));
  root_ += " preserveAspectRatio='xMaxYMid'";
  const std::string shifted = read(inside);
  EXPECT_NE(shifted.find("50,50 to 100,50"), std::string::npos) << shifted;
  root_ = " width='100mm' height='5cm'";
  EXPECT_NE(read(inside).find(left_out), std::string::npos);
  root_ = " overflow='visible' viewBox='0 0 100 100'";
  EXPECT_NE(read(inside).find("500,500 to 509,500"), std::string::npos);
  root_ = " width='100%' height='100%'";  // of a window that nobody knows
  EXPECT_NE(read(inside).find("500,500 to 509,500"), std::string::npos);
}

TEST_F(Svg, AtTheEdgeHalfOfALineIsEnough) {
  root_ = " viewBox='0 0 100 100'";
  gives("<rect fill='none' stroke='black' width='100' height='100'/>", "0,0 to 0,0");
  gives("<path stroke='black' stroke-width='4' d='M0,-1.5 H100'/>", "0,-1.5 to 100,-1.5");
  gives("<path stroke='black' stroke-width='1' d='M0,-1.5 H100'/>",
        "line 2: <path> lies outside the picture and is not drawn");
  gives(
      "<g transform='scale(10)'><path stroke='black' d='M0,5 L20,5 M-5,-5 L15,15'/></g>\n"
      "<defs><path id='p' stroke='black' d='M0,0 H1'/></defs>\n<use href='#p' x='-90'/>",
      "0,50 to 105,50\n-5,-5 to 105,105\n"
      "line 2: the parts of <path> outside the picture are cut off\n"
      "line 4: <path> lies outside the picture and is not drawn");
}

TEST_F(Svg, InvisibleColoursAreNotDrawn) {
  const std::string unseen = "line 2: an invisible shape (neither line nor fill) is not drawn";
  for (const char* clear : {"#00000000", "#0000", "#FFF0", "rgba(0,0,0,0)", "rgba(9, 9, 9, 0%)",
                            "rgb(0 0 0 / 0)", "hsla(9,9%,9%,0.0)", "Transparent", "NONE"}) {
    gives("<path fill='none' stroke='" + std::string(clear) + "' d='M0,0 L1,0'/>", unseen);
    gives("<rect fill='" + std::string(clear) + "' width='2' height='2'/>", unseen);
  }
  for (const char* seen : {"#0001", "#00000001", "#000000", "#100", "rgba(0,0,0,0.5)"})
    EXPECT_EQ(
        read("<path fill='none' stroke='" + std::string(seen) + "' d='M0,0 L1,0'/>").substr(0, 12),
        "\n0,0 to 1,0\n");
  gives("<path fill='none' stroke='currentColor' color='#0000' d='M0,0 L1,0'/>", unseen);
  gives("<g stroke-opacity='0' stroke='black'><path fill='none' d='M0,0 L1,0'/></g>", unseen);
  gives("<path fill='none' stroke='url(#missing)' d='M0,0 L1,0'/>",
        "line 2: url(#missing) names no gradient or pattern of this file\n" + unseen);
  gives("<path fill='none' stroke='url(#missing) #000' d='M0,0 L1,0'/>",
        "0,0 to 1,0\nline 2: url(#missing) names no gradient or pattern of this file\n"
        "line 2: the colour url(#missing)#000 is drawn in the colour of the light");
  gives("<linearGradient id='grad'/><path fill='none' stroke='url(#grad)' d='M0,0 L1,0'/>",
        "0,0 to 1,0\nline 2: the colour url(#grad) is drawn in the colour of the light");
}

TEST_F(Svg, NotesNameWhatAUserWouldChange) {
  gives(
      "<defs><path id='p' d='M0,0 L1,0'/></defs>\n\n<use href='#p' stroke='green'/>\n"
      "<use href='#p' visibility='hidden'/>",
      "0,0 to 1,0\nline 4: the colour green is drawn in the colour of the light\n"
      "line 5: <path> is hidden and not drawn");
  gives("<path visibility='hidden' d='M0,0 L1,0'/>", "line 2: <path> is hidden and not drawn");
  gives(
      "<path d=''/>\n<path d='M 5 5'/>\n<polyline points=''/>\n<polygon points='1,1'/>\n"
      "<path stroke='red' d='M5 5 l0 0'/>\n<line x1='3' x2='3'/>",
      "lines 2, 3, 4, 5, 6 and 1 more: a shape of size 0 is not drawn");
}

TEST_F(Svg, RulesForAScreenHoldAndOthersAreSaid) {
  gives(
      "<style>@import 'a.css'; @media screen { .a { display: none } }\n"
      "@media print { .b { display: none } } path { stroke: black }</style>\n"
      "<path class='a' d='M0,0 L1,0'/><path class='b' d='M0,0 L2,0'/>",
      "0,0 to 2,0\nline 2: the style rules of '@media print' are not read\n"
      "line 4: <path> is hidden and not drawn");
}

// Why nothing is left to draw is said with it.
TEST_F(Svg, ADrawingOfNothingGivesTheNotesAsItsReason) {
  write("p.svg",
        "<svg><style>@media screen { .a { display: none } }</style>\n"
        "<path class='a' d='M0,0 L10,0'/>\n<path d='M3,3 L3.0000001,3'/></svg>");
  write("paint.lua", "return require('mission.light_painting').picture { svg = 'p.svg' }");
  const Finished finished = run({"run", "paint.lua"});
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.err.find("the drawing has no line: p.svg, line 2: <path> is "
                              "hidden and not drawn"),
            std::string::npos)
      << finished.err;
}

TEST_F(Svg, StyleRulesAreRead) {
  gives(
      "<style><![CDATA[ /* .ink {stroke: red} */ .ink, line { stroke: #000; fill: none }\n"
      "#gone { display: none } g > path { stroke: blue } ]]></style>\n"
      "<path class='a ink' d='M0,0 L1,0'/><path id='gone' class='ink' d='M0,0 L2,0'/>"
      "<line x2='3'/>",
      "0,0 to 1,0\n0,0 to 3,0\nline 2: the style rule 'g > path' is not read\n"
      "line 4: <path> is hidden and not drawn");
}

TEST_F(Svg, UsesSymbolsAndNestedPicturesAreDrawnWhereTheyStand) {
  gives(
      "<defs><symbol id='s' viewBox='0 0 10 10'><path stroke='black' d='M0,0 L10,10'/></symbol>\n"
      "<path id='p' stroke='black' d='M0,0 L1,0'/></defs>\n"
      "<use href='#s' x='20' y='30' width='40' height='20'/>"
      "<use xlink:href='#p' x='5' transform='scale(2)'/>",
      "30,30 to 50,50\n10,0 to 12,0");
  gives(
      "<svg x='50' y='10' width='20' height='20' viewBox='0 0 40 40'>"
      "<g transform='translate(4,0)'><line stroke='black' x1='0' x2='40'/></g></svg>",
      "52,10 to 72,10");
  gives("<rect stroke='black' width='1in' height='10mm' rx='2'/>", "2,0 to 2,0");
  gives("<polygon stroke='black' points='0,0 3,0 3,&#52;'/>", "0,0 to 0,0");
}

TEST_F(Svg, WhatCannotBeReadIsRefusedWithItsLine) {
  refuses("\n<rect width='50%' height='3'/>", "line 3: <rect>: width is '50%': percentages");
  refuses("<circle r='-1'/>", "line 2: <circle>: its radius must not be below 0");
  refuses("<use href='#nothing'/>", "line 2: <use>: '#nothing' is not an element");
  refuses("<g id='a'>\n<use href='#a'/></g>", "line 3: <use>: it uses itself");
  refuses("<path d='M0,0 L x'/>", "line 2: <path>: path data: expected a number");
  refuses("<path style='transform: scale(2)' d='M0,0 L1,0'/>", "a transform in a style");
  refuses("<g>\n</h>", "line 3: </h> has no opening tag");
  refuses("<g>", "has no opening tag");
  refuses(
      std::string("<a>") +
          [] {
            std::string deep;
            for (int i = 0; i < 300; ++i) deep += "<g>";
            return deep;
          }(),
      "nested more than 60 deep");
}

TEST_F(Svg, TextsOfOtherCharactersAreRefusedWithAllOfThem) {
  write("paint.lua", "return require('mission.light_painting').text { text = 'A#b\\n#\\u{e9}' }");
  const Finished finished = run({"run", "paint.lua"});
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.err.find("no glyph for '#', U+000A, '\u00e9'; it has A to Z (lower case is "
                              "drawn as capitals), 0 to 9, blank and - . ! ?"),
            std::string::npos)
      << finished.err;
}

TEST_F(Svg, LowerCaseIsSaidToBePaintedAsCapitals) {
  write("paint.lua", "return require('mission.light_painting').text { text = 'l', height = 1 }");
  const Finished finished = run({"run", "paint.lua"});
  EXPECT_NE((finished.out + finished.err).find("lower case letters are drawn as capitals"),
            std::string::npos)
      << finished.out << finished.err;
}

// Notes stand in the report and in the answer to machines.
TEST_F(Svg, NotesAreOfTheRun) {
  write("p.svg", "<svg><text>hm</text>\n<path stroke='red' d='M0,0 L10,0 L10,10'/></svg>");
  write("paint.lua",
        "return require('mission.light_painting').picture { svg = 'p.svg', height = 1 }");
  const Finished finished = run({"run", "paint.lua"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  for (const char* note : {"p.svg, line 1: <text> is not drawn", "p.svg, line 2: the colour red"}) {
    EXPECT_NE((finished.out + finished.err).find(note), std::string::npos) << finished.out;
    std::string report = read_file(folder_ / "out/paint/report.html");
    EXPECT_NE(report.find(std::string(note).substr(0, 14)), std::string::npos);
  }
}

}  // namespace
}  // namespace lapwing
