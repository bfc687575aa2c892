-- SPDX-License-Identifier: Apache-2.0
-- An SVG picture as strokes: lists of {x, y}, y down as in the file, curves as short straight
-- pieces. A note lists everything that cannot be drawn or is not read.
local frames = require "mission.svg_frame"
local path = require "mission.svg_path"
local shapes = require "mission.svg_shapes"
local styles = require "mission.svg_style"
local tree = require "mission.svg_tree"

local M = {}

local LISTED = 5        -- lines named of each note
local MOST_USES = 10000 -- of <use>, one within another: they multiply

local GROUPS = { g = true, a = true, switch = true }
-- Not drawn where they stand, by the rules of SVG.
local DEFINITIONS = { defs = true, symbol = true, clipPath = true, mask = true, marker = true,
                      pattern = true, linearGradient = true, radialGradient = true, filter = true,
                      style = true, title = true, desc = true, metadata = true, script = true,
                      view = true, cursor = true, font = true }
local CURES = { text = "convert text to paths", image = "trace it to paths",
                foreignObject = "convert it to paths" }
-- Attributes that change a picture and are not honoured.
local UNREAD = { ["clip-path"] = "the parts that it hides are drawn",
                 mask = "the parts that it hides are drawn",
                 filter = "shapes are drawn without it",
                 ["stroke-dasharray"] = "lines are drawn without gaps",
                 ["transform-origin"] = "transforms turn about 0, 0",
                 ["marker-start"] = "arrow heads are not drawn",
                 ["marker-mid"] = "arrow heads are not drawn",
                 ["marker-end"] = "arrow heads are not drawn" }

