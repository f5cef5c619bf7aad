#pragma once

#include <cstddef>
#include <string>

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

}  // namespace veridyn::app
