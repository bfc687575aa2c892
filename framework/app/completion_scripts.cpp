// Completion for bash, zsh and fish. All three walk the typed words from command to command, skip
// options and their values, and offer what may come next; the tables are the declared commands.
#include <algorithm>

#include "framework/app/command_reference.h"
#include "framework/core/error.h"

namespace lapwing {

namespace {

struct CompletedValue {
  std::string pattern;  // "lapwing run --out"
  ValueKind kind = ValueKind::none;
  std::vector<std::string> words;
};

// Within single quotes of a shell.
std::string shell_quoted(const std::string& text, const std::string& quote = "'\\''") {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? quote : std::string(1, c);
  return out + "'";
}

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : between) + word;
  return all;
}

// Options that stand after every command: the first entry's, but for its help and version.
std::vector<OptionEntry> options_of(const CommandEntry& command, const CommandEntry& tree) {
  std::vector<OptionEntry> options;
  const auto add = [&](const CommandEntry& from, bool common) {
    for (const OptionEntry& option : from.options) {
      if (option.positional) continue;
      const std::string& last = option.names.back();
      if (common && (last == "--help" || last == "--version")) continue;
      options.push_back(option);
    }
  };
  add(command, false);
  if (&command != &tree) add(tree, true);
  return options;
}

std::vector<CompletedValue> values_of(const CommandEntry& command, const CommandEntry& tree) {
  std::vector<CompletedValue> values;
  for (const OptionEntry& option : options_of(command, tree))
    if (!option.value.empty())
      for (const std::string& name : option.names)
        values.push_back(
            {command.path + " " + name, kind_of_value(option.value), words_of_value(option.value)});
  return values;
}

// What stands after a command without an option before it: commands below, words of its
// positionals, or files.
std::vector<std::string> words_after(const CommandEntry& command, const CommandEntry& tree) {
  std::vector<std::string> words;
  const CommandEntry& offered = command.path == "lapwing help" ? tree : command;
  for (const CommandEntry& below : offered.commands) words.push_back(below.name);
  for (const OptionEntry& option : command.options)
    if (option.positional && kind_of_value(option.value) == ValueKind::words)
      for (const std::string& word : words_of_value(option.value)) words.push_back(word);
  return words;
}

ValueKind files_after(const CommandEntry& command) {
  for (const OptionEntry& option : command.options)
    if (option.positional && kind_of_value(option.value) == ValueKind::files)
      return ValueKind::files;
  for (const OptionEntry& option : command.options)
    if (option.positional && kind_of_value(option.value) == ValueKind::folders)
      return ValueKind::folders;
  return ValueKind::none;
}

// The walk through the typed words, which bash and zsh write alike: `at` becomes the command.
std::string walk_of_words(const CommandEntry& tree, const std::string& first,
                          const std::string& last) {
  std::string commands, valued;
  for (const CommandEntry* command : every_command(tree)) {
    if (command != &tree) commands += (commands.empty() ? "" : "|") + shell_quoted(command->path);
    for (const CompletedValue& value : values_of(*command, tree))
      valued += (valued.empty() ? "" : "|") + shell_quoted(value.pattern);
  }
  return "  local at=lapwing i\n"
         "  for ((i = " +
         first + "; i < " + last +
         "; i++)); do\n"
         "    case \"$at ${words[i]}\" in\n"
         "      " +
         commands +
         ") at=\"$at ${words[i]}\" ;;\n"
         "      " +
         valued +
         ") ((i++)) ;;\n"
         "    esac\n"
         "  done\n";
}

std::string bash_script(const CommandEntry& tree) {
  std::string text =
      "# Completion of lapwing for bash: source <(lapwing completion bash)\n"
      "_lapwing_files() {\n"
      "  compopt -o filenames 2>/dev/null\n"
      "  mapfile -t COMPREPLY < <(compgen \"$1\" -- \"$2\")\n"
      "}\n"
      "_lapwing() {\n"
      "  local words=(\"${COMP_WORDS[@]}\") cur=${COMP_WORDS[COMP_CWORD]} offered=\n"
      "  COMPREPLY=()\n" +
      walk_of_words(tree, "1", "COMP_CWORD") + "  case \"$at ${words[COMP_CWORD - 1]}\" in\n";
  for (const CommandEntry* command : every_command(tree))
    for (const CompletedValue& value : values_of(*command, tree)) {
      text += "    " + shell_quoted(value.pattern) + ") ";
      if (value.kind == ValueKind::files) text += "_lapwing_files -f \"$cur\"; ";
      if (value.kind == ValueKind::folders) text += "_lapwing_files -d \"$cur\"; ";
      if (value.kind == ValueKind::words)
        text += "mapfile -t COMPREPLY < <(compgen -W " + shell_quoted(joined(value.words, " ")) +
                " -- \"$cur\"); ";
      text += "return ;;\n";
    }
  text += "  esac\n  case \"$at\" in\n";
  for (const CommandEntry* command : every_command(tree)) {
    std::vector<std::string> options;
    for (const OptionEntry& option : options_of(*command, tree))
      options.insert(options.end(), option.names.begin(), option.names.end());
    text += "    " + shell_quoted(command->path) +
            ")\n      if [[ $cur == -* ]]; then offered=" + shell_quoted(joined(options, " ")) +
            "\n      else ";
    if (const ValueKind kind = files_after(*command); kind != ValueKind::none)
      text += std::string("_lapwing_files ") + (kind == ValueKind::files ? "-f" : "-d") +
              " \"$cur\"; return\n      fi ;;\n";
    else
      text +=
          "offered=" + shell_quoted(joined(words_after(*command, tree), " ")) + "\n      fi ;;\n";
  }
  return text +
         "  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$offered\" -- \"$cur\")\n"
         "}\n"
         "complete -F _lapwing lapwing\n";
}