-- Notes in the order of their first line: the text, and the lines to which it applies.
local function note_book()
  local book, order = {}, {}
  local function note(line, what)
    if not book[what] then
      book[what] = {}
      order[#order + 1] = what
    end
    local lines = book[what]
    if lines[#lines] ~= line then lines[#lines + 1] = line end
  end
  local function listed()
    local all = {}
    for i, what in ipairs(order) do
      local lines = book[what]
      local shown = table.concat(lines, ", ", 1, math.min(#lines, LISTED))
      if #lines > LISTED then shown = shown .. (" and %d more"):format(#lines - LISTED) end
      all[i] = ("line%s %s: %s"):format(#lines > 1 and "s" or "", shown, what)
    end
    return all
  end
  return note, listed
end

local function identified(root)
  local named = {}
  local function visit(element)
    local id = element.attributes.id
    if id and not named[id] then named[id] = element end
    for _, child in ipairs(element.children) do visit(child) end
  end
  visit(root)
  return named
end

local function drawing(root)
  local note, notes = note_book()
  local D = { strokes = {}, notes = notes, note = note, rules = styles.rules(root, note),
              named = identified(root), uses = 0, open = {} }

  -- Strokes of a shape in the picture's units; none where it has no length.
  local function strokes_of(element, matrix)
    local data = shapes.data[element.name](element.attributes)
    local strokes, long = data and path.strokes(data) or {}, false
    for _, stroke in ipairs(strokes) do
      for i, p in ipairs(stroke) do
        long = long or i > 1 and (p[1] ~= stroke[1][1] or p[2] ~= stroke[1][2])
      end
    end
    if not long then return {} end
    for _, stroke in ipairs(strokes) do
      for i, p in ipairs(stroke) do
        stroke[i] = { matrix[1] * p[1] + matrix[3] * p[2] + matrix[5],
                      matrix[2] * p[1] + matrix[4] * p[2] + matrix[6] }
      end
    end
    return strokes
  end

  -- The parts of the strokes inside the picture, up to half of the line width outside of its edge.
  local function within_frame(strokes, element, style, matrix, seen)
    if not D.frame then return strokes end
    local scale = math.sqrt(math.abs(matrix[1] * matrix[4] - matrix[2] * matrix[3]))
    local margin = 1e-6 * (D.frame[3] - D.frame[1])
    if margin == math.huge then margin = 1e-6 end
    if seen == "stroke" then margin = math.max(margin, styles.line_width(style) * scale / 2) end
    local kept, cut = frames.cut(strokes, D.frame, margin)
    local what = #kept == 0 and "<%s> lies outside the picture and is not drawn"
                 or "the parts of <%s> outside the picture are cut off"
    if cut then note(D.use_line or element.line, what:format(element.name)) end
    return kept
  end

  local function how_seen(element, style)
    if styles.invisible(style) then
      note(not element.attributes.visibility and D.use_line or element.line,
           ("<%s> is hidden and not drawn"):format(element.name))
      return nil
    end
    local seen = styles.seen_by(style, D.named, function(reference)
      note(style.stroke_from or element.line,
           ("url(%s) names no gradient or pattern of this file"):format(reference))
    end)
    if not seen then
      note(element.line, "an invisible shape (neither line nor fill) is not drawn")
    end
    return seen
  end

  function D.shape(element, style, matrix)
    local seen = how_seen(element, style)
    if not seen then return end
    local strokes = strokes_of(element, matrix)
    if #strokes == 0 then return note(element.line, "a shape of size 0 is not drawn") end
    strokes = within_frame(strokes, element, style, matrix, seen)
    if #strokes == 0 then return end
    if seen == "fill" then
      note(element.line, "a filled shape without a line is drawn by its outline")
    end
    local colour = seen == "stroke" and styles.colour(style)
    if colour then
      note(style.stroke_from or element.line,
           ("the colour %s is drawn in the colour of the light"):format(colour))
    end
    if style["stroke-dasharray"] and style["stroke-dasharray"] ~= "none" then
      note(element.line, "stroke-dasharray is ignored: " .. UNREAD["stroke-dasharray"])
    end
    table.move(strokes, 1, #strokes, #D.strokes + 1, D.strokes)
  end

  function D.children(element, style, matrix)
    for _, child in ipairs(element.children) do D.element(child, style, matrix) end
  end

  function D.use(element, style, matrix)
    local a = element.attributes
    local reference = a.href or a["xlink:href"] or ""
    local target = D.named[reference:match("^#(.+)$") or ""]
    if not target then error(("'%s' is not an element of this file"):format(reference), 0) end
    D.uses = D.uses + 1
    if D.open[target] or D.uses > MOST_USES then
      error(D.open[target] and "it uses itself" or "more than 10000 uses of elements", 0)
    end
    D.open[target] = true
    local outer_line = D.use_line
    D.use_line = outer_line or element.line
    style.stroke_from = style.stroke_from or element.line
    matrix = shapes.times(matrix, shapes.viewport({ x = a.x, y = a.y }))
    if target.name == "symbol" or target.name == "svg" then
      local own = styles.of(target, style, D.rules)
      local inner = target.attributes
      D.children(target, own, shapes.times(matrix, shapes.viewport(
        { viewBox = inner.viewBox }, { width = a.width or inner.width,
                                       height = a.height or inner.height })))
    else
      D.element(target, style, matrix)
    end
    D.open[target], D.use_line = nil, outer_line
  end

  local function drawn(element, parent, matrix)
    local name, a = element.name, element.attributes
    if DEFINITIONS[name] or name:find(":", 1, true) then return end
    local style = styles.of(element, parent, D.rules)
    if styles.hidden(style) then
      return note(element.line, ("<%s> is hidden and not drawn"):format(name))
    end
    for key, effect in pairs(UNREAD) do
      if style[key] and style[key] ~= "none" and key ~= "stroke-dasharray" then
        note(element.line, key .. " is ignored: " .. effect)
      end
    end
    if style.transform and style.transform ~= a.transform then
      error("a transform in a style is not read; write it as an attribute", 0)
    end
    matrix = shapes.times(matrix, shapes.transform(a.transform))
    if shapes.data[name] then return D.shape(element, style, matrix) end
    if name == "use" then return D.use(element, style, matrix) end
    if name == "svg" then
      if (a.preserveAspectRatio or "xMidYMid"):gsub("^%s*defer%s+", ""):sub(1, 8) ~= "xMidYMid" then
        note(element.line, "preserveAspectRatio is ignored: the picture is fitted in")
      end
      local inner = parent.inner and a or { viewBox = nil }
      if not parent.inner then D.frame = style.overflow ~= "visible" and shapes.frame(a) or nil end
      style.inner = true
      return D.children(element, style, shapes.times(matrix, shapes.viewport(inner, a)))
    end
    if GROUPS[name] then
      style.inner = parent.inner
      return D.children(element, style, matrix)
    end
    note(element.line, ("<%s> is not drawn: %s"):format(
      name, CURES[name] or "only paths, basic shapes and their groups are"))
  end

  function D.element(element, parent, matrix)
    local good, problem = pcall(drawn, element, parent, matrix)
    if good then return end
    problem = tostring(problem)
    if not problem:match("^line %d+: ") then
      problem = ("line %d: <%s>: %s"):format(element.line, element.name,
                                             (problem:gsub("^[^ ]*%.lua:%d+: ", "")))
    end
    error(problem, 0)
  end
  return D
end

-- Strokes of a whole picture, and notes of what is not in them. Errors name line and element.
function M.strokes(text)
  local root = tree.read(text)
  local D = drawing(root)
  D.children(root, {}, shapes.IDENTITY)
  return D.strokes, D.notes()
end

return M
