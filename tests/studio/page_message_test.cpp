// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/page_message.h"

#include "framework/core/checksum.h"
#include "framework/core/json.h"
#include "framework/studio/blob_store.h"

namespace lapwing {
namespace {

const char* const kGood[] = {
    R"({"type": "hello", "token": "t", "tab": "a", "seen": 3})",
    R"({"type": "preview", "edit": 4, "patch": [{"path": "margin", "value": 2}]})",
    R"({"type": "gesture", "id": "g", "base": 0, "label": "", "patch": []})",
    R"({"type": "gesture", "id": "g", "base": 0, "label": "", "patch": [], "after": ["f"]})",
    R"({"type": "undo", "id": "u", "base": 2})",
    R"({"type": "redo", "id": "u", "base": 2})",
    R"({"type": "rest"})",
    R"({"type": "resolve_script", "take": "both"})",
    R"({"type": "fly", "edit": 1, "wind": [3, -1, 0], "seed": 2})",
    R"({"type": "fly", "edit": 1, "wind": [3, -1, 0], "gust": 0.5, "seed": 2})",
    R"({"type": "picture", "edit": 1, "time": 2.5, "width": 640, "height": 480})",
    R"({"type": "export", "id": "e", "format": "csv"})",
    R"({"type": "export", "id": "e", "format": "x", "parameters": {"r": 5}, "uncertified": true})",
    R"({"type": "save_report", "id": "s"})",
    R"({"type": "export_lua", "id": "l"})",
    R"({"type": "list_runs", "id": "r"})",
    R"({"type": "slice", "id": "s", "axis": "x", "at": 1, "image": 3, "folder": "explore_city"})",
    R"({"type": "voxel", "id": "v", "position": [1, 2, 3], "image": 0})",
    R"({"type": "open_run", "id": "r", "folder": "explore_city"})",
    R"({"type": "pace", "pace": "step"})",
    R"({"type": "voxel", "id": "v", "ray": [0, 0, 9, 0, 0, -1]})",
    R"({"type": "voxel", "id": "v", "position": [0, 0.5, 9]})",
    R"({"type": "slice", "id": "s", "axis": "x", "at": 2.5})",
    R"({"type": "left_out", "id": "l"})",
    R"({"type": "view", "id": "w", "candidate": 7})",
    R"({"type": "view", "id": "w", "image": 7, "tour": 1})"};

TEST(PageMessages, AreReadWithTheirFields) {
  for (const char* text : kGood) EXPECT_NO_THROW(page_message(text)) << text;
  const PageMessage fly = page_message(kGood[9]);
  EXPECT_EQ(fly.type, PageMessageType::fly);
  EXPECT_EQ(fly.wind[1], -1);
  EXPECT_EQ(fly.gust, 0.5);
  const PageMessage preview = page_message(kGood[1]);
  EXPECT_EQ(preview.edit, 4u);
  EXPECT_EQ(to_text(preview.patch.at(0).path), "margin");
}

// Each good message without one of its fields, with one more, and with each field of another type.
TEST(PageMessages, WhatIsMissingUnknownOrOfAnotherTypeIsRefused) {
  for (const char* text : kGood) {
    const Value good = from_json(text, "test");
    Value more = good;
    more.set("surplus", 1);
    EXPECT_THROW(page_message(to_json(more)), InputError) << text;
    for (const auto& [key, value] : good.as_map()) {
      Value other = good;
      other.set(key, value.is_map() ? Value(3) : Value(Value::Map{{"x", Value(1)}}));
      EXPECT_THROW(page_message(to_json(other)), InputError) << text << key;
      if (key == "parameters" || key == "uncertified" || key == "gust" || key == "after" ||
          key == "tour")
        continue;
      // Of a map; beside a folder an image is needed.
      const bool map = good.at("type") == Value("voxel") || good.at("type") == Value("slice");
      if (map && (key == "folder" || (key == "image" && !good.find("folder")))) continue;
      Value less = good;
      std::erase_if(less.as_map(), [&](const auto& entry) { return entry.first == key; });
      EXPECT_THROW(page_message(to_json(less)), InputError) << text << key;
    }
  }
}

TEST(PageMessages, WhatIsOutOfRangeIsRefused) {
  const std::string long_text(5000, 'x');
  for (const std::string& text : std::initializer_list<std::string>{
           "",
           "{",
           "[]",
           "3",
           "null",
           R"({"type": "welcome"})",
           R"({"type": 3})",
           R"({"type": "undo", "id": "", "base": 2})",
           R"({"type": "undo", "id": "u", "base": -1})",
           R"({"type": "undo", "id": "u", "base": 1.5})",
           R"({"type": "undo", "id": "u", "base": 1e300})",
           R"({"type": "fly", "edit": 1, "wind": [3, 1, 1], "seed": 2})",
           R"({"type": "fly", "edit": 1, "wind": [3e9, 1, 0], "seed": 2})",
           R"({"type": "fly", "edit": 1, "wind": [1, 0], "seed": 2})",
           R"({"type": "picture", "edit": 1, "time": -1, "width": 640, "height": 480})",
           R"({"type": "picture", "edit": 1, "time": 1, "width": 640, "height": 100000})",
           R"({"type": "picture", "edit": 1, "time": 1, "width": 0, "height": 10})",
           R"({"type": "resolve_script", "take": "none"})",
           R"({"type": "voxel", "id": "v", "position": [0, 0, 9], "ray": [0, 0, 9, 0, 0, -1]})",
           R"({"type": "voxel", "id": "v", "position": [0, 0]})",
           R"({"type": "voxel", "id": "v", "position": [0, 0, 1e30]})",
           R"({"type": "slice", "id": "s", "axis": "w", "at": 2})",
           R"({"type": "view", "id": "w", "candidate": 1, "image": 1})",
           R"({"type": "view", "id": "w", "candidate": 1, "tour": 1})",
           R"({"type": "view", "id": "w", "image": -1})",
           R"({"type": "gesture", "id": "g", "base": 0, "label": "", "patch": [], "after": [3]})",
           R"({"type": "gesture", "id": "g", "base": 0, "label": "", "patch": [], "after": [""]})",
           "{\"type\": \"undo\", \"id\": \"" + long_text + "\", \"base\": 2}",
           "{\"type\": \"" + long_text + "\"}",
           std::string(100000, '[')})
    EXPECT_THROW(page_message(text), InputError) << text.substr(0, 80);
  std::string many = R"({"type": "preview", "edit": 1, "patch": [)";
  for (std::size_t i = 0; i <= kMostChanges; ++i)
    many += std::string(i ? "," : "") + R"({"path": "a", "value": 1})";
  EXPECT_THROW(page_message(many + "]}"), InputError);
}

TEST(Blobs, AreKeptByTheirSumUpToALimit) {
  BlobStore store(100);
  const std::string first = store.put(std::string(40, 'a')),
                    second = store.put(std::string(40, 'b'));
  EXPECT_EQ(first, sha256(std::string(40, 'a')));
  EXPECT_EQ(store.put(std::string(40, 'a')), first);
  EXPECT_EQ(store.bytes(), 80u);
  ASSERT_TRUE(store.find(first));  // asked for last: the other goes
  const std::string third = store.put(std::string(40, 'c'));
  EXPECT_TRUE(store.find(first));
  EXPECT_FALSE(store.find(second));
  EXPECT_EQ(*store.find(third), std::string(40, 'c'));
  EXPECT_FALSE(store.find("../../etc/passwd"));
  store.put(std::string(1000, 'd'));  // alone
  EXPECT_EQ(store.bytes(), 1000u);
}

TEST(Blobs, TrianglesAreAHeaderThenArrays) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2.5, 0}};
  mesh.triangles = {{0, 1, 2}};
  const std::string blob = triangles_blob(mesh);
  ASSERT_EQ(blob.size(), 16u + 36u + 12u);
  EXPECT_EQ(blob.substr(0, 4), "WLB1");
  EXPECT_EQ(blob[4], 3);
  EXPECT_EQ(blob[8], 1);
  float y = 0;
  std::memcpy(&y, blob.data() + 16 + 4 * 7, 4);
  EXPECT_EQ(y, 2.5f);
}

// A page names a folder of out/ and nothing else.
TEST(PageMessages, AFolderIsAName) {
  for (const char* folder : {"..", ".", "a/b", "/etc", "../x", ".hidden", ""}) {
    const std::string text =
        std::string(R"({"type": "open_run", "id": "r", "folder": ")") + folder + "\"}";
    EXPECT_THROW(page_message(text), InputError) << folder;
  }
  EXPECT_THROW(page_message(R"({"type": "pace", "pace": "fast"})"), InputError);
}

}  // namespace
}  // namespace lapwing
