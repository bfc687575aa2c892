-- SPDX-License-Identifier: Apache-2.0
-- Letters as strokes: sizes, spacing, what cannot be written, and Hershey fonts from their text.
local check = require "check"
local font = require "mission.stroke_font"

local T = {}

local ALL = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-.!?"

local function extent(strokes)
  local left, low, right, high = math.huge, math.huge, -math.huge, -math.huge
  for _, stroke in ipairs(strokes) do
    for _, p in ipairs(stroke) do
      left, right = math.min(left, p[1]), math.max(right, p[1])
      low, high = math.min(low, p[2]), math.max(high, p[2])
    end
  end
  return left, low, right, high
end

function T.known_letters()
  check.near(font.strokes("L"), { { { 0, 1 }, { 0, 0 }, { 3.4 / 6, 0 } } }, 1e-12)
  check.near(font.strokes("t"), { { { 0, 1 }, { 4 / 6, 1 } }, { { 2 / 6, 1 }, { 2 / 6, 0 } } },
             1e-12)
  check.near(font.strokes("-"), { { { 0, 0.5 }, { 2.4 / 6, 0.5 } } }, 1e-12, "begins at 0")
end

function T.every_character_that_is_promised_is_there()
  for character in ALL:gmatch(".") do
    local strokes = font.strokes(character)
    check.yes(strokes and #strokes > 0, character)
    local left, low, right, high = extent(strokes)
    check.near(left, 0, 1e-12, character .. " begins at 0")
    check.yes(right < 1, character .. " is narrower than high")
    if character:match("%w") then
      check.yes(low > -0.1 and low < 0.01, character .. " stands on its line")
      check.near(high, 1, 0.01, character .. " is 1 high")
    end
    for _, stroke in ipairs(strokes) do
      check.yes(#stroke >= 2, character .. " has a point alone")
    end
  end
end

-- Arcs are drawn in pieces so short that a letter looks round, and join what is beside them.
function T.strokes_have_no_jumps()
  for character in ("BCDGJOPQRSU0235689?"):gmatch(".") do
    for _, stroke in ipairs(font.strokes(character)) do
      local sharp = 0
      for i = 2, #stroke do
        local step = math.sqrt((stroke[i][1] - stroke[i - 1][1]) ^ 2
                               + (stroke[i][2] - stroke[i - 1][2]) ^ 2)
        if step > 0.08 then sharp = sharp + 1 end
      end
      check.yes(sharp <= 3, character .. " has few straight pieces, got " .. sharp)
    end
  end
  local o = font.strokes("O")[1]
  check.near(o[1], o[#o], 1e-12, "an O is closed")
end

function T.lower_case_is_written_as_capitals()
  for letter in ("abcdefghijklmnopqrstuvwxyz"):gmatch(".") do
    check.equal(font.strokes(letter), font.strokes(letter:upper()), letter)
  end
end

function T.letters_stand_beside_each_other()
  local two = font.strokes("LL")
  check.near(two[2][1], { (3.4 + 1.5) / 6, 1 }, 1e-12, "a gap between")
  check.near(font.strokes("L L")[2][1], { (3.4 + 1.5 + 2.5) / 6, 1 }, 1e-12, "a blank")
  check.near(font.strokes("  L")[1][1], { 5 / 6, 1 }, 1e-12)
  local text = ("HELLO WORLD 42"):rep(3)
  local end_of_last = -1
  for character, at in text:gmatch("(%S)()") do
    local before, with = font.strokes(text:sub(1, at - 2)), font.strokes(text:sub(1, at - 1))
    local placed = table.move(with, #before + 1, #with, 1, {})
    local left, _, right = extent(placed)
    check.yes(left > end_of_last, character .. " stands behind the one before")
    end_of_last = right
  end
  check.equal(font.strokes(""), {})
  check.equal(font.strokes("   "), {})
end

function T.what_has_no_glyph_is_named_once()
  local function missing(text)
    local strokes, what = font.strokes(text)
    check.equal(strokes, nil, text)
    return what
  end
  check.equal(missing("a#b#c"), "'#'")
  check.equal(missing("\u{e9}#\n\t"), "'\u{e9}', '#', U+000A, U+0009")
  check.equal(missing("\u{85}"), "U+0085")
  check.equal(missing("A\xff"), "bytes that are not UTF-8")
  check.equal(missing("\u{1F600}"), "'\u{1F600}'")
end

-- A glyph of a .jhf file: a number of 5 digits, one of 3 and pairs of letters, R being 0.
local function glyph(pairs_of)
  local text = {}
  for i, pair in ipairs(pairs_of) do
    text[i] = pair == "up" and " R" or string.char(82 + pair[1], 82 + pair[2])
  end
  return ("%5d%3d%s"):format(1, #pairs_of, table.concat(text))
end

local BLANK = glyph { { -8, 8 } }
-- '!' and '"', the first behind the blank: y goes down from 9, the line, to -12, the top.
local BANG = glyph { { -5, 5 }, { 0, -12 }, { 0, 2 }, "up", { 0, 8 }, { 0, 9 } }
local QUOTE = glyph { { -4, 6 }, { -4, -12 }, { 6, 9 } }

function T.hershey_glyphs_are_read()
  local text = table.concat({ BLANK, BANG, QUOTE, "" }, "\n")
  check.near(font.hershey_strokes("!", text),
             { { { 5 / 21, 1 }, { 5 / 21, 7 / 21 } }, { { 5 / 21, 1 / 21 }, { 5 / 21, 0 } } },
                 1e-12)
  -- The next begins where the reach of the one before ends.
  check.near(font.hershey_strokes("!\"", text)[3], { { 10 / 21, 1 }, { 20 / 21, 0 } }, 1e-12)
  check.near(font.hershey_strokes("! !", text)[3][1], { (10 + 16 + 5) / 21, 1 }, 1e-12)
end

function T.hershey_lines_may_be_broken_anywhere()
  local whole = table.concat({ BLANK, BANG, QUOTE }, "\n")
  local wanted = font.hershey_strokes("!\"", whole)
  for _, at in ipairs { 9, 12, 15 } do
    local broken = table.concat({ BLANK, BANG:sub(1, at) .. "\n" .. BANG:sub(at + 1), QUOTE },
                                "\r\n")
    check.equal(font.hershey_strokes("!\"", broken), wanted, "broken after " .. at)
  end
end

function T.a_hershey_font_lacks_what_it_lacks()
  local text = table.concat({ BLANK, BANG }, "\n")
  local strokes, what = font.hershey_strokes("!\"", text)
  check.equal(strokes, nil)
  check.equal(what, "'\"'")
  strokes, what = font.hershey_strokes("A", "")
  check.equal({ strokes or "none", what }, { "none", "'A'" })
  strokes, what = font.hershey_strokes("!", BLANK .. "\n" .. BANG:sub(1, -2))
  check.equal({ strokes or "none", what }, { "none", "'!'" }, "cut short")
end

return check.all(T)
