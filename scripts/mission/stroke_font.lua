-- SPDX-License-Identifier: Apache-2.0
-- Letters as strokes: a font of our own, and Hershey's from .jhf files.
local M = {}

-- Capitals 6 high. Strokes are parted by '|'; "x,y" is a point, "@cx,cy,rx,ry,from,to" an arc of an
-- ellipse, in degrees. A glyph is as wide as it reaches.
local GLYPHS = {
  A = "0,0 2,6 4,0|0.7,2 3.3,2",
  B = "0,0 0,6 2.3,6 @2.3,4.6,1.4,1.4,90,-90 0,3.2|0,3.2 2.5,3.2 @2.5,1.6,1.6,1.6,90,-90 0,0",
  C = "@2.3,3,2.3,3,50,310",
  D = "0,0 0,6 1.6,6 @1.6,3,2.4,3,90,-90 0,0",
  E = "3.6,6 0,6 0,0 3.6,0|0,3.1 3,3.1",
  F = "3.6,6 0,6 0,0|0,3.1 2.8,3.1",
  G = "@2.3,3,2.3,3,50,360 2.6,3",
  H = "0,0 0,6|4,0 4,6|0,3.1 4,3.1",
  I = "0,0 0,6",
  J = "3,6 3,1.6 @1.5,1.6,1.5,1.6,0,-180",
  K = "0,0 0,6|3.8,6 0,2.4|1.2,3.55 4,0",
  L = "0,6 0,0 3.4,0",
  M = "0,0 0,6 2.5,2 5,6 5,0",
  N = "0,0 0,6 4,0 4,6",
  O = "@2.4,3,2.4,3,90,450",
  P = "0,0 0,6 2.4,6 @2.4,4.5,1.5,1.5,90,-90 0,3",
  Q = "@2.4,3,2.4,3,90,450|2.8,1.6 4.8,-0.4",
  R = "0,0 0,6 2.4,6 @2.4,4.5,1.5,1.5,90,-90 0,3|2,3 4,0",
  S = "@2,4.5,1.8,1.5,40,270 @2,1.5,2,1.5,90,-140",
  T = "0,6 4,6|2,6 2,0",
  U = "0,6 0,2 @2,2,2,2,180,360 4,6",
  V = "0,6 2,0 4,6",
  W = "0,6 1.4,0 2.8,5 4.2,0 5.6,6",
  X = "0,6 4,0|4,6 0,0",
  Y = "0,6 2,3 4,6|2,3 2,0",
  Z = "0,6 4,6 0,0 4,0",
  ["0"] = "@2.2,3,2.2,3,90,450",
  ["1"] = "0,4.6 1.6,6 1.6,0",
  ["2"] = "@2,4.2,1.9,1.8,160,-30 0,0 4,0",
  ["3"] = "@1.9,4.5,1.7,1.5,140,-90|@1.9,1.5,2,1.5,90,-140",
  ["4"] = "3,0 3,6 0,2 4,2",
  ["5"] = "3.6,6 0.7,6 0.4,3.2 @1.8,1.9,2,1.9,130,-140",
  ["6"] = "3.4,6 @2,2,2,2,150,510",
  ["7"] = "0,6 4,6 1.4,0",
  ["8"] = "@2,4.5,1.6,1.5,-90,270|@2,1.5,2,1.5,90,450",
  ["9"] = "0.8,0 @2,4,2,2,-30,330",
  ["-"] = "0.3,3 2.7,3",
  ["."] = "0,0 0.3,0",
  ["!"] = "0,6 0,1.8|0,0 0,0.4",
  ["?"] = "@1.6,4.5,1.6,1.5,160,-60 1.6,1.8|1.6,0 1.6,0.4",
}
local HEIGHT, GAP, SPACE = 6, 1.5, 2.5
local ARC_STEP = 6  -- degrees

