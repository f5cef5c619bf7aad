// The command line, by CLI11. No other file of the program includes it: it takes three seconds to compile.
#include "apps/veridyn/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>
#include <new>

#include "apps/veridyn/console.hpp"
#include "apps/veridyn/version.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/progress.hpp"

namespace veridyn::app {
namespace {

/// The command that was chosen, with its arguments.
struct Chosen {
  const Command* command = nullptr;
  std::shared_ptr<Arguments> arguments;
};

void add_argument(CLI::App& app, const Argument& argument, Arguments& arguments) {
  ArgumentValue& value = arguments.own.emplace(argument.name, argument.value).first->second;
  CLI::Option* option = nullptr;
  if (auto* flag = std::get_if<bool>(&value)) {
    app.add_flag(argument.name, *flag, argument.help);
    return;
  }
  if (auto* number = std::get_if<double>(&value)) {
    option = app.add_option(argument.name, *number, argument.help)->capture_default_str();
    if (argument.positive) option->check(CLI::PositiveNumber);
  } else if (auto* texts = std::get_if<std::vector<std::string>>(&value)) {
    option = app.add_option(argument.name, *texts, argument.help);
  } else {
    auto& text = std::get<std::string>(value);
    option = app.add_option(argument.name, text, argument.help);
    if (argument.folder) option->check(CLI::ExistingDirectory);
    if (!argument.choices.empty()) option->check(CLI::IsMember(argument.choices));
    if (!text.empty()) option->capture_default_str();
  }
  if (!argument.type.empty()) option->type_name(argument.type);
  if (argument.required) option->required();
}

void add_common(CLI::App& app, CommonOptions& options, const Command& command) {
  options.out = command.default_out;
  app.add_option("--out", options.out, "folder of the results")->capture_default_str()->type_name("DIR");
  app.add_option("--set", options.overrides, "override one key of the study: --set data.from=120 (repeatable)")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  app.add_option("--seed", options.seed, "seed of all random numbers (key `seed` of the study)")->type_name("N");
  app.add_option("--threads", options.threads, "threads to use; 0: all. Results do not depend on it")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  app.add_flag("--quiet", options.quiet, "no progress, only errors");
  app.add_flag("--json", options.json, "a machine-readable summary on stdout");
  app.footer("Example:\n  " + command.example);
}

void add_command(CLI::App& parent, const Command& command, Chosen& chosen) {
  CLI::App* app = parent.add_subcommand(command.name, command.summary);
  if (!command.commands.empty()) {
    app->require_subcommand(1);
    for (const Command& part : command.commands) add_command(*app, part, chosen);
    return;
  }
  auto arguments = std::make_shared<Arguments>();
  for (const Argument& argument : command.arguments) add_argument(*app, argument, *arguments);
  add_common(*app, arguments->common, command);
  app->callback([&command, arguments, &chosen] { chosen = {&command, arguments}; });
}

/// Refuses a missing or unknown command, naming those that there are. `before`: the words read already.
void check_command(std::span<const Command> commands, std::span<const char* const> words, const std::string& before) {
  const std::string word = words.empty() ? "" : words.front();
  if (word == "--help" || word == "-h" || word == "--version") return;
  std::vector<std::string> names;
  for (const Command& command : commands) {
    if (command.name == word) {
      if (!command.commands.empty()) check_command(command.commands, words.subspan(1), before + word + " ");
      return;
    }
    names.push_back(command.name);
  }
  if (word.empty())
    throw InputError(before.empty() ? "command line" : before.substr(0, before.size() - 1),
                     fmt::format("a command is missing{}", suggestion("", names)));
  if (word.starts_with("-"))
    throw InputError(before + word, "is no option here; options of a command stand after its name");
  throw InputError(before + word, fmt::format("there is no such command{}", suggestion(word, names)));
}

int fail(const std::string& message, int exit_code) {
  // Work that a signal stopped may end in an error of its own, which says nothing about the input.
  const bool interrupted = TerminalProgress(true).interrupted();
  fmt::print(stderr, "veridyn: {}\n", interrupted ? Interrupted().what() : message);
  return interrupted ? kFailed : exit_code;
}

int parse_and_run(std::span<const Command> commands, int argc, const char* const* argv) {
  CLI::App program("veridyn: from recorded motion to a dynamic model you can trust", "veridyn");
  program.set_version_flag("--version", std::string(version()));
  program.require_subcommand(1);
  program.failure_message(CLI::FailureMessage::simple);
  Chosen chosen;
  for (const Command& command : commands) add_command(program, command, chosen);
  check_command(commands, {argv + 1, argv + std::max(1, argc)}, "");
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = program.exit(error);
    if (!std::cout.flush()) throw std::runtime_error("stdout: cannot be written");
    return code == 0 ? kDone : kWrongInput;
  }
  const int exit_code = chosen.command->run(*chosen.arguments);
  print_text("");  // what is still in the buffer
  return exit_code;
}

}  // namespace

int run_program(std::span<const Command> commands, int argc, const char* const* argv) {
  TerminalProgress::watch_signals();
  // A file beyond the shell's limit of size is an error like a full disk, not the end of the program.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return parse_and_run(commands, argc, argv);
  } catch (const InputError& error) {
    return fail(error.what(), kWrongInput);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", kFailed);
  } catch (const std::exception& error) {
    return fail(error.what(), kFailed);
  }
}

}  // namespace veridyn::app
