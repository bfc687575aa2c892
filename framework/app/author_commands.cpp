// SPDX-License-Identifier: Apache-2.0
// The command line for authors of plugins and missions.
#include <CLI/CLI.hpp>

#include "framework/app/command_options.h"
#include "framework/app/descriptions.h"
#include "framework/app/new_files.h"
#include "framework/app/plugin_check.h"

namespace lapwing {

void add_plugin_commands(CLI::App& app, Invocation& invocation, std::string& name,
                         Description& described, PluginCheck& asked, Command& command) {
  CLI::App* plugins = app.add_subcommand("plugins", "list, show and check plugins");
  plugins->require_subcommand(1);
  CLI::App* list = plugins->add_subcommand("list", "every plugin, by kind");
  add_json(*list, invocation);
  list->callback([&] { command = [&] { return list_plugins(invocation); }; });
  CLI::App* show = plugins->add_subcommand("show", "a plugin's parameters");
  add_text(*show, "name", "[KIND/]NAME", "its name", [&](const std::string& given) {
    name = given;
  })->required();
  show->add_flag("--markdown", described.markdown, "parameters as a Markdown table");
  add_json(*show, invocation);
  show->callback(
      [&] { command = [&] { return show_plugin(name, described.markdown, invocation); }; });
  CLI::App* path = plugins->add_subcommand("path", "the folders that are searched");
  add_json(*path, invocation);
  path->callback([&] { command = [&] { return show_plugin_path(invocation); }; });
  CLI::App* check = plugins->add_subcommand(
      "check", "run the checks of its kind, each test in a separate process");
  add_text(*check, "plugin", "FILE.so|[KIND/]NAME", "a library, or the name of a plugin",
           [&](const std::string& given) { asked.target = given; })
      ->required();
  add_repeated(*check, "--only", "TEST", asked.only,
               "run this test only; repeatable; default: all");
  add_text(*check, "--limit", "S", "time limit of a test in s; default: 60",
           [&](const std::string& text) {
             asked.limit = read_number("--limit", text);
             if (!(asked.limit > 0))
               throw CLI::ValidationError("--limit",
                                          "expected a number above 0, not '" + text + "'");
           });
  add_json(*check, invocation);
  check->callback([&] { command = [&] { return check_plugins(asked, invocation); }; });
}

void add_description_commands(CLI::App& app, Invocation& invocation, Description& asked,
                              Command& command) {
  CLI::App* annotations = app.add_subcommand(
      "annotations", "write functions and options for the Lua language server of an editor");
  CLI::App* schema =
      app.add_subcommand("schema", "write a JSON schema of configurations, for editors");
  for (CLI::App* one : {annotations, schema})
    add_text(*one, "-o,--output", "FILE", "the file to write; default: standard output",
             [&](const std::string& path) { asked.target = path; });
  annotations->add_flag("--markdown", asked.markdown, "functions only, as a Markdown table");
  add_text(*schema, "kind", "KIND", "a kind of mission, or vehicle; default: all missions",
           [&](const std::string& given) { asked.kind = given; });
  annotations->callback([&] { command = [&] { return write_annotations(asked, invocation); }; });
  schema->callback([&] { command = [&] { return write_schema(asked, invocation); }; });
}

void add_new_commands(CLI::App& app, Invocation& invocation, NewFiles& wanted, Command& command) {
  CLI::App* made = app.add_subcommand("new", "write files to start from");
  made->require_subcommand(1);
  CLI::App* plugin = made->add_subcommand("plugin", "write a working plugin with tests and README");
  CLI::App* mission =
      made->add_subcommand("mission", "write a mission script with explanatory comments");
  for (CLI::App* one : {plugin, mission}) {
    add_text(*one, "kind", "KIND", one == plugin ? "cost_term, constraint, ..." : "film, race, ...",
             [&](const std::string& given) { wanted.kind = given; })
        ->required();
    add_text(*one, "name", one == plugin ? "NAME" : "FILE",
             one == plugin ? "its name, in snake_case; also the folder's" : "the file to write",
             [&](const std::string& given) { wanted.name = given; })
        ->required();
    add_json(*one, invocation);
  }
  add_text(*plugin, "--in", "DIR", "where the folder is made; default: here",
           [&](const std::string& given) { wanted.folder = given; });
  plugin->callback([&] { command = [&] { return new_plugin(wanted, invocation); }; });
  mission->callback([&] { command = [&] { return new_mission(wanted, invocation); }; });
}

}  // namespace lapwing
