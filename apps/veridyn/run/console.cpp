#include "apps/veridyn/run/console.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "veridyn/core/stderr_text.hpp"

namespace veridyn::app {

void print_line(const CommonOptions& options, const std::string& line) {
  if (!options.quiet) print_to_stderr(line + "\n");
}

void ignore_broken_pipes() { std::signal(SIGPIPE, SIG_IGN); }

TerminalProgress progress_of(const CommonOptions& options) {
  return TerminalProgress(options.quiet, options.threads, options.interruption);
}

void print_text(std::string_view text) {
  const std::size_t written = std::fwrite(text.data(), 1, text.size(), stdout);
  if (written == text.size() && std::fflush(stdout) == 0) return;
  throw std::runtime_error(fmt::format("stdout: cannot be written: {}", std::strerror(errno)));
}

void print_summary(const Summary& summary, const CommonOptions& options) {
  if (options.json) print_text(summary.to_json() + "\n");
}

}  // namespace veridyn::app
