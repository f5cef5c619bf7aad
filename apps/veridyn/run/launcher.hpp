#pragma once

#include <atomic>
#include <cstddef>
#include <string>
#include <thread>

#include "veridyn/core/interruption.hpp"
#include "veridyn/numerics/ranks/ranks.hpp"

namespace veridyn::app {

/// This process among those that mpirun or srun started together.
struct LaunchedProcess {
  std::size_t rank = 0;
  std::size_t size = 1;        ///< 1: started alone
  std::size_t on_machine = 1;  ///< of them on this machine
  std::string launcher = {};   ///< "mpirun", "srun"
};

/// From the environment: OMPI_COMM_WORLD_RANK and _SIZE (Open MPI), PMI_RANK and PMI_SIZE (MPICH, Intel MPI), or
/// SLURM_PROCID and SLURM_STEP_NUM_TASKS (srun; SLURM_NTASKS alone is set in a batch script too, where nobody started
/// the other processes).
/// @throws InputError naming a variable that makes no sense.
[[nodiscard]] LaunchedProcess launched_process();

/// Threads of this process so that all of them on this machine have one for each processor that they may use. At least
/// one.
[[nodiscard]] int threads_of(const LaunchedProcess& process);

/// Connects this process to those that were started with it, by MPI; nothing of MPI is loaded for one that is alone.
/// @throws InputError where the program has no MPI, or another one than the launcher
[[nodiscard]] numerics::Ranks connected_ranks(const LaunchedProcess& process, const Interruption& interruption);

/// Says at once, in the first of several processes, that the launcher ends them: it kills them a second after its
/// signal, which may be before the work has noticed. Launchers send the same signal after Ctrl-C and after the death of
/// a process, of which they say what they know themselves.
class LauncherNotice {
 public:
  LauncherNotice(const numerics::Ranks& ranks, std::string launcher, Interruption interruption);
  ~LauncherNotice();
  LauncherNotice(const LauncherNotice&) = delete;
  LauncherNotice& operator=(const LauncherNotice&) = delete;

 private:
  std::string text_;
  Interruption interruption_;
  std::atomic<bool> over_ = false;
  std::thread watch_;  ///< none in a process that does not talk
};

}  // namespace veridyn::app
