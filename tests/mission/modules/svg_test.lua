-- SPDX-License-Identifier: Apache-2.0
-- Whole pictures: what is drawn of them and where, and what is said of what is not.
local check = require "check"
local svg = require "mission.svg"

local T = {}

local LINE = "<path stroke='black' d='M0,0 L3,4'/>"

-- Ends of all strokes, and the notes.
local function drawn(text)
  local strokes, notes = svg.strokes(text)
  local ends = {}
  for i, stroke in ipairs(strokes) do
    local first, last = stroke[1], stroke[#stroke]
    ends[i] = { first[1], first[2], last[1], last[2] }
  end
  return ends, notes
end

local function draws(text, wanted, said)
  local ends, notes = drawn(text)
  check.near(ends, wanted, 1e-9, text)
  check.equal(notes, said or {}, text)
end

function T.groups_move_what_is_in_them()
  draws("<svg><g transform='translate(10,0)'><g transform='scale(2)'>" .. LINE .. "</g></g></svg>",
        { { 10, 0, 16, 8 } })
  draws("<svg><a>" .. LINE .. "</a><switch>" .. LINE .. "</switch></svg>",
        { { 0, 0, 3, 4 }, { 0, 0, 3, 4 } })
  draws("<svg>" .. LINE:gsub("/>", " transform='rotate(90)'/>") .. "</svg>", { { 0, 0, -4, 3 } })
end

function T.definitions_are_drawn_where_they_are_used()
  local defs = "<svg><defs><g id='a' transform='scale(2)'>" .. LINE .. "</g></defs>"
  draws(defs .. "</svg>", {})
  draws(defs .. "<use href='#a' x='10' y='1'/></svg>", { { 10, 1, 16, 9 } })
  draws(defs .. "<use xlink:href='#a'/><use href='#a' transform='translate(0,5)' x='1'/></svg>",
        { { 0, 0, 6, 8 }, { 1, 5, 7, 13 } })
  -- A use of a use, and a symbol that is fitted into its size.
  draws(defs .. "<g id='b'><use href='#a' x='1'/></g><use href='#b' x='10'/></svg>",
        { { 1, 0, 7, 8 }, { 11, 0, 17, 8 } })
  draws("<svg><symbol id='s' viewBox='0 0 10 10'>" .. LINE .. "</symbol>"
        .. "<use href='#s' width='20' height='20' x='100'/></svg>", { { 100, 0, 106, 8 } })
end

function T.uses_that_end_nowhere_are_refused()
  check.fails("line 1: <use>: '#b' is not an element", svg.strokes, "<svg><use href='#b'/></svg>")
  check.fails("line 2: <use>: '' is not an element", svg.strokes, "<svg>\n<use/></svg>")
  check.fails("it uses itself", svg.strokes, "<svg><g id='a'>\n<use href='#a'/></g></svg>")
  check.fails("it uses itself", svg.strokes,
              "<svg><g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g></svg>")
  -- Ten uses of ten uses and so on: 10^5 elements of a small file.
  local bomb = { "<svg><defs><g id='l0'/>" }
  for level = 1, 5 do
    bomb[#bomb + 1] = ("<g id='l%d'>%s</g>"):format(level, ("<use href='#l%d'/>"):format(level - 1)
                                                           :rep(10))
  end
  check.fails("more than 10000 uses", svg.strokes,
              table.concat(bomb) .. "</defs><use href='#l5'/></svg>")
end

function T.what_is_outside_the_picture_is_cut_off_and_said()
  local function picture(d)
    return ("<svg viewBox='0 0 10 10'><path stroke='black' stroke-width='0.01' d='%s'/></svg>")
           :format(d)
  end
  draws(picture "M1,1 L9,9", { { 1, 1, 9, 9 } })
  draws(picture "M5,5 L15,5", { { 5, 5, 10.005, 5 } },
        { "line 1: the parts of <path> outside the picture are cut off" })
  draws(picture "M11,5 L15,5", {}, { "line 1: <path> lies outside the picture and is not drawn" })
  -- Half of a wide line still shows where its middle is outside.
  draws("<svg viewBox='0 0 10 10'>"
        .. "<path stroke='black' stroke-width='2' d='M1,10.9 L9,10.9'/></svg>",
        { { 1, 10.9, 9, 10.9 } })
  -- The line is as wide as the picture shows it: here 1 on each side, drawn at half the size.
  draws("<svg viewBox='0 0 10 10'><g transform='scale(.5 .5)'>"
        .. "<path stroke='black' stroke-width='4' d='M2,21.8 L18,21.8'/></g></svg>",
        { { 1, 10.9, 9, 10.9 } })
  draws("<svg viewBox='0 0 10 10'><g transform='scale(.5 .5)'>"
        .. "<path stroke='black' stroke-width='4' d='M2,22.2 L18,22.2'/></g></svg>",
        {}, { "line 1: <path> lies outside the picture and is not drawn" })
  draws("<svg viewBox='100 0 1 1'><path fill='red' d='M101.1,0 L101.1,1'/></svg>", {},
        { "line 1: <path> lies outside the picture and is not drawn" })
  -- A picture that says that nothing is hidden, and one without a frame.
  draws("<svg viewBox='0 0 1 1' overflow='visible'>" .. LINE .. "</svg>", { { 0, 0, 3, 4 } })
  draws("<svg>" .. LINE .. "</svg>", { { 0, 0, 3, 4 } })
end

function T.pictures_within_pictures()
  draws("<svg viewBox='0 0 100 100'><svg x='10' y='20' width='20' height='20' viewBox='0 0 10 10'>"
        .. LINE .. "</svg></svg>", { { 10, 20, 16, 28 } })
end

function T.a_shape_of_no_length_is_none()
  for data, long in pairs { ["M1,1 L1,1"] = false, ["M1,1 L1,1 1,1 M3,3 L3,3"] = false,
                            ["M1,1 L1,2"] = true, ["M1,1 L2,1"] = true, ["M1,1 L2,2 1,1"] = true,
                            ["M1,2 L1,2 M3,3 L3,4"] = true } do
    local strokes = svg.strokes("<svg><path stroke='black' d='" .. data .. "'/></svg>")
    check.equal(#strokes > 0, long, data)
  end
end

function T.what_describes_a_picture_is_not_drawn()
  for _, name in ipairs { "defs", "symbol", "clipPath", "mask", "marker", "pattern", "title",
                          "desc",
                          "linearGradient", "radialGradient", "filter", "style", "metadata",
                          "script", "view", "cursor", "font", "sodipodi:namedview" } do
    draws("<svg><" .. name .. ">" .. LINE .. "</" .. name .. "></svg>", {})
  end
end

-- The colour that is named is that of the use where the use gives it.
function T.colours_are_said_where_they_are_given()
  draws("<svg><defs><path id='a' d='M0,0 L3,4'/></defs>\n<use href='#a' stroke='red'/></svg>",
        { { 0, 0, 3, 4 } }, { "line 2: the colour red is drawn in the colour of the light" })
end

function T.notes_name_lines_and_reasons()
  draws("<svg>\n<text>A</text>\n<image/>\n<blink/></svg>", {},
        { "line 2: <text> is not drawn: convert text to paths",
          "line 3: <image> is not drawn: trace it to paths",
          "line 4: <blink> is not drawn: only paths, basic shapes and their groups are" })
  draws("<svg>\n<g display='none'>" .. LINE .. "</g></svg>", {},
        { "line 2: <g> is hidden and not drawn" })
  draws("<svg><path d='M0,0 L1,1' fill='none'/></svg>", {},
        { "line 1: an invisible shape (neither line nor fill) is not drawn" })
  draws("<svg><path d='M0,0 L1,1'/></svg>", { { 0, 0, 1, 1 } },
        { "line 1: a filled shape without a line is drawn by its outline" })
  draws("<svg><path stroke='red' d='M0,0 L1,1'/></svg>", { { 0, 0, 1, 1 } },
        { "line 1: the colour red is drawn in the colour of the light" })
  draws("<svg><path stroke='black' d='M1,1'/><rect stroke='black' width='3'/></svg>", {},
        { "line 1: a shape of size 0 is not drawn" })
  draws("<svg>" .. LINE:gsub("/>", " clip-path='url(#c)'/>") .. "</svg>", { { 0, 0, 3, 4 } },
        { "line 1: clip-path is ignored: the parts that it hides are drawn" })
  draws("<svg><g stroke-dasharray='1 2'>" .. LINE .. "</g></svg>", { { 0, 0, 3, 4 } },
        { "line 1: stroke-dasharray is ignored: lines are drawn without gaps" })
  draws("<svg xmlns:i='x'><i:view/><title>t</title>" .. LINE .. "</svg>", { { 0, 0, 3, 4 } })
end

-- One note for all lines that it holds for; the first five of them are named.
function T.notes_are_gathered()
  local text = "<svg>"
  for _ = 1, 8 do text = text .. "\n<text/><text/>" end
  draws(text .. "</svg>", {},
        { "lines 2, 3, 4, 5, 6 and 3 more: <text> is not drawn: convert text to paths" })
end

function T.errors_name_line_and_element()
  check.fails("line 3: <path>: path data: expected a number", svg.strokes,
              "<svg>\n<g>\n<path stroke='black' d='M0,0 L1,x'/></g></svg>")
  check.fails("line 1: <rect>: width is '5%'", svg.strokes,
              "<svg><rect width='5%' height='1'/></svg>")
  check.fails("line 2: <g>: unknown transform 'turn'", svg.strokes,
              "<svg>\n<g transform='turn(3)'/></svg>")
  check.fails("line 1: <path>: a transform in a style is not read", svg.strokes,
              "<svg><path style='transform:rotate(3deg)' d='M0,0 L1,1'/></svg>")
  check.fails("line 2: <svg> is not closed", svg.strokes, "\n<svg>")
end

-- What the strokes are of does not matter: two files that say the same give the same.
function T.shapes_and_paths_agree()
  local function strokes(shape) return (svg.strokes("<svg stroke='black'>" .. shape
                                                    .. "</svg>")) end
  check.near(strokes "<rect x='1' y='2' width='3' height='4'/>",
             strokes "<path d='M1,2 h3 v4 h-3 z'/>", 1e-12)
  check.near(strokes "<polygon points='0,0 5,0 5,5'/>", strokes "<path d='M0,0 5,0 5,5z'/>", 1e-12)
  check.near(strokes "<line x1='1' y1='2' x2='1in' y2='4'/>", strokes "<path d='M1,2 L96,4'/>",
             1e-12)
  check.near(strokes "<circle cx='5' cy='5' r='2'/>",
             strokes "<ellipse cx='5' cy='5' rx='2' ry='2'/>",
             1e-12)
end

return check.all(T)
