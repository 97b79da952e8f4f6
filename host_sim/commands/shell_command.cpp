#include "host_sim/commands/shell_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "firmware/description/version.hpp"
#include "host_sim/commands/common/json_output.hpp"

namespace host_sim {
namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  return command.get_options([](const CLI::Option*) { return true; });
}

/// The function that bash calls: commands first, then the options of the command, then file names.
std::string bash_completion(const CLI::App& app) {
  std::string names, cases;
  for (const CLI::App* command : commands_of(app)) {
    names += (names.empty() ? "" : " ") + command->get_name();
    std::string options;
    for (const CLI::Option* option : options_of(*command)) {
      for (const std::string& name : option->get_lnames()) options += (options.empty() ? "--" : " --") + name;
    }
    cases += "    " + command->get_name() + ") words=\"" + options + "\" ;;\n";
  }
  return "# bash completion for rigtwin\n_rigtwin() {\n  local word=${COMP_WORDS[COMP_CWORD]} words=\"\"\n"
         "  COMPREPLY=()\n  if [ \"$COMP_CWORD\" -eq 1 ]; then\n    COMPREPLY=($(compgen -W \"" +
         names + " --help --version\" -- \"$word\"))\n    return\n  fi\n  case ${COMP_WORDS[1]} in\n" + cases +
         "  esac\n  case $word in\n    -*) COMPREPLY=($(compgen -W \"$words\" -- \"$word\")) ;;\n"
         "    *) COMPREPLY=($(compgen -f -- \"$word\")) ;;\n  esac\n}\ncomplete -o filenames -F _rigtwin rigtwin\n";
}

/// Text between single quotes of a shell: zsh and fish end a text at the next quote.
std::string shell_quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) safe += c == '\'' ? "'\\''" : std::string(1, c);
  return safe + "'";
}

/// Text of zsh's _arguments: a bracket would end an explanation, a colon begins the next part.
std::string zsh_text(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += (c == '[' || c == ']' || c == ':' || c == '\\' ? "\\" : "") + std::string(1, c);
  return safe;
}

/// The function that zsh calls: commands with their explanations, then the options of the command and file names.
std::string zsh_completion(const CLI::App& app) {
  std::string names, cases;
  for (const CLI::App* command : commands_of(app)) {
    names += "    " + shell_quoted(zsh_text(command->get_name()) + ":" + command->get_description()) + "\n";
    cases += "    " + command->get_name() + ") _arguments";
    for (const CLI::Option* option : options_of(*command)) {
      for (const std::string& name : option->get_lnames()) {
        cases += " \\\n      " + shell_quoted("--" + name + "[" + zsh_text(option->get_description()) + "]" +
                                              (option->get_type_size() == 0 ? "" : ":value:_files"));
      }
    }
    cases += " \\\n      '*:file:_files' ;;\n";
  }
  return "#compdef rigtwin\nlocal -a commands\nif (( CURRENT == 2 )); then\n  commands=(\n" + names +
         "  )\n  _describe command commands\nelse\n  local command=$words[2]\n  shift words\n  (( CURRENT-- ))\n"
         "  case $command in\n" +
         cases + "  esac\nfi\n";
}

/// What fish completes: commands while there is none, then the options of the command.
std::string fish_completion(const CLI::App& app) {
  std::string lines = "# fish completion for rigtwin\n";
  for (const CLI::App* command : commands_of(app)) {
    const std::string& name = command->get_name();
    lines += "complete -c rigtwin -f -n __fish_use_subcommand -a " + name + " -d " +
             shell_quoted(command->get_description()) + "\n";
    for (const CLI::Option* option : options_of(*command)) {
      for (const std::string& long_name : option->get_lnames()) {
        lines += "complete -c rigtwin -n '__fish_seen_subcommand_from " + name + "' -l " + long_name +
                 (option->get_type_size() == 0 ? "" : " -r") + " -d " + shell_quoted(option->get_description()) + "\n";
      }
    }
  }
  return lines;
}

/// Text as troff takes it: no command at the beginning of a line, hyphens that can be copied.
std::string troff(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\\') {
      safe += "\\e";
    } else if (c == '-') {
      safe += "\\-";
    } else {
      safe += c;
    }
  }
  return safe.starts_with('.') || safe.starts_with('\'') ? "\\&" + safe : safe;
}

