// veridyn: from recorded motion to a dynamic model you can trust. Human output goes to stderr, data to files or stdout.
#include <array>

#include "apps/veridyn/command_line.hpp"
#include "veridyn/core/interruption.hpp"

int main(int argc, char** argv) {
  using namespace veridyn::app;
  const std::array commands = {demo_command(),        init_command(),        inspect_command(),   simulate_command(),
                               reconstruct_command(), identify_command(),    track_command(),     validate_command(),
                               scale_command(),       sensitivity_command(), reproduce_command(), export_command(),
                               cue_command(),         rig_command(),         serve_command(),     camera_command(),
                               regress_command(),     compare_command()};
  const veridyn::Interruption interruption;
  veridyn::request_on_signals(interruption);
  return run_program(commands, interruption, argc, argv);
}
