#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "veridyn/core/interruption.hpp"
#include "veridyn/numerics/ranks/ranks.hpp"

namespace veridyn::app {

inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;      ///< the computation failed or was interrupted: message or result say why
inline constexpr int kWrongInput = 2;  ///< the input is wrong: the message says where

/// Thrown by a command that a signal stopped, before it wrote anything.
class Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "interrupted, nothing was written"; }
};

/// The options that every command takes, and the user's request to end it.
struct CommonOptions {
  std::string out;                     ///< --out: folder of the results
  std::vector<std::string> overrides;  ///< --set key=value
  std::optional<std::uint64_t> seed;   ///< --seed
  int threads = 0;                     ///< --threads; 0: as many as there are
  bool quiet = false;                  ///< --quiet
  bool json = false;                   ///< --json: a machine-readable summary on stdout
  Interruption interruption;           ///< Ctrl-C
  numerics::Ranks ranks;               ///< the processes that a launcher started together; only the first talks
};

/// A text, a repeatable text, a number or a flag.
using ArgumentValue = std::variant<std::string, std::vector<std::string>, double, bool>;

/// An argument of one command: positional where its name has no dashes ("STUDY"), else an option ("--format").
struct Argument {
  std::string name;
  std::string help;
  ArgumentValue value = std::string();  ///< kind and default; a default text or number is shown by --help
  std::string type = {};                ///< what --help calls the value: "FILE"; empty: by its kind
  bool required = false;
  bool positive = false;                  ///< a number that must be > 0
  bool folder = false;                    ///< a text that must name an existing folder
  std::vector<std::string> choices = {};  ///< a text that must be one of these; none: any
  std::string old_name = {};              ///< of an option that earlier versions called so; still taken, with a note
};

/// What the user gave a command: the common options, and a value for each of its arguments.
struct Arguments {
  CommonOptions common;
  std::map<std::string, ArgumentValue, std::less<>> values;

  /// The value of the argument of this name; the command must have one of this name and kind.
  [[nodiscard]] const std::string& text(std::string_view name) const { return std::get<std::string>(at(name)); }
  [[nodiscard]] const std::vector<std::string>& texts(std::string_view name) const {
    return std::get<std::vector<std::string>>(at(name));
  }
  [[nodiscard]] double number(std::string_view name) const { return std::get<double>(at(name)); }
  [[nodiscard]] bool flag(std::string_view name) const { return std::get<bool>(at(name)); }
  /// Whether the command has a text or flag of this name and the user gave it: `demo` runs what other commands do
  /// without having their options.
  [[nodiscard]] bool given(std::string_view name) const {
    const auto found = values.find(name);
    if (found == values.end()) return false;
    const auto* const flag = std::get_if<bool>(&found->second);
    return flag != nullptr ? *flag : !std::get<std::string>(found->second).empty();
  }

 private:
  [[nodiscard]] const ArgumentValue& at(std::string_view name) const { return values.at(std::string(name)); }
};

/// A command of the program: what --help says of it, what it takes and what it does.
struct Command {
  std::string name;
  std::string summary;  ///< one line, for the list of commands
  std::vector<Argument> arguments = {};
  std::string default_out = {};  ///< of --out
  std::string example = {};
  std::function<int(const Arguments&)> run = {};  ///< returns the exit code
  std::vector<Command> commands = {};             ///< `init aircraft`; a command with commands has no `run`
  bool shares_work = false;                       ///< several processes of a launcher may run it together
};

// Each command is made in the file of its name.
[[nodiscard]] Command camera_command();
[[nodiscard]] Command compare_command();
[[nodiscard]] Command checks_command();
[[nodiscard]] Command cue_command();
[[nodiscard]] Command demo_command();
[[nodiscard]] Command export_command();
[[nodiscard]] Command identify_command();
[[nodiscard]] Command init_command();
[[nodiscard]] Command inspect_command();
[[nodiscard]] Command keys_command();
[[nodiscard]] Command priors_command();
[[nodiscard]] Command reconstruct_command();
[[nodiscard]] Command regress_command();
[[nodiscard]] Command reproduce_command();
[[nodiscard]] Command rig_command();
[[nodiscard]] Command scale_command();
[[nodiscard]] Command sensitivity_command();
[[nodiscard]] Command serve_command();
[[nodiscard]] Command simulate_command();
[[nodiscard]] Command track_command();
[[nodiscard]] Command validate_command();

}  // namespace veridyn::app