local function arc(points, text, glyph)
  local n = {}
  for number in text:gmatch("[^,]+") do n[#n + 1] = tonumber(number) end
  if #n ~= 6 then error("glyph " .. glyph .. ": an arc needs six numbers") end
  local pieces = math.ceil(math.abs(n[6] - n[5]) / ARC_STEP)
  for i = 0, pieces do
    local angle = math.rad(n[5] + (n[6] - n[5]) * i / pieces)
    points[#points + 1] = { n[1] + n[3] * math.cos(angle), n[2] + n[4] * math.sin(angle) }
  end
end

local function own_glyph(character)
  local text = GLYPHS[character:upper()]
  if not text then return nil end
  local strokes = {}
  for part in text:gmatch("[^|]+") do
    local points = {}
    for token in part:gmatch("%S+") do
      if token:sub(1, 1) == "@" then
        arc(points, token:sub(2), character)
      else
        local x, y = token:match("^([^,]+),([^,]+)$")
        points[#points + 1] = { tonumber(x), tonumber(y) }
      end
    end
    strokes[#strokes + 1] = points
  end
  return strokes
end

-- A character as it can be read in a message: '#', or U+000A of one that has no picture.
local function shown(character)
  local code = utf8.codepoint(character)
  if code < 32 or code >= 127 and code < 160 then return ("U+%04X"):format(code) end
  return "'" .. character .. "'"
end

-- Places glyphs side by side; `glyph_of` gives {strokes, left, right}. Nothing, and the missing
-- characters as a text, where the font lacks any.
local function line_of(text, height, gap, space, glyph_of)
  local strokes, cursor, missing, named = {}, 0, {}, {}
  if not utf8.len(text) then return nil, "bytes that are not UTF-8" end
  for _, code in utf8.codes(text) do
    local character = utf8.char(code)
    local glyph = character ~= " " and glyph_of(character)
    if character == " " then
      cursor = cursor + space
    elseif glyph then
      for _, stroke in ipairs(glyph.strokes) do
        local placed = {}
        for i, p in ipairs(stroke) do
          placed[i] = { (p[1] - glyph.left + cursor) / height, p[2] / height }
        end
        strokes[#strokes + 1] = placed
      end
      cursor = cursor + glyph.right - glyph.left + gap
    elseif not named[character] then
      named[character] = true
      missing[#missing + 1] = shown(character)
    end
  end
  if #missing > 0 then return nil, table.concat(missing, ", ") end
  return strokes
end

-- What can be written, for messages.
M.CHARACTERS = "A to Z (lower case is drawn as capitals), 0 to 9, blank and - . ! ?"

-- Strokes of a text, its capitals 1 high, on a line that begins at 0, 0. Nothing and the characters
-- that have no glyph, as a text, where there are any.
function M.strokes(text)
  return line_of(text, HEIGHT, GAP, SPACE, function(character)
    local strokes = own_glyph(character)
    if not strokes then return nil end
    local left, right = math.huge, -math.huge
    for _, stroke in ipairs(strokes) do
      for _, p in ipairs(stroke) do
        left, right = math.min(left, p[1]), math.max(right, p[1])
      end
    end
    return { strokes = strokes, left = left, right = right }
  end)
end

-- Glyphs of a .jhf text, in the order of their ASCII codes from 32: {strokes, left, right}, y up.
local function hershey_glyphs(text)
  local glyphs, line = {}, ""
  for part in text:gmatch("[^\r\n]*") do
    line = line .. part
    local count = tonumber(line:sub(6, 8))
    if count and #line >= 8 + 2 * count then
      local function at(k) return line:byte(9 + 2 * k) - 82, line:byte(10 + 2 * k) - 82 end
      local left, right = at(0)
      local glyph = { strokes = {}, left = left, right = right }
      local points = {}
      for k = 1, count - 1 do
        if line:sub(9 + 2 * k, 10 + 2 * k) == " R" then
          points = {}
        else
          local x, y = at(k)
          points[#points + 1] = { x, 9 - y }  -- capitals stand from y = 9 up to -12
          if #points == 2 then glyph.strokes[#glyph.strokes + 1] = points end
        end
      end
      glyphs[#glyphs + 1] = glyph
      line = ""
    end
  end
  return glyphs
end

-- The same in a Hershey font, given as the text of its file.
function M.hershey_strokes(text, font)
  local glyphs = hershey_glyphs(font)
  return line_of(text, 21, 0, 16, function(character)
    local code = utf8.codepoint(character)
    local glyph = glyphs[code - 31]
    return glyph and #glyph.strokes > 0 and glyph or nil
  end)
end

return M
