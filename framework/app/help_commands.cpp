// SPDX-License-Identifier: Apache-2.0
#include "framework/app/help_commands.h"

#include <CLI/CLI.hpp>
#include <iostream>

#include "framework/app/command_reference.h"
#include "framework/app/completion_names.h"
#include "framework/app/new_files.h"
#include "framework/app/terminal.h"

namespace lapwing {

namespace {

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : shown_commands(app)) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  std::string nearest;
  for (const std::string& name : known)  // "--conf" begins "--config", however long the rest is
    if (word.size() > 3 && name.starts_with(word) && nearest.empty()) nearest = name;
  if (nearest.empty()) nearest = nearest_name(word, known);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

// What somebody wants who takes a kind of missions for a command.
std::string of_kind(const std::string& word) {
  const std::vector<std::string> kinds = mission_kinds();
  if (std::find(kinds.begin(), kinds.end(), word) == kinds.end()) return "";
  return "; " + word + " is a kind of mission: `lapwing new mission " + word +
         " FILE.lua` writes one, `lapwing run FILE.lua` plans it";
}

// The command that was reached; its path is "lapwing map info".
struct ReachedCommand {
  const CLI::App* app;
  std::string path;
};

ReachedCommand reached_command(const CLI::App& app) {
  ReachedCommand reached{&app, "lapwing"};
  while (!reached.app->get_subcommands().empty()) {
    reached.app = reached.app->get_subcommands().front();
    reached.path += " " + reached.app->get_name();
  }
  return reached;
}

std::string unknown_word(const CLI::App& app, const ReachedCommand& reached) {
  std::vector<std::string> known = names_of_options(*reached.app);
  for (const std::string& name : names_of_options(app)) known.push_back(name);
  for (const std::string& word : app.remaining(true)) {
    if (!word.starts_with("-") || word == "-" || word == "--") continue;
    const std::string option = word.substr(0, word.find('='));
    if (std::count(known.begin(), known.end(), option) > 0)
      return "'" + option + "' is an option of '" + reached.path + "': write it behind that";
    return "'" + reached.path + "' has no option '" + option + "'" + did_you_mean(option, known);
  }
  const std::vector<std::string> rest = app.remaining(true);
  const std::vector<std::string> commands = names_of_commands(*reached.app);
  if (rest.empty()) return "";
  if (commands.empty())
    return "'" + reached.path + "' takes no '" + rest.front() +
           "' in addition to the other arguments";
  const std::string kind = of_kind(rest.front());
  return "unknown command '" + rest.front() + "'" +
         (kind.empty() ? did_you_mean(rest.front(), commands) : kind);
}

// CLI11 says "mission is required" and "--world: 1 required NAME missing".
std::string what_is_missing(const ReachedCommand& reached, const CLI::ParseError& error) {
  const std::string reason = error.what();
  if (error.get_name() == "RequiredError") {
    for (const CLI::Option* option : reached.app->get_options())
      if (option->get_required() && option->count() == 0)
        return "'" + reached.path + "' wants " +
               (option->get_positional() ? "" : option->get_name() + " ") +
               option->get_type_name() + ": " + option->get_description();
  } else if (error.get_name() == "ArgumentMismatch") {
    const CLI::Option* option =
        reached.app->get_option_no_throw(reason.substr(0, reason.find(':')));
    if (option)
      return "'" + option->get_name() + "' wants " + option->get_type_name() + ": " +
             option->get_description();
  }
  return reason;
}

ExitStatus print_help(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* at = &app;
  std::string path = "lapwing";
  for (const std::string& word : words) {
    const std::vector<std::string> known = names_of_commands(*at);
    const CLI::App* next = nullptr;
    for (const CLI::App* command : shown_commands(*at))
      if (command->get_name() == word) next = command;
    if (!next) {
      const std::string kind = at == &app ? of_kind(word) : "";
      throw InputError("'" + path + "' has no command '" + word + "'" +
                       (kind.empty() ? did_you_mean(word, known) : kind));
    }
    at = next;
    path += " " + word;
  }
  // App::help would show the command that was typed: `help` itself.
  std::cout << at->get_formatter()->make_help(at, path, CLI::AppFormatMode::Normal) << std::flush;
  return ExitStatus::done;
}

}  // namespace

