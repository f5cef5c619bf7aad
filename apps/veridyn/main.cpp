// veridyn: from recorded motion to a dynamic model you can trust. Human output goes to stderr, data to files or stdout.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <new>

#include "apps/veridyn/options.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/progress.hpp"

int main(int argc, char** argv) {
  using namespace veridyn;
  CLI::App program("veridyn: from recorded motion to a dynamic model you can trust", "veridyn");
  program.set_version_flag("--version", std::string(VERIDYN_VERSION));
  program.require_subcommand(1);
  program.failure_message(CLI::FailureMessage::simple);
  int exit_code = app::kDone;
  app::add_demo(program, exit_code);
  app::add_init(program, exit_code);
  app::add_inspect(program, exit_code);
  app::add_simulate(program, exit_code);
  app::add_reconstruct(program, exit_code);
  app::add_identify(program, exit_code);
  app::add_track(program, exit_code);
  app::add_validate(program, exit_code);
  app::add_scale(program, exit_code);
  app::add_reproduce(program, exit_code);
  app::add_export(program, exit_code);
  TerminalProgress::watch_signals();
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? app::kDone : app::kWrongInput;
  } catch (const InputError& error) {
    fmt::print(stderr, "veridyn: {}\n", error.what());
    return app::kWrongInput;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "veridyn: out of memory\n");
    return app::kFailed;
  } catch (const std::exception& error) {
    fmt::print(stderr, "veridyn: {}\n", error.what());
    return app::kFailed;
  }
  return exit_code;
}