/// The first steps, as the manual begins.
std::string examples() {
  struct Example {
    const char *words, *command;
  };
  constexpr Example all[] = {
      {"Begin a description, with comments", "rigtwin init --kind quarter_car --out rig.toml"},
      {"See a file of another program, and bring it in",
       "rigtwin import measured.tdms --rig rig.toml --out record.csv"},
      {"Compare a recording with the model, by channel and band", "rigtwin compare --rig rig.toml --data record.csv"},
      {"Find what the model lacks; found/report.html shows it",
       "rigtwin diagnose --rig rig.toml --data record.csv --out found"},
      {"Is a loop with hardware stable at its delay?", "rigtwin stability --rig found/rig.toml"},
      {"One minute of motorway through the simulated rig",
       "rigtwin simulate --rig rig.toml --road iso8608:B --duration 60 --out run.csv"},
  };
  std::string text = ".SH EXAMPLES\n";
  for (const Example& example : all) text += ".TP\n" + troff(example.words) + "\n.B " + troff(example.command) + "\n";
  return text;
}

std::string man_page(const CLI::App& app) {
  std::string page = ".TH RIGTWIN 1 \"\" \"rigtwin " + std::string(firmware::version) + "\" \"User commands\"\n" +
                     ".SH NAME\nrigtwin \\- one model of a suspension rig, on the rig's controller and on the PC\n" +
                     ".SH SYNOPSIS\n.B rigtwin\n.I command\n.RI [ options ]\n.SH DESCRIPTION\n" +
                     troff(app.get_description()) + ".\n.SH COMMANDS\n";
  for (const CLI::App* command : commands_of(app)) {
    page += ".SS rigtwin " + troff(command->get_name()) + "\n" + troff(command->get_description()) + ".\n";
    for (const CLI::Option* option : options_of(*command)) {
      if (option->get_lnames().empty()) continue;
      page += ".TP\n.B " + troff("--" + option->get_lnames().front()) +
              (option->get_type_size() == 0 ? "" : " \\fI" + troff(option->get_type_name()) + "\\fR") + "\n" +
              troff(option->get_description()) +
              (option->get_default_str().empty() ? "" : " (default: " + troff(option->get_default_str()) + ")") + "\n";
    }
  }
  return page + examples() +
         ".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n2\nwrong usage\n.TP\n3\nunreadable or unfit input: one line says file, "
         "line, "
         "what is wrong, what is expected\n.TP\n4\na result cannot be written\n.TP\n5\ninternal error\n.TP\n6\n"
         "the firmware stopped a simulated run before its end: one line says why, nothing is written\n"
         ".SH SEE ALSO\n.BR rig_controller (1)\n";
}

/// Every command with its options, for shells and programs that have no completion here.
nlohmann::ordered_json commands_json(const CLI::App& app) {
  nlohmann::ordered_json json{{"program", "rigtwin"}};
  for (const CLI::App* command : commands_of(app)) {
    nlohmann::ordered_json entry{{"name", command->get_name()}, {"description", command->get_description()}};
    entry["options"] = nlohmann::ordered_json::array();
    for (const CLI::Option* option : options_of(*command)) {
      entry["options"].push_back({{"name", option->get_name()},
                                  {"description", option->get_description()},
                                  {"value", option->get_type_size() == 0 ? "" : option->get_type_name()},
                                  {"default", option->get_default_str()},
                                  {"required", option->get_required()}});
    }
    json["commands"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace

void add_shell(CLI::App& app, ShellOptions& options) {
  const auto add = [&](const char* name, const char* description, const std::function<std::string()>& text) {
    CLI::App* command = app.add_subcommand(name, description);
    add_json_option(*command, options.json, "the commands and their options");
    command->callback([&app, &options, text] {
      if (!write_json(options.json, options.json.empty() ? nlohmann::ordered_json() : commands_json(app))) {
        std::fputs(text().c_str(), stdout);
      }
    });
    return command;
  };
  CLI::App* const completion =
      add("completion", "Print the completion for a shell: source <(rigtwin completion bash)", [&app, &options] {
        if (options.shell == "zsh") return zsh_completion(app);
        return options.shell == "fish" ? fish_completion(app) : bash_completion(app);
      });
  completion->add_option("shell", options.shell, "bash, zsh or fish")->check(CLI::IsMember({"bash", "zsh", "fish"}));
  add("manpage", "Print the manual page rigtwin(1): rigtwin manpage | man -l -", [&app] { return man_page(app); });
}

}  // namespace host_sim
