#include "apps/veridyn/results/checkpoint.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/launcher.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"
#include "veridyn/numerics/ranks/shared_work.hpp"

namespace veridyn::app {
namespace {

std::optional<std::size_t> whole(std::string_view text) {
  std::size_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// "2/8": the second of eight.
numerics::ProcessShare parse_shard(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const std::optional<std::size_t> index = whole(std::string_view(text).substr(0, slash));
    const std::optional<std::size_t> count = whole(std::string_view(text).substr(slash + 1));
    if (index && count && *index >= 1 && *index <= *count) return {.index = *index - 1, .count = *count};
  }
  throw InputError("--shard", fmt::format("is '{}'; must be I/N with I from 1 to N, such as 2/8", text));
}

/// One thread for each processor that this process may use, unless the user says how many.
void choose_threads(const LaunchedProcess& process, CommonOptions& options) {
  const int fair = threads_of(process);
  const auto machine = static_cast<int>(std::thread::hardware_concurrency());
  if (process.size > 1 && options.threads > fair)
    print_line(options, fmt::format("note: {} threads for each of {} processes on this machine, of {} processors",
                                    options.threads, process.on_machine, machine));
  if (options.threads == 0 && fair < machine) options.threads = fair;
}

/// What the results of a run follow from, by name.
numerics::BlockStore::Identity identity_of(const StudyRun& run, const std::vector<std::filesystem::path>& inputs) {
  numerics::BlockStore::Identity identity = {{"program", program_name()}, {"command", run.command}};
  for (const std::filesystem::path& input : inputs)
    identity.emplace_back("file", fmt::format("{} {}", input.filename().string(), sha1_of(input)));
  const std::string study = run.study.to_toml();
  for (std::size_t from = 0; from < study.size();) {
    const std::size_t end = std::min(study.find('\n', from), study.size());
    if (end > from) identity.emplace_back("study", study.substr(from, end - from));
    from = end + 1;
  }
  return identity;
}

/// Each process reads the study for itself, maybe on another machine: all must have read the same.
void require_same_identity(const numerics::Ranks& ranks, const numerics::BlockStore::Identity& identity) {
  if (ranks.alone()) return;
  numerics::Fingerprint key;
  for (const auto& [name, value] : identity) {
    key.add(name);
    key.add(value);
  }
  numerics::require_same(ranks, key.value());
}

}  // namespace

std::vector<Argument> checkpoint_arguments() {
  return {
      {.name = "--checkpoint",
       .help = "keep finished work in this folder, and go on from what is there",
       .type = "FOLDER"},
      {.name = "--shard", .help = "compute only every N-th block from the I-th on, where it is missing", .type = "I/N"},
      {.name = "--merge",
       .help = "compute nothing: results from a complete checkpoint, or what it lacks",
       .value = false}};
}

Argument search_checkpoint_argument() {
  return {.name = "--checkpoint",
          .help = "of a person's tasks: keep finished simulations in this folder, and go on from what is there",
          .type = "FOLDER"};
}

Checkpoint checkpoint_of(const Arguments& arguments) {
  const LaunchedProcess process = launched_process();
  Checkpoint checkpoint{.folder = arguments.text("--checkpoint"), .options = arguments.common};
  const std::string shard = arguments.given("--shard") ? arguments.text("--shard") : "";
  const bool merge = arguments.given("--merge");
  if (merge && !shard.empty()) throw InputError("--merge", "computes nothing, --shard a part; choose one of them");
  const std::string part = merge ? "--merge" : "--shard";
  if (merge || !shard.empty()) {
    if (process.size > 1)
      throw InputError(part, fmt::format("is for single processes; {} under {} share the work by themselves",
                                         process.size, process.launcher));
    if (checkpoint.folder.empty()) throw InputError(part, "needs --checkpoint with the folder that all parts share");
    checkpoint.share = merge ? numerics::ProcessShare{.count = 0} : parse_shard(shard);
  }
  // The first process alone keeps what all have computed.
  if (!checkpoint.first()) checkpoint.folder.clear();
  choose_threads(process, checkpoint.options);
  return checkpoint;
}

int Checkpoint::stopped(const numerics::BlockStore& store) const {
  for (const std::string& warning : store.warnings()) print_line(options, "warning: " + warning);
  if (store.missing() > 0) {
    const std::string text = fmt::format("{} of {} blocks are missing", store.missing(), store.last_blocks());
    if (share.count == 0) throw std::runtime_error(fmt::format("{}: {}", folder.string(), text));
    print_line(options, fmt::format("shard {} of {} is done; {} in {}: run the other shards, then again",
                                    share.index + 1, share.count, text, folder.string()));
    return kDone;
  }
  if (!folder.empty()) print_line(options, fmt::format("finished blocks are kept in {}", folder.string()));
  throw Interrupted();
}

numerics::BlockStore open_store(const Checkpoint& checkpoint, const StudyRun& run,
                                const std::vector<std::filesystem::path>& inputs) {
  const numerics::Ranks& ranks = checkpoint.options.ranks;
  if (checkpoint.folder.empty() && ranks.alone()) return {};
  const numerics::BlockStore::Identity identity = identity_of(run, inputs);
  require_same_identity(ranks, identity);
  if (checkpoint.folder.empty()) return numerics::BlockStore(ranks);
  return {checkpoint.folder, identity, checkpoint.share, ranks};
}

std::unique_ptr<numerics::ValueLog> open_value_log(const Checkpoint& checkpoint, const StudyRun& run,
                                                   const std::vector<std::filesystem::path>& inputs) {
  // Only who is of the same study and version may come in.
  const numerics::BlockStore identity = open_store(checkpoint, run, inputs);
  return checkpoint.folder.empty() ? nullptr : std::make_unique<numerics::ValueLog>(checkpoint.folder);
}

}  // namespace veridyn::app
