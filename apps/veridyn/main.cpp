// veridyn: from recorded motion to a dynamic model you can trust. Human output goes to stderr, data to files or stdout.
#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

#ifdef VERIDYN_HAS_GLOG
#include <glog/logging.h>
#endif

#include <array>

#include "apps/veridyn/command_line.hpp"
#include "veridyn/core/interruption.hpp"

namespace {

/// Signals of hours are freed and wanted again all the time: to have the system take their pages back and give others,
/// zeroed, took a fifth of the time.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kLargest = 32 << 20, kKept = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, kLargest);
  mallopt(M_TRIM_THRESHOLD, kKept);
#endif
}

/// Ceres logs of a trial that diverges, of which results have the message, in words of its own.
void keep_ceres_quiet() {
#ifdef VERIDYN_HAS_GLOG
  FLAGS_minloglevel = google::GLOG_FATAL;
#endif
}

}  // namespace

int main(int argc, char** argv) {
  using namespace veridyn::app;
  keep_freed_memory();
  keep_ceres_quiet();
  const std::array commands = {demo_command(),        init_command(),        inspect_command(),   simulate_command(),
                               reconstruct_command(), identify_command(),    track_command(),     validate_command(),
                               scale_command(),       sensitivity_command(), reproduce_command(), export_command(),
                               cue_command(),         rig_command(),         serve_command(),     camera_command(),
                               regress_command(),     compare_command(),     checks_command(),    keys_command(),
                               priors_command()};
  const veridyn::Interruption interruption;
  veridyn::request_on_signals(interruption);
  return run_program(commands, interruption, argc, argv);
}
