#include "apps/veridyn/launcher.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <thread>

#include "veridyn/core/error.hpp"

namespace veridyn::app {
namespace {

/// The whole number with which the variable begins: SLURM_STEP_TASKS_PER_NODE is "2(x3),1".
std::optional<std::size_t> number_in(const char* variable) {
  const char* text = std::getenv(variable);
  if (text == nullptr || *text == '\0') return std::nullopt;
  const std::string_view digits = text;
  std::size_t value = 0;
  if (std::from_chars(digits.data(), digits.data() + digits.size(), value).ec != std::errc())
    throw InputError(variable, fmt::format("is '{}'; expected a whole number from the launcher", digits));
  return value;
}

/// How a launcher tells a process who it is.
struct LauncherVariables {
  const char* name;
  const char* rank;
  const char* size;
  const char* on_machine;
};
constexpr LauncherVariables kLaunchers[] = {
    {"mpirun", "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_LOCAL_SIZE"},
    {"mpirun", "PMI_RANK", "PMI_SIZE", "MPI_LOCALNRANKS"},
    {"srun", "SLURM_PROCID", "SLURM_STEP_NUM_TASKS", "SLURM_STEP_TASKS_PER_NODE"}};

}  // namespace

LaunchedProcess launched_process() {
  for (const LauncherVariables& l : kLaunchers) {
    const std::optional<std::size_t> rank = number_in(l.rank), size = number_in(l.size);
    if (!rank || !size) continue;
    if (*rank >= *size) throw InputError(l.rank, fmt::format("is {}; must be below {} = {}", *rank, l.size, *size));
    return {.rank = *rank,
            .size = *size,
            .on_machine = std::clamp<std::size_t>(number_in(l.on_machine).value_or(1), 1, *size),
            .launcher = l.name};
  }
  return {};
}

int threads_of(const LaunchedProcess& process) {
  // Launchers bind processes to processors, of which the number that the machine has says nothing.
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  const std::size_t machine = number_in("SLURM_CPUS_ON_NODE").value_or(std::thread::hardware_concurrency());
  std::size_t threads = std::max<std::size_t>(1, machine / process.on_machine);
  if (::sched_getaffinity(0, sizeof allowed, &allowed) == 0)
    threads = std::min(threads, std::max<std::size_t>(1, static_cast<std::size_t>(CPU_COUNT(&allowed))));
  return static_cast<int>(threads);
}

}  // namespace veridyn::app
