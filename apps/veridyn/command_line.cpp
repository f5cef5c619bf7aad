// The command line, by CLI11. No other file of the program includes it: it takes three seconds to compile.
#include "apps/veridyn/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <csignal>
#include <functional>
#include <iostream>
#include <limits>
#include <new>
#include <optional>

#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/launcher.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/stderr_text.hpp"

namespace veridyn::app {
namespace {

constexpr int kMostThreads = 1024;

/// The command that was chosen, with its arguments.
struct Chosen {
  const Command* command = nullptr;
  std::shared_ptr<Arguments> arguments;
};

/// The number that the whole text is.
template <typename Number>
std::optional<Number> parsed(const std::string& text) {
  Number value{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && stop == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// A whole number from 0 to `most`. CLI11 would take "-3" for a large one.
CLI::Validator whole_number(std::int64_t most) {
  return {[most](const std::string& text) {
            const auto value = parsed<std::int64_t>(text);
            return value && *value >= 0 && *value <= most
                       ? std::string()
                       : fmt::format("is {}; must be a whole number from 0 to {}", text, most);
          },
          ""};
}

CLI::Validator positive_number() {
  return {[](const std::string& text) {
            const auto value = parsed<double>(text);
            return value && *value > 0.0 && std::isfinite(*value) ? std::string()
                                                                  : fmt::format("is {}; must be a number > 0", text);
          },
          ""};
}

CLI::Validator one_of(const std::vector<std::string>& choices) {
  return {[choices](const std::string& text) {
            return std::find(choices.begin(), choices.end(), text) != choices.end()
                       ? std::string()
                       : fmt::format("is '{}'; must be one of {}", text, fmt::join(choices, ", "));
          },
          fmt::format("{{{}}}", fmt::join(choices, ","))};
}

void add_argument(CLI::App& app, const Argument& argument, Arguments& arguments) {
  ArgumentValue& value = arguments.values.emplace(argument.name, argument.value).first->second;
  CLI::Option* option = nullptr;
  if (auto* flag = std::get_if<bool>(&value)) {
    app.add_flag(argument.name, *flag, argument.help);
    return;
  }
  if (auto* number = std::get_if<double>(&value)) {
    option = app.add_option(argument.name, *number, argument.help)->capture_default_str();
    if (argument.positive) option->check(positive_number());
  } else if (auto* texts = std::get_if<std::vector<std::string>>(&value)) {
    option = app.add_option(argument.name, *texts, argument.help);
  } else {
    auto& text = std::get<std::string>(value);
    option = app.add_option(argument.name, text, argument.help);
    if (argument.folder) option->check(CLI::ExistingDirectory);
    if (!argument.choices.empty()) option->check(one_of(argument.choices));
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
  app.add_option("--seed", options.seed, "seed of all random numbers (key `seed` of the study)")
      ->check(whole_number(std::numeric_limits<std::int64_t>::max()))
      ->type_name("N");
  app.add_option("--threads", options.threads, "threads to use; 0: all. Results do not depend on it")
      ->capture_default_str()
      ->check(whole_number(kMostThreads))
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

struct NamedCommand {
  const Command* command = nullptr;  ///< none: only help or the version is wanted
  std::string name;                  ///< "init aircraft"
};

/// The command that the words name. Refuses a missing or unknown one, naming those that there are. `before`: the words
/// read already.
NamedCommand find_command(std::span<const Command> commands, std::span<const std::string> words,
                          const std::string& before = "") {
  const std::string word = words.empty() ? "" : words.front();
  if (word == "--help" || word == "-h" || word == "--version") return {};
  std::vector<std::string> names;
  for (const Command& command : commands) {
    if (command.name == word) {
      if (command.commands.empty()) return {&command, before + word};
      return find_command(command.commands, words.subspan(1), before + word + " ");
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

/// Options of a command that earlier versions called otherwise get their names, with a note.
void rename_options(const Command& command, std::vector<std::string>& words, bool talks) {
  for (const Argument& argument : command.arguments) {
    if (argument.old_name.empty()) continue;
    for (std::string& word : words) {
      if (word != argument.old_name && !word.starts_with(argument.old_name + "=")) continue;
      word.replace(0, argument.old_name.size(), argument.name);
      if (talks) fmt::print(stderr, "note: {} is now called {}\n", argument.old_name, argument.name);
    }
  }
}

/// What is wrong with the arguments of a command, in one line.
std::string explained(const CLI::ParseError& error, const CLI::App& program, const NamedCommand& named) {
  const std::vector<std::string> extra = program.remaining(true);
  const bool unknown =
      dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && named.command != nullptr && !extra.empty();
  if (!unknown) return fmt::format("{} (`veridyn {} --help` says more)", error.what(), named.name);
  const std::string& word = extra.front();
  if (!word.starts_with("-")) return fmt::format("'{}' is one argument too many", word);
  std::vector<std::string> names = {"--out", "--set", "--seed", "--threads", "--quiet", "--json", "--help"};
  for (const Argument& argument : named.command->arguments) {
    if (argument.name.starts_with("-")) names.push_back(argument.name);
  }
  return fmt::format("there is no option {}{}", word, suggestion(word, names));
}

/// The options of a command as one of several processes has them: only the first talks.
void set_ranks(const numerics::Ranks& ranks, const Command& command, CommonOptions& options) {
  options.ranks = ranks;
  if (!ranks.alone() && !command.shares_work)
    throw InputError(command.name, fmt::format("runs in one process, {} were started", ranks.size()));
  if (ranks.first()) return;
  options.quiet = true;
  options.json = false;
}

int parse_and_run(std::span<const Command> commands, const Interruption& interruption, const numerics::Ranks& ranks,
                  std::vector<std::string> words) {
  CLI::App program("veridyn: from recorded motion to a dynamic model you can trust", "veridyn");
  program.set_version_flag("--version", std::string(version()));
  program.require_subcommand(1);
  Chosen chosen;
  for (const Command& command : commands) add_command(program, command, chosen);
  const NamedCommand named = find_command(commands, words);
  if (named.command != nullptr) rename_options(*named.command, words, ranks.first());
  try {
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    program.parse(words);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0)
      throw InputError(named.name.empty() ? "command line" : named.name, explained(error, program, named));
    if (!ranks.first()) return kDone;
    program.exit(error);
    if (!std::cout.flush()) throw std::runtime_error("stdout: cannot be written");
    return kDone;
  }
  chosen.arguments->common.interruption = interruption;
  set_ranks(ranks, *chosen.command, chosen.arguments->common);
  const int exit_code = chosen.command->run(*chosen.arguments);
  print_text("");  // what is still in the buffer
  return exit_code;
}

/// How work ended, exceptions in words.
numerics::RankEnding ending_of(const std::function<int()>& work, const Interruption& interruption) {
  numerics::RankEnding end;
  try {
    end.exit_code = work();
    return end;
  } catch (const InputError& error) {
    end = {kWrongInput, error.what()};
  } catch (const std::bad_alloc&) {
    end = {kFailed, "out of memory"};
  } catch (const std::exception& error) {
    end = {kFailed, error.what()};
  }
  // Work that a signal stopped may end in an error that says nothing about the input.
  if (interruption.requested()) end = {kFailed, Interrupted().what()};
  return end;
}

/// The same of all processes, where there are several.
numerics::RankEnding ending_of_all(const numerics::Ranks& ranks, numerics::RankEnding own,
                                   const Interruption& interruption) {
  if (ranks.alone()) return own;
  if (!interruption.requested()) {
    const numerics::RankEnding failed = ending_of(
        [&] {
          own = ranks.finish(own);
          return kDone;
        },
        interruption);
    if (failed.exit_code != kDone) own = failed;
  }
  // The others are being ended too, and answer no more; `LauncherNotice` says so.
  if (interruption.requested()) own = {kFailed, ""};
  return own;
}

}  // namespace

int run_program(std::span<const Command> commands, const Interruption& interruption, int argc,
                const char* const* argv) {
  // A file beyond the shell's limit of size is an error like a full disk, not the end of the program.
  std::signal(SIGXFSZ, SIG_IGN);
  LaunchedProcess process;
  numerics::Ranks ranks;
  numerics::RankEnding end = ending_of(
      [&] {
        process = launched_process();
        ranks = connected_ranks(process, interruption);
        return kDone;
      },
      interruption);
  if (end.exit_code == kDone) {
    const LauncherNotice notice(ranks, process.launcher, interruption);
    const std::vector<std::string> words(argv + 1, argv + std::max(1, argc));
    end = ending_of([&] { return parse_and_run(commands, interruption, ranks, words); }, interruption);
    end = ending_of_all(ranks, std::move(end), interruption);
  }
  // Of several processes the first says how all ended.
  if (process.rank > 0) return interruption.requested() ? kFailed : kDone;
  if (!end.text.empty()) print_to_stderr(fmt::format("veridyn: {}\n", end.text));
  return end.exit_code;
}

}  // namespace veridyn::app
