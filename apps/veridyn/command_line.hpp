#pragma once

#include <span>

#include "apps/veridyn/run/command.hpp"

namespace veridyn::app {

/// Parses the command line, runs the chosen command and reports how it ended, one line on stderr where it failed. The
/// command stops when `interruption` is requested.
/// @returns the exit code: 0 done, 1 failed or interrupted, 2 wrong input.
[[nodiscard]] int run_program(std::span<const Command> commands, const Interruption& interruption, int argc,
                              const char* const* argv);

}  // namespace veridyn::app
