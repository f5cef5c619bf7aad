#include "apps/veridyn/run/launcher.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/stderr_text.hpp"
#include "veridyn/numerics/ranks/mpi_library.hpp"

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

numerics::Ranks connected_ranks(const LaunchedProcess& process, const Interruption& interruption) {
  if (process.size == 1) return {};
  const std::shared_ptr<numerics::RankTransport> transport = numerics::mpi_transport();
  if (transport->size() != process.size)
    throw InputError(process.launcher,
                     fmt::format("started {} processes, of which MPI here knows {}: it belongs to another MPI than the "
                                 "program (Open MPI), or was told nothing of it (srun --mpi=pmix)",
                                 process.size, transport->size()));
  return {transport, interruption};
}

LauncherNotice::LauncherNotice(const numerics::Ranks& ranks, std::string launcher, Interruption interruption)
    : text_(fmt::format("veridyn: {} ends the run of {} processes: it was interrupted, or one of them ended (it says "
                        "which); no results were written, what a checkpoint holds is whole\n",
                        launcher, ranks.size())),
      interruption_(std::move(interruption)) {
  if (ranks.alone() || !ranks.first()) return;
  watch_ = std::thread([this] {
    while (!over_ && !interruption_.requested()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (interruption_.requested()) print_to_stderr(text_);
  });
}

LauncherNotice::~LauncherNotice() {
  over_ = true;
  if (watch_.joinable()) watch_.join();
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