// "name:what it does" for _describe.
std::string described(const std::string& name, const std::string& help) {
  std::string safe;
  for (const char c : name + ":" + help) safe += c == '\n' ? ' ' : c;
  return shell_quoted(safe);
}

std::string zsh_script(const CommandEntry& tree) {
  std::string text =
      "#compdef lapwing\n"
      "# Completion of lapwing for zsh: a file _lapwing in a folder of $fpath.\n"
      "_lapwing() {\n"
      "  local -a offered\n" +
      walk_of_words(tree, "2", "CURRENT") + "  case \"$at ${words[CURRENT-1]}\" in\n";
  for (const CommandEntry* command : every_command(tree))
    for (const CompletedValue& value : values_of(*command, tree)) {
      text += "    " + shell_quoted(value.pattern) + ") ";
      if (value.kind == ValueKind::files) text += "_files; ";
      if (value.kind == ValueKind::folders) text += "_files -/; ";
      if (value.kind == ValueKind::words) {
        text += "compadd --";
        for (const std::string& word : value.words) text += " " + shell_quoted(word);
        text += "; ";
      }
      text += "return ;;\n";
    }
  text += "  esac\n  case \"$at\" in\n";
  for (const CommandEntry* command : every_command(tree)) {
    text += "    " + shell_quoted(command->path) +
            ")\n      if [[ $words[CURRENT] == -* ]]; then offered=(";
    for (const OptionEntry& option : options_of(*command, tree))
      for (const std::string& name : option.names)
        text += "\n        " + described(name, option.help);
    text += ")\n      else ";
    if (const ValueKind kind = files_after(*command); kind != ValueKind::none) {
      text += kind == ValueKind::files ? "_files; return\n" : "_files -/; return\n";
    } else {
      text += "offered=(";
      const CommandEntry& from = command->path == "lapwing help" ? tree : *command;
      for (const std::string& word : words_after(*command, tree)) {
        std::string help = word;
        for (const CommandEntry& below : from.commands)
          if (below.name == word) help = below.summary;
        text += "\n        " + described(word, help);
      }
      text += ")\n";
    }
    text += "      fi ;;\n";
  }
  return text +
         "  esac\n"
         "  _describe -t lapwing lapwing offered\n"
         "}\n"
         "if [[ $funcstack[1] == _lapwing ]]; then _lapwing \"$@\"; else compdef _lapwing lapwing; "
         "fi\n";
}

std::string fish_quoted(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '\\' ? std::string("\\\\") : std::string(1, c);
  return shell_quoted(safe, "\\'");
}

std::string fish_options(const CommandEntry& command, const CommandEntry& tree,
                         const std::string& head) {
  std::string text;
  for (const OptionEntry& option : options_of(command, tree)) {
    text += head;
    for (const std::string& name : option.names)
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    switch (option.value.empty() ? ValueKind::none : kind_of_value(option.value)) {
      case ValueKind::files:
        text += " -r -F";
        break;
      case ValueKind::folders:
        text += " -x -a '(__fish_complete_directories)'";
        break;
      case ValueKind::words:
        text += " -x -a " + fish_quoted(joined(words_of_value(option.value), " "));
        break;
      case ValueKind::none:
        if (!option.value.empty()) text += " -x";
    }
    text += " -d " + fish_quoted(option.help) + "\n";
  }
  return text;
}

std::string fish_script(const CommandEntry& tree) {
  std::string commands, valued, text;
  for (const CommandEntry* command : every_command(tree)) {
    if (command != &tree) commands += " " + fish_quoted(command->path);
    for (const CompletedValue& value : values_of(*command, tree))
      valued += " " + fish_quoted(value.pattern);
  }
  text =
      "# Completion of lapwing for fish: a file lapwing.fish in ~/.config/fish/completions.\n"
      "function __lapwing_at\n"
      "  set -l at lapwing\n"
      "  set -l skipped no\n"
      "  for word in (commandline -opc)[2..-1]\n"
      "    if test $skipped = yes\n"
      "      set skipped no\n"
      "      continue\n"
      "    end\n"
      "    switch \"$at $word\"\n"
      "      case" +
      commands +
      "\n"
      "        set at \"$at $word\"\n"
      "      case" +
      valued +
      "\n"
      "        set skipped yes\n"
      "    end\n"
      "  end\n"
      "  test \"$at\" = \"$argv[1]\"\n"
      "end\n"
      "complete -c lapwing -f\n";
  for (const CommandEntry* command : every_command(tree)) {
    const std::string head =
        "complete -c lapwing -n " + fish_quoted("__lapwing_at \"" + command->path + "\"");
    const CommandEntry& from = command->path == "lapwing help" ? tree : *command;
    for (const std::string& word : words_after(*command, tree)) {
      std::string help;
      for (const CommandEntry& below : from.commands)
        if (below.name == word) help = " -d " + fish_quoted(below.summary);
      text += head + " -a " + fish_quoted(word) + help + "\n";
    }
    if (const ValueKind kind = files_after(*command); kind == ValueKind::files)
      text += head + " -F\n";
    else if (kind == ValueKind::folders)
      text += head + " -a '(__fish_complete_directories)'\n";
    text += fish_options(*command, tree, head);
  }
  return text;
}

}  // namespace

std::string completion_script(const CommandEntry& tree, const std::string& shell) {
  if (shell == "bash") return bash_script(tree);
  if (shell == "zsh") return zsh_script(tree);
  if (shell == "fish") return fish_script(tree);
  throw InputError("there is no completion for '" + shell + "'; expected bash, zsh or fish");
}

}  // namespace lapwing
