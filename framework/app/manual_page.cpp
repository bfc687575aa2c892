// SPDX-License-Identifier: Apache-2.0
// The manual page: what the help says of every command, in roff.
#include <sstream>

#include "framework/app/command_reference.h"

namespace lapwing {

namespace {

std::string roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    line_begins = c == '\n';
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else if (c == '~')
      out += "\\(ti";
    else if (c == '^')
      out += "\\(ha";
    else
      out += c;
  }
  return out;
}

std::string usage_of(const CommandEntry& command) {
  std::string line = "\\fB" + roff(command.path) + "\\fR";
  for (const OptionEntry& option : command.options) {
    if (option.positional) {
      line += " \\fI" + roff(option.value) + "\\fR";
      continue;
    }
    if (option.names.back() == "--help") continue;
    std::string words = "\\fB" + roff(option.names.front()) + "\\fR";
    if (!option.value.empty()) words += " \\fI" + roff(option.value) + "\\fR";
    line += option.required ? " " + words : " [" + words + "]";
    if (option.repeatable) line += "...";
  }
  return line;
}

std::string options_as_roff(const CommandEntry& command) {
  std::string text;
  for (const OptionEntry& option : command.options) {
    if (option.names.back() == "--help") continue;
    text += ".TP\n";
    if (!option.positional)
      for (std::size_t i = 0; i < option.names.size(); ++i)
        text += (i > 0 ? ", \\fB" : "\\fB") + roff(option.names[i]) + "\\fR";
    if (!option.value.empty())
      text += (option.positional ? "\\fI" : " \\fI") + roff(option.value) + "\\fR";
    text += "\n" + roff(option.help) + "\n";
  }
  return text;
}

// The help's footer: paragraphs, of which indented lines are examples.
std::string footer_as_roff(const std::string& footer) {
  std::string text;
  bool examples = false;
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);) {
    const bool indented = line.starts_with("  ");
    if (indented != examples) text += indented ? ".PP\n.RS\n.nf\n" : ".fi\n.RE\n";
    examples = indented;
    if (line.empty()) continue;
    if (!indented) text += ".PP\n";
    text += roff(indented ? line.substr(2) : line) + "\n";
  }
  return text + (examples ? ".fi\n.RE\n" : "");
}

}  // namespace

std::string manual_page(const CommandEntry& tree, const std::string& version) {
  std::string text = ".TH LAPWING 1 \"\" \"lapwing " + roff(version) + "\" \"User Commands\"\n";
  text +=
      ".nh\n.ad l\n"
      ".SH NAME\nlapwing \\- plan flights for camera drones\n"
      ".SH SYNOPSIS\n\\fBlapwing\\fR \\fICOMMAND\\fR [\\fIOPTION\\fR]...\n"
      ".SH DESCRIPTION\n"
      "A mission script in Lua states the purpose of a flight.  Lapwing finds a smooth trajectory "
      "that\n"
      "the vehicle can fly, has it judged by an independent verifier, and writes a plan, a report\n"
      "and files for flight.\n"
      ".SH OPTIONS\nOptions of every command.\n" +
      options_as_roff(tree) + ".SH COMMANDS\n";
  for (const CommandEntry* command : every_command(tree)) {
    if (!command->commands.empty()) continue;
    text += ".SS " + roff(command->path) + "\n" + usage_of(*command) + "\n.PP\n" +
            roff(command->summary) + ".\n" + options_as_roff(*command) +
            footer_as_roff(command->footer);
  }
  text +=
      ".SH EXIT STATUS\n"
      ".TP\n0\ndone, and certified where there is something to certify\n"
      ".TP\n1\nfinished, but infeasible or not certified; of diff: the plans differ\n"
      ".TP\n2\nbad input: one message on standard error\n"
      ".TP\n3\ninternal error, or standard output that could not be written (a full disk)\n"
      ".TP\n130\ninterrupted\n"
      ".TP\n141\ndone, but standard output was a pipe that nobody read to its end, as head does\n"
      ".SH ENVIRONMENT\n"
      ".TP\n\\fBLAPWING_DATA\\fR\nfolders that scripts may read, joined by colons\n"
      ".TP\n\\fBLAPWING_PLUGIN_PATH\\fR\nfolders of plugins, joined by colons\n"
      ".TP\n\\fBLAPWING_HOME\\fR\nthe folder that holds configs and scripts\n"
      ".TP\n\\fBNO_COLOR\\fR\nif it is set and not empty, nothing is coloured unless "
      "\\fB\\-\\-color always\\fR asks for it\n"
      ".SH FILES\n"
      ".TP\n\\fIout/MISSION/plan.json\\fR\nthe plan; beside it report.html, trajectory.csv and "
      "run.log\n";
  return text;
}

}  // namespace lapwing
