#pragma once

#include <string>
#include <string_view>

#include "apps/veridyn/run/command.hpp"
#include "apps/veridyn/run/summary.hpp"
#include "veridyn/core/progress.hpp"

namespace veridyn::app {

/// A line for people on stderr, unless quiet. A stderr that takes nothing is no error: what a line says is in the
/// results too.
void print_line(const CommonOptions& options, const std::string& line);

/// A reader of our lines or packets that goes away is no reason to end: SIGPIPE is ignored from here on.
void ignore_broken_pipes();

/// The progress of a command with these options.
[[nodiscard]] TerminalProgress progress_of(const CommonOptions& options);

/// Text on stdout, flushed. @throws std::runtime_error when it cannot be written.
void print_text(std::string_view text);

/// The summary on stdout when `--json` was given. @throws std::runtime_error when it cannot be written.
void print_summary(const Summary& summary, const CommonOptions& options);

}  // namespace veridyn::app
