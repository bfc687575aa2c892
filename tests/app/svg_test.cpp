// What of an SVG picture is drawn, and that the rest is said: nothing is left out in silence.
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

class Svg : public CommandLine {
 protected:
  // First the ends of every stroke, one a line, then the notes; or the error.
  std::string read(const std::string& inside) {
    write("p.svg", "<svg xmlns='http://www.w3.org/2000/svg'>\n" + inside + "\n</svg>");
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
        "0,0 to 1,0\n0,0 to 2,0\nline 2: the colour red is not flown: the light has one colour\n"
        "line 3: the colour #00F is not flown: the light has one colour");
  gives("<path d='M0,0 L1,0'/><path fill='none' d='M0,0 L2,0'/>",
        "0,0 to 1,0\nline 2: a filled shape without a line is drawn by its outline\n"
        "line 2: a shape that is not seen (neither line nor face) is not drawn");
  gives(
      "<g stroke='black'><g style='display : none'><path d='M0,0 L1,0'/></g>\n"
      "<path opacity='0' d='M0,0 L1,0'/><path visibility='hidden' d='M0,0 L1,0'/></g>",
      "line 2: <g> is hidden and not drawn\nline 3: <path> is hidden and not drawn\n"
      "line 3: a shape that is not seen (neither line nor face) is not drawn");
  gives(
      "<path stroke='black' d='M0,0 L1,0' clip-path='url(#c)' stroke-dasharray='3' "
      "marker-end='url(#m)'/>",
      "0,0 to 1,0\nline 2: clip-path is not honoured: what it cuts off is drawn\n"
      "line 2: marker-end is not honoured: arrow heads are not drawn\n"
      "line 2: stroke-dasharray is not honoured: lines are drawn without gaps");
}

TEST_F(Svg, ShapesOfNoSizeAreSaid) {
  gives("<circle r='0'/><rect width='3' height='0'/>", "line 2: a shape of no size is not drawn");
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
  refuses("\n<rect width='50%' height='3'/>", "line 3: <rect>: width is '50%': shares of");
  refuses("<circle r='-1'/>", "line 2: <circle>: its radius must not be below 0");
  refuses("<use href='#nothing'/>", "line 2: <use>: '#nothing' names no element");
  refuses("<g id='a'>\n<use href='#a'/></g>", "line 3: <use>: it uses itself");
  refuses("<path d='M0,0 L x'/>", "line 2: <path>: path data: expected a number");
  refuses("<path style='transform: scale(2)' d='M0,0 L1,0'/>", "a transform in a style");
  refuses("<g>\n</h>", "line 3: </h> closes nothing that is open");
  refuses("<g>", "closes nothing that is open");
  refuses(
      std::string("<a>") +
          [] {
            std::string deep;
            for (int i = 0; i < 300; ++i) deep += "<g>";
            return deep;
          }(),
      "nested more than 60 deep");
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
