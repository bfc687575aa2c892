-- SPDX-License-Identifier: Apache-2.0
-- Styles of a picture: where they come from, what they outweigh, and whether a shape is seen.
local check = require "check"
local styles = require "mission.svg_style"
local tree = require "mission.svg_tree"

local T = {}

-- The styles of the first element named `p` within others, and what was said of rules.
local function of(text)
  local root, notes = tree.read(text), {}
  local rules = styles.rules(root, function(line, what) notes[#notes + 1] = line .. ": "
                             .. what end)
  local found
  local function visit(element, parent)
    local own = styles.of(element, parent, rules)
    if element.name == "p" then found = found or own end
    for _, child in ipairs(element.children) do visit(child, own) end
  end
  visit(root, {})
  return found, notes
end

local function stroke(text) return of(text).stroke end

function T.an_id_outweighs_a_class_and_a_class_a_tag()
  local sheet = "<svg><style>#i{stroke:id} .c{stroke:class} p{stroke:tag} *{stroke:any}</style>"
  check.equal(stroke(sheet .. "<p id='i' class='c' stroke='own'/></svg>"), "id")
  check.equal(stroke(sheet .. "<p class='b c' stroke='own'/></svg>"), "class")
  check.equal(stroke("<svg><style>p{stroke:tag}</style><p stroke='own'/></svg>"), "tag")
  check.equal(stroke("<svg><p stroke='own'/></svg>"), "own")
  check.equal(stroke(sheet .. "<p id='i' style='stroke:inline'/></svg>"), "inline")
  check.equal(stroke("<svg><style>p{stroke:a} p{stroke:b}</style><p/></svg>"), "b", "the later one")
  check.equal(stroke("<svg><style>.c{stroke:a}</style><p class='cc'/></svg>"), nil)
  check.equal(stroke("<svg><style>q,\n p , r{stroke:a}</style><p/></svg>"), "a")
end

function T.some_are_inherited()
  for _, name in ipairs { "stroke", "fill", "visibility", "color", "stroke-width",
                          "stroke-dasharray", "stroke-opacity", "fill-opacity" } do
    local text = "<svg><g " .. name .. "='outer'><g><p/></g></g></svg>"
    check.equal(of(text)[name], "outer", name)
    check.equal(of(text:gsub("<p/>", "<p " .. name .. "='own'/>"))[name], "own", name)
    check.equal(of(text:gsub("<p/>", "<p style='" .. name .. ": inherit'/>"))[name], "outer", name)
  end
  for _, name in ipairs { "opacity", "display", "id", "transform", "class" } do
    check.equal(of("<svg><g " .. name .. "='outer'><p/></g></svg>")[name], nil, name)
  end
end

function T.declarations_may_be_written_loosely()
  local own = of("<svg><p style=' stroke : red;;fill:none !important ; x ; stroke-width:2'/></svg>")
  check.equal({ own.stroke, own.fill, own["stroke-width"] }, { "red", "none", "2" })
  check.equal(stroke("<svg><style>/* p{stroke:a} */ p{/*x*/stroke:b}</style><p/></svg>"), "b")
end

function T.rules_within_conditions_are_whole()
  check.equal(stroke "<svg><style>@media screen{p{stroke:a}}p{fill:b}</style><p/></svg>", "a")
  check.equal(of("<svg><style>@media all{q{x:y}}p{fill:b}</style><p/></svg>").fill, "b")
end

function T.rules_for_a_screen_count_and_others_are_said()
  local own, notes = of [[<svg><style>@media screen { p{stroke:a} }
    @media  print{p{stroke:b}} @import url(x.css); @font-face{font-family:p} q p{stroke:c}
    p:hover{stroke:d} @supports (x:y) {p{stroke:e}} p{fill:f}</style><p/></svg>]]
  check.equal({ own.stroke, own.fill }, { "a", "f" })
  check.equal(notes, { "1: the style rules of '@media print' are not read",
                       "1: the style rules of '@supports (x:y)' are not read",
                       "1: the style rule 'q p' is not read",
                       "1: the style rule 'p:hover' is not read" })
end

local function seen(attributes, file)
  local missing = {}
  local named = {}
  for _, element in ipairs(tree.read(file or "").children) do
    named[element.attributes.id] = element
  end
  local how = styles.seen_by(of("<svg><p " .. attributes .. "/></svg>"), named,
                             function(reference) missing[#missing + 1] = reference end)
  return how or "unseen", missing
end

function T.lines_come_before_faces()
  for attributes, how in pairs {
    [""] = "fill", ["stroke='red'"] = "stroke", ["fill='none'"] = "unseen",
    ["fill='none' stroke='none'"] = "unseen", ["stroke='transparent' fill='red'"] = "fill",
    ["stroke='red' stroke-width='0'"] = "fill", ["stroke='red' stroke-width='0px'"] = "fill",
    ["stroke='red' stroke-width='.1'"] = "stroke", ["stroke='red' stroke-opacity='0'"] = "fill",
    ["stroke='red' stroke-opacity='0.0%' fill-opacity='0'"] = "unseen",
    ["stroke='#ff000000'"] = "fill", ["stroke='#f000'"] = "fill", ["stroke='#f00'"] = "stroke",
    ["stroke='#000000'"] = "stroke",
    ["stroke='#000000ff'"] = "stroke", ["stroke='#000f'"] = "stroke",
        ["stroke='#00000f00'"] = "fill", ["stroke='#0000'"] = "fill",
    ["stroke='rgba(1,2,3,0)'"] = "fill", ["stroke='rgba(1,2,3,.5)'"] = "stroke",
    ["stroke='rgb(1 2 3 / 0%)'"] = "fill", ["stroke='rgb(0,0,0)'"] = "stroke",
    ["stroke='hsl(0 0% 0%)'"] = "stroke", ["stroke=' NONE '"] = "fill",
    ["stroke='currentColor' color='transparent'"] = "fill", ["stroke='currentColor'"] = "stroke",
    ["stroke='currentcolor' color='currentColor'"] = "fill",
  } do
    check.equal(seen(attributes), how, attributes)
  end
end

function T.paints_by_reference()
  local file = "<linearGradient id='g'/><g id='none'/><pattern id='p'/>"
  check.equal({ seen("stroke='url(#g)'", file) }, { "stroke", {} })
  for _, server in ipairs { "linearGradient", "radialGradient", "pattern", "solidColor",
                            "meshgradient", "hatch" } do
    check.equal({ seen("stroke='url(#x)'", "<" .. server .. " id='x'/>") }, { "stroke", {} },
                server)
  end
  check.equal({ seen("stroke='url( &quot;#p&quot; ) none'", file) }, { "stroke", {} })
  check.equal({ seen("stroke='url(#absent)' fill='none'", file) }, { "unseen", { "#absent" } })
  check.equal({ seen("stroke='url(#absent) red'", file) }, { "stroke", { "#absent" } })
  check.equal({ seen("stroke='url(#none)'", file) }, { "fill", { "#none" } },
              "a group paints nothing")
end

function T.hidden_elements()
  for text, hidden in pairs { ["display='none'"] = true, ["opacity='0'"] = true,
                              ["opacity='0%'"] = true,
                              ["opacity='.01'"] = false, ["visibility='hidden'"] = false,
                                  [""] = false,
                              ["opacity='0e3'"] = true, ["opacity='nothing'"] = false } do
    check.equal(styles.hidden(of("<svg><p " .. text .. "/></svg>")), hidden, text)
  end
  for _, word in ipairs { "hidden", "collapse" } do
    check.yes(styles.invisible(of("<svg><g visibility='" .. word .. "'><p/></g></svg>")))
  end
  local within = "<svg><g visibility='hidden'><p visibility='visible'/></g></svg>"
  check.yes(not styles.invisible(of(within)))
end

function T.colours_that_are_not_black()
  for text, colour in pairs { black = false, ["#000"] = false, ["rgb(0, 0, 0)"] = false,
                              none = false,
                              BLACK = false, currentColor = false, red = "red",
                                  [" # 1 "] = "#1" } do
    check.equal(styles.colour({ stroke = text }) or false, colour, text)
  end
  check.equal(styles.colour({ stroke = "currentColor", color = "red" }), "red")
end

return check.all(T)
