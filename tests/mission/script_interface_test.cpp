// SPDX-License-Identifier: Apache-2.0
// Nothing is given to scripts that is not described.
#include "framework/mission/script_interface.h"

#include <gtest/gtest.h>

#include <set>

#include <lua.hpp>

#include "framework/mission/guard.h"

namespace lapwing {
namespace {

class Bindings : public ::testing::Test {
 protected:
  Bindings() : sandbox_({}, 1, {settings_.scripts}, [](const std::string&) {}) {
    sandbox_.protect([&](lua_State* state) {
      note_bindings(state, types_);
      open_script_libraries(state, run_);
    });
  }

  const BoundType* find(const std::string& name) const {
    for (const BoundType& type : types_)
      if (type.name == name) return &type;
    return nullptr;
  }

  // The texts among the keys of the table on top of the stack.
  static std::set<std::string> keys(lua_State* state) {
    std::set<std::string> names;
    for (lua_pushnil(state); lua_next(state, -2); lua_pop(state, 1))
      if (lua_type(state, -2) == LUA_TSTRING) names.insert(lua_tostring(state, -2));
    return names;
  }

  MissionSettings settings_ = [] {
    MissionSettings settings;
    settings.scripts = LAPWING_SOURCE_DIR "/scripts";
    settings.configs = LAPWING_SOURCE_DIR "/configs";
    return settings;
  }();
  MissionRun run_{settings_, DataFiles({settings_.configs}), "", "", Value::map(), 0, {}};
  std::vector<BoundType> types_;
  Sandbox sandbox_;
};

std::set<std::string> described(const BoundType& type) {
  std::set<std::string> names;
  for (const Binding& binding : type.functions) names.insert(binding.name);
  return names;
}

TEST_F(Bindings, AreAllDescribed) {
  int objects = 0;
  sandbox_.protect([&](lua_State* state) {
    lua_getglobal(state, "lapwing");
    ASSERT_TRUE(find("lapwing"));
    EXPECT_EQ(keys(state), described(*find("lapwing")));
    // Metatables lie in the registry under the names of their types.
    lua_pushvalue(state, LUA_REGISTRYINDEX);
    const std::set<std::string> names = keys(state);
    const int top = lua_gettop(state);
    for (const std::string& name : names) {
      lua_settop(state, top);
      if (lua_getfield(state, LUA_REGISTRYINDEX, name.c_str()) != LUA_TTABLE ||
          lua_getfield(state, -1, "__gc") != LUA_TFUNCTION) {
        continue;
      }
      lua_getfield(state, -2, "__index");
      if (lua_isfunction(state, -1)) lua_getupvalue(state, -1, 1);
      ASSERT_TRUE(lua_istable(state, -1)) << name;
      const BoundType* type = find(name);
      EXPECT_EQ(keys(state), type ? described(*type) : std::set<std::string>{}) << name;
      ++objects;
    }
  });
  EXPECT_GE(objects, 15);
}

TEST_F(Bindings, SayWhatTheyTakeAndGive) {
  int functions = 0;
  for (const BoundType& type : types_) {
    for (const BoundField& field : type.fields) {
      EXPECT_STRNE(field.type, "") << type.name << "." << field.name;
      EXPECT_STRNE(field.summary, "") << type.name << "." << field.name;
    }
    for (const Binding& binding : type.functions) {
      const std::string name = type.name + "." + binding.name, signature = binding.signature;
      ++functions;
      EXPECT_STRNE(binding.summary, "") << name;
      ASSERT_EQ(signature.find('('), 0u) << name;
      EXPECT_NE(signature.find(')'), std::string::npos) << name;
      const bool own = binding.table || !binding.objects.empty();
      EXPECT_EQ(signature.find(": @") != std::string::npos, own) << name;
      if (!binding.table) continue;
      const ParameterTable table = binding.table();
      for (const ParameterSpec& spec : table.specs())
        EXPECT_TRUE(!spec.summary.empty()) << name << "." << spec.name;
    }
  }
  EXPECT_GT(functions, 70);
}

// A field without a description is a defect that the first access shows.
TEST_F(Bindings, AFieldWithoutADescriptionIsADefect) {
  static constexpr BoundField kKnown[] = {{"time", "number", "s"}};
  Value fields = Value::map();
  fields.set("time", 1);
  sandbox_.protect([&](lua_State* state) {
    EXPECT_EQ(push_field(state, "a plan", "time", fields, kKnown), 1);
    EXPECT_THROW(push_field(state, "a plan", "tme", fields, kKnown), InputError);
    fields.set("speed", 2);
    EXPECT_THROW(push_field(state, "a plan", "time", fields, kKnown), Error);
  });
}

// The annotations are Lua, and nothing but declarations.
TEST_F(Bindings, AnnotationsAreLua) {
  const Registry registry({std::filesystem::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  const std::string text = annotations_of(read_script_interface(settings_), registry);
  sandbox_.protect([&](lua_State* state) {
    ASSERT_EQ(luaL_loadbufferx(state, text.data(), text.size(), "=annotations", "t"), LUA_OK)
        << lua_tostring(state, -1);
    lua_call(state, 0, 0);
  });
}

}  // namespace
}  // namespace lapwing