void add_help_commands(CLI::App& app, const Invocation& invocation, HelpRequest& asked,
                       Command& command) {
  CLI::App* version = app.add_subcommand("version", "print the version of the program");
  version->callback([&] {
    command = [] {
      std::cout << "lapwing " << program_version() << std::endl;
      return ExitStatus::done;
    };
  });
  CLI::App* help = app.add_subcommand("help", "list the commands, or describe one");
  add_text(*help, "command", "COMMAND...",
           "a command, such as run or map info; default: all commands",
           [&](const std::string& word) { asked.words.push_back(word); })
      ->expected(-1)
      ->take_all();
  help->callback([&] { command = [&] { return print_help(app, asked.words); }; });
  CLI::App* completion =
      app.add_subcommand("completion", "a script that completes commands and options in a shell");
  add_text(*completion, "shell", "bash|zsh|fish", "which shell", [&](const std::string& name) {
    asked.shell = name;
  })->required();
  completion->callback([&] {
    command = [&] {
      std::cout << completion_script(command_tree(), asked.shell) << std::flush;
      return ExitStatus::done;
    };
  });
  CLI::App* names = app.add_subcommand("complete", "the names of a list, for completion");
  names->group("");  // for scripts of shells alone
  add_text(*names, "list", "LIST", "which list", [&](const std::string& name) {
    asked.names = name;
  })->required();
  add_text(*names, "script", "MISSION.lua", "whose settings",
           [&](const std::string& path) { asked.script = path; });
  add_text(*names, "typed", "KEY=", "the beginning of the names",
           [&](const std::string& text) { asked.typed = text; });
  names->callback([&] {
    command = [&] {
      return asked.names == kSettings ? print_settings(asked.script, asked.typed, invocation)
                                      : print_names(asked.names, invocation);
    };
  });
  CLI::App* man = app.add_subcommand("man", "the manual page, in roff");
  man->callback([&] {
    command = [] {
      std::cout << manual_page(command_tree(), program_version()) << std::flush;
      return ExitStatus::done;
    };
  });
}

void add_colour(CLI::App& app) {
  add_text(app, "--color", "auto|always|never",
           "colour of what is printed; default: auto, on a terminal unless NO_COLOR is set",
           [](const std::string& word) {
             if (word == "auto")
               choose_colour(ColourChoice::automatic);
             else if (word == "always")
               choose_colour(ColourChoice::always);
             else if (word == "never")
               choose_colour(ColourChoice::never);
             else
               throw CLI::ValidationError("--color",
                                          "expected auto, always or never, not '" + word + "'");
           });
}

bool help_of_unknown(const CLI::App& app) {
  const ReachedCommand reached = reached_command(app);
  const std::vector<std::string> rest = app.remaining(true);
  return !rest.empty() && !rest.front().starts_with("-") && !shown_commands(*reached.app).empty();
}

std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const ReachedCommand reached = reached_command(app);
  std::string message = unknown_word(app, reached);
  const std::string reason = what_is_missing(reached, error);
  const std::vector<const CLI::App*> below = shown_commands(*reached.app);
  if (!message.empty() || below.empty())
    return (message.empty() ? reason : message) + "\nRun '" + reached.path +
           " --help' for its options.";
  message = "expected a command after '" + reached.path + "':";
  for (const CLI::App* command : below) {
    std::string name = command->get_name();
    name.resize(std::max<std::size_t>(name.size(), 12), ' ');
    message += "\n  " + name + " " + command->get_description();
  }
  return message + "\nRun '" + reached.path +
         (reached.app == &app ? " help COMMAND'" : " COMMAND --help'") +
         " for the options of a command.";
}

}  // namespace lapwing
