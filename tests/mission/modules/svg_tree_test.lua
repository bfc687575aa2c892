-- SPDX-License-Identifier: Apache-2.0
-- SVG files as trees: tags, attributes, what is passed over, lines, and files that are broken.
local check = require "check"
local tree = require "mission.svg_tree"

local T = {}

-- "svg(g(path),path)" of a tree.
local function names(element)
  local parts = {}
  for i, child in ipairs(element.children) do parts[i] = names(child) end
  return element.name .. (#parts > 0 and "(" .. table.concat(parts, ",") .. ")" or "")
end

local function only(text) return tree.read(text).children[1] end

function T.elements_stand_in_their_parents()
  for text, wanted in pairs {
    ["<svg/>"] = "(svg)", ["<svg></svg>"] = "(svg)", [""] = "",
    ["<svg><g><path/></g><path/></svg>"] = "(svg(g(path),path))",
    ["<svg:svg><svg:g></svg:g></svg:svg>"] = "(svg(g))",
    ["<?xml version='1.0'?><!DOCTYPE svg [<!ENTITY a 'b'>]><svg><!-- <g> --><g/></svg>"]
      = "(svg(g))",
    ["<svg ><g\n/><g\t></g ></svg >"] = "(svg(g,g))",
        ["text<svg>more<g/>still</svg>end"] = "(svg(g))",
    ["<svg><![CDATA[<g></h>]]></svg>"] = "(svg)", ["<svg><a.b-c:d/></svg>"] = "(svg(a.b-c:d))",
  } do
    -- A DOCTYPE with declarations of its own ends at the first '>' outside of quotes.
    check.equal(names(tree.read(text)), wanted, text)
  end
end

function T.attributes_are_read()
  check.equal(only("<p a='1' b=\"2\"\n c = '3'\td='4'/>").attributes,
              { a = "1", b = "2", c = "3", d = "4" })
  check.equal(only("<p xlink:href='#a' data-x.y='=' z='/'></p>").attributes,
              { ["xlink:href"] = "#a", ["data-x.y"] = "=", z = "/" })
  check.equal(only("<p a='>' b='\"' c=\"'\"/>").attributes, { a = ">", b = '"', c = "'" })
  check.equal(only("<p a='&lt;&gt;&amp;&quot;&apos;&#65;&#x42;&#x20ac;'/>").attributes.a,
              "<>&\"'AB\u{20ac}")
  -- Entities of a file's own, and what is none, stay as they stand.
  check.equal(only("<p a='&own; & &#x110000; &;'/>").attributes.a, "&own; & &#x110000; &;")
  check.equal(only("<p a='&amp;lt;'/>").attributes.a, "&lt;", "read once")
end

-- Of any length, between any spaces: patterns would be refused on long texts.
function T.long_tags_are_read()
  local long = ("M1,2 "):rep(20000)
  local spaces = (" "):rep(5000)
  check.equal(only("<p" .. spaces .. "d='" .. long .. "'" .. spaces .. "e='2'" .. spaces .. "/>")
                .attributes, { d = long, e = "2" })
  local many, wanted = {}, {}
  for i = 1, 300 do
    many[i] = ("name%d = '%d'"):format(i, i)
    wanted["name" .. i] = tostring(i)
  end
  check.equal(only("<p " .. table.concat(many, "\n") .. "/>").attributes, wanted)
end

-- A value is never taken for that of another name.
function T.attributes_without_quotes_or_value_are_refused()
  for _, text in ipairs { "<p\n d=M0,0 />", "<p\n hidden d='M0,0'/>", "<p\n d= x='1'/>", "<p\n d/>",
                          "<p\n a='1' b/>", "<p\n ='1'/>" } do
    check.fails("line 1: an attribute is no name=\"value\": '", tree.read, text)
  end
  check.fails("'hidden d='M0,0''", tree.read, "<p hidden d='M0,0'/>")
end

function T.lines_are_those_of_the_tags()
  local root = tree.read("<svg>\n\n<g>\n<path\nd=''/></g><path/>\n</svg>")
  local svg = root.children[1]
  check.equal(svg.line, 1)
  check.equal(svg.children[1].line, 3)
  check.equal(svg.children[1].children[1].line, 4)
  check.equal(svg.children[2].line, 5)
end

function T.texts_of_styles_are_kept()
  local style = only("<style>a{b:c}<!-- x --><![CDATA[.d{e:f}]]>g{}</style>")
  check.yes(style.text:find("a{b:c}", 1, true), style.text)
  check.yes(style.text:find(".d{e:f}", 1, true), style.text)
  check.yes(not style.text:find("CDATA", 1, true), style.text)
  check.yes(style.text:find("g{}", 1, true), "what follows it: " .. style.text)
  check.equal(only("<desc>a<b/>c</desc>").text, "")
end

function T.broken_files_are_refused_with_their_line()
  for text, message in pairs {
    ["<svg>\n<g>"] = "line 2: <g> is not closed",
        ["<svg>\n</g></svg>"] = "line 2: </g> has no opening tag",
    ["</svg>"] = "line 1: </svg> has no opening tag",
        ["<svg/>\n</svg>"] = "line 2: </svg> has no opening tag",
    ["<svg>\n<path d='M0"] = "line 2: the file ends within a tag",
    ["<svg>\n<path"] = "line 2: the file ends within a tag",
    ["<svg><!-- <g/>"] = "the file ends within <!--",
    ["<svg><![CDATA[ ]]"] = "the file ends within <![CDATA[", ["<?xml"] = "the file ends within <?",
    ["<SVG></svg>"] = "line 1: </svg> has no opening tag",
  } do
    check.fails(message, tree.read, text)
  end
end

function T.depth_is_limited()
  local function nested(n) return ("<g>"):rep(n) .. ("</g>"):rep(n) end
  check.equal(#tree.read(nested(60)).children, 1)
  check.fails("nested more than 60 deep", tree.read, nested(61))
  -- Beside each other there may be many, and reading them takes time in proportion.
  check.equal(#tree.read(("<g></g>\n"):rep(20000)).children, 20000)
end

return check.all(T)
