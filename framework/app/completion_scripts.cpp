// SPDX-License-Identifier: Apache-2.0
// Completion for bash, zsh and fish. All three walk the typed words from command to command, skip
// options and their values, and offer what may come next; the tables are the declared commands.
// Names of plugins, configurations and the like are asked of the program that is typed.
#include <algorithm>

#include "framework/app/command_reference.h"
#include "framework/app/completion_names.h"
#include "framework/core/error.h"

namespace lapwing {

namespace {

// What may stand at one place.
struct Offer {
  ValueKind kind = ValueKind::none;
  std::vector<std::string> words;
  std::string names;  // a list that `lapwing complete` prints; empty: none
};

struct CompletedValue {
  std::string pattern;  // "lapwing run --out"
  Offer offer;
};

Offer offer_of(const OptionEntry& option) {
  Offer offer{kind_of_value(option.value), {}, option.names_list};
  if (offer.kind == ValueKind::words) offer.words = words_of_value(option.value);
  if (!offer.names.empty()) offer.kind = option.or_files ? ValueKind::files : ValueKind::none;
  return offer;
}

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
        values.push_back({command.path + " " + name, offer_of(option)});
  return values;
}

// What stands after a command without an option before it: commands below, and what its positionals
// may be.
Offer offer_after(const CommandEntry& command, const CommandEntry& tree) {
  Offer all;
  const CommandEntry& offered = command.path == "lapwing help" ? tree : command;
  for (const CommandEntry& below : offered.commands) all.words.push_back(below.name);
  for (const OptionEntry& option : command.options) {
    if (!option.positional) continue;
    const Offer one = offer_of(option);
    all.words.insert(all.words.end(), one.words.begin(), one.words.end());
    if (all.names.empty()) all.names = one.names;
    const bool files = one.kind == ValueKind::files;
    if (files || (one.kind == ValueKind::folders && all.kind == ValueKind::none))
      all.kind = one.kind;
  }
  return all;
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

// A statement of bash that fills COMPREPLY.
std::string bash_offer(const Offer& offer) {
  if (offer.names == kSettings) return "_lapwing_settings; ";
  std::string text;
  if (!offer.words.empty())
    text += "_lapwing_words " + shell_quoted(joined(offer.words, " ")) + "; ";
  if (!offer.names.empty()) text += "_lapwing_words \"$(_lapwing_names " + offer.names + ")\"; ";
  if (offer.kind == ValueKind::files) text += "_lapwing_files -f; ";
  if (offer.kind == ValueKind::folders) text += "_lapwing_files -d; ";
  return text;
}

std::string bash_script(const CommandEntry& tree) {
  std::string text =
      "# Completion of lapwing for bash: source <(lapwing completion bash)\n"
      "_lapwing_words() {\n"
      "  mapfile -t -O \"${#COMPREPLY[@]}\" COMPREPLY < <(compgen -W \"$1\" -- \"$cur\")\n"
      "}\n"
      "_lapwing_names() {\n"
      "  \"${COMP_WORDS[0]}\" complete \"$1\" 2>/dev/null\n"
      "}\n"
      "_lapwing_settings() {\n"
      "  local word\n"
      "  for word in \"${words[@]}\"; do\n"
      "    [[ $word == *.lua ]] || continue\n"
      "    [[ $word == '~/'* ]] && word=$HOME/${word:2}\n"
      "    mapfile -t COMPREPLY < <(\"${COMP_WORDS[0]}\" complete setting \"$word\" \"$cur\" "
      "2>/dev/null)\n"
      "    [[ $cur == *=* ]] || compopt -o nospace 2>/dev/null\n"
      "    return\n"
      "  done\n"
      "}\n"
      "_lapwing_files() {\n"
      "  local before=${#COMPREPLY[@]}\n"
      "  mapfile -t -O \"$before\" COMPREPLY < <(compgen \"$1\" -- \"$cur\")\n"
      "  ((before == 0)) && compopt -o filenames 2>/dev/null\n"
      "}\n"
      // Bash takes '=' and ':' for ends of words: what stands together is put together again.
      "_lapwing_join() {\n"
      "  local i piece line=$COMP_LINE\n"
      "  words=()\n"
      "  for ((i = 0; i <= COMP_CWORD; i++)); do\n"
      "    piece=${COMP_WORDS[i]}\n"
      "    if [[ -z $COMP_LINE || $line == [[:space:]]* ]] || ((i == 0)); then\n"
      "      words+=(\"$piece\")\n"
      "    else\n"
      "      words[${#words[@]}-1]+=$piece\n"
      "    fi\n"
      "    line=${line#\"${line%%[![:space:]]*}\"}\n"
      "    line=${line#\"$piece\"}\n"
      "  done\n"
      "}\n"
      // The offers in the form that bash puts in place of the last piece.
      "_lapwing_cut() {\n"
      "  local i piece=${COMP_WORDS[COMP_CWORD]} before= after=\n"
      "  [[ $piece == *[!=:]* ]] || piece=\n"
      "  if [[ $piece == *\"$cur\" ]]; then before=${piece%\"$cur\"}; else "
      "after=${cur%\"$piece\"}; fi\n"
      "  for i in \"${!COMPREPLY[@]}\"; do\n"
      "    COMPREPLY[i]=$before${COMPREPLY[i]#\"$after\"}\n"
      "  done\n"
      "}\n"
      "_lapwing() {\n"
      "  local words cur prev\n"
      "  COMPREPLY=()\n"
      "  _lapwing_join\n"
      "  cur=${words[-1]} prev=${words[-2]}\n"
      "  if [[ $cur == --*=* ]]; then prev=${cur%%=*} cur=${cur#*=}; fi\n"
      "  _lapwing_offer\n"
      "  ((${#COMPREPLY[@]})) && _lapwing_cut\n"
      "}\n"
      "_lapwing_offer() {\n" +
      walk_of_words(tree, "1", "${#words[@]} - 1") + "  case \"$at $prev\" in\n";
  for (const CommandEntry* command : every_command(tree))
    for (const CompletedValue& value : values_of(*command, tree))
      text += "    " + shell_quoted(value.pattern) + ") " + bash_offer(value.offer) + "return ;;\n";
  text += "  esac\n  case \"$at\" in\n";
  for (const CommandEntry* command : every_command(tree)) {
    std::vector<std::string> options;
    for (const OptionEntry& option : options_of(*command, tree))
      options.insert(options.end(), option.names.begin(), option.names.end());
    text += "    " + shell_quoted(command->path) + ")\n      if [[ $cur == -* ]]; then " +
            bash_offer({ValueKind::none, options, ""}) + "\n      else " +
            bash_offer(offer_after(*command, tree)) + ":\n      fi ;;\n";
  }
  return text +
         "  esac\n"
         "}\n"
         "complete -F _lapwing lapwing\n";
}

// "name:what it does" for _describe.
std::string described(const std::string& name, const std::string& help) {
  std::string safe;
  for (const char c : name + ":" + help) safe += c == '\n' ? ' ' : c;
  return shell_quoted(safe);
}

// Statements of zsh that offer names and files; words have descriptions where they are commands.
std::string zsh_offer(const Offer& offer) {
  if (offer.names == kSettings) return "_lapwing_settings; ";
  std::string text;
  if (!offer.names.empty())
    text += "compadd -- ${(f)\"$(${(Q)words[1]} complete " + offer.names + " 2>/dev/null)\"}; ";
  if (offer.kind == ValueKind::files) text += "_files; ";
  if (offer.kind == ValueKind::folders) text += "_files -/; ";
  return text;
}

std::string zsh_script(const CommandEntry& tree) {
  std::string text =
      "#compdef lapwing\n"
      "# Completion of lapwing for zsh: a file _lapwing in a folder of $fpath.\n"
      "_lapwing_settings() {\n"
      "  local script=${${(M)words:#*.lua}[1]} end=' '\n"
      "  [[ -n $script ]] || return\n"
      "  local -a found=(${(f)\"$(${(Q)words[1]} complete setting ${(Q)~script} \"$cur\" "
      "2>/dev/null)\"})\n"
      "  [[ $cur == *=* ]] || end=\n"
      "  compadd -S \"$end\" -- $found\n"
      "}\n"
      "_lapwing() {\n"
      "  local -a offered\n"
      "  local cur=${words[CURRENT]} prev=${words[CURRENT-1]}\n"
      "  if [[ $cur == --*=* ]]; then\n"
      "    prev=${cur%%=*} cur=${cur#*=}\n"
      "    compset -P 1 '*='\n"
      "  fi\n" +
      walk_of_words(tree, "2", "CURRENT") + "  case \"$at $prev\" in\n";
  for (const CommandEntry* command : every_command(tree))
    for (const CompletedValue& value : values_of(*command, tree)) {
      text += "    " + shell_quoted(value.pattern) + ") ";
      if (!value.offer.words.empty()) {
        text += "compadd --";
        for (const std::string& word : value.offer.words) text += " " + shell_quoted(word);
        text += "; ";
      }
      text += zsh_offer(value.offer) + "return ;;\n";
    }
  text += "  esac\n  case \"$at\" in\n";
  for (const CommandEntry* command : every_command(tree)) {
    text += "    " + shell_quoted(command->path) +
            ")\n      if [[ $words[CURRENT] == -* ]]; then offered=(";
    for (const OptionEntry& option : options_of(*command, tree))
      for (const std::string& name : option.names)
        text += "\n        " + described(name, option.help);
    const Offer after = offer_after(*command, tree);
    text += ")\n      else " + zsh_offer(after) + "offered=(";
    const CommandEntry& from = command->path == "lapwing help" ? tree : *command;
    for (const std::string& word : after.words) {
      std::string help = word;
      for (const CommandEntry& below : from.commands)
        if (below.name == word) help = below.summary;
      text += "\n        " + described(word, help);
    }
    text += ")\n      fi ;;\n";
  }
  return text +
         "  esac\n"
         "  (( $#offered )) && _describe -t lapwing lapwing offered\n"
         "}\n"
         "if [[ $funcstack[1] == _lapwing ]]; then _lapwing \"$@\"; else compdef _lapwing lapwing; "
         "fi\n";
}

std::string fish_quoted(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '\\' ? std::string("\\\\") : std::string(1, c);
  return shell_quoted(safe, "\\'");
}

// The arguments of `complete` that offer it. Of an option: -x takes nothing else, -r -F files too.
std::string fish_offer(const Offer& offer, bool of_option) {
  std::string words = joined(offer.words, " ");
  if (offer.names == kSettings)
    words += "(__lapwing_settings)";
  else if (!offer.names.empty())
    words += (words.empty() ? "" : " ") + ("(__lapwing_names " + offer.names + ")");
  if (offer.kind == ValueKind::folders)
    words += (words.empty() ? "" : " ") + std::string("(__fish_complete_directories)");
  const bool files = offer.kind == ValueKind::files;
  const std::string how = files ? (of_option ? " -r -F" : " -F") : (of_option ? " -x" : "");
  return how + (words.empty() ? "" : " -a " + fish_quoted(words));
}

std::string fish_options(const CommandEntry& command, const CommandEntry& tree,
                         const std::string& head) {
  std::string text;
  for (const OptionEntry& option : options_of(command, tree)) {
    text += head;
    for (const std::string& name : option.names)
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!option.value.empty()) text += fish_offer(offer_of(option), true);
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
      "function __lapwing_names\n"
      "  set -l typed (commandline -opc)\n"
      "  command $typed[1] complete $argv[1] 2>/dev/null\n"
      "end\n"
      "function __lapwing_settings\n"
      "  set -l typed (commandline -opc)\n"
      "  set -l script (string match -- '*.lua' $typed)[1]\n"
      "  set script (string replace -r -- '^~/' \"$HOME/\" \"$script\")\n"
      "  set -l at (string replace -r -- '^--[^=]*=' '' (commandline -ct))\n"
      "  command $typed[1] complete setting \"$script\" \"$at\" 2>/dev/null\n"
      "end\n"
      "complete -c lapwing -f\n";
  for (const CommandEntry* command : every_command(tree)) {
    const std::string head =
        "complete -c lapwing -n " + fish_quoted("__lapwing_at \"" + command->path + "\"");
    const CommandEntry& from = command->path == "lapwing help" ? tree : *command;
    Offer after = offer_after(*command, tree);
    for (const std::string& word : after.words) {
      std::string help;
      for (const CommandEntry& below : from.commands)
        if (below.name == word) help = " -d " + fish_quoted(below.summary);
      text += head + " -a " + fish_quoted(word) + help + "\n";
    }
    after.words.clear();
    if (const std::string rest = fish_offer(after, false); !rest.empty())
      text += head + rest + "\n";
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
