#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "apps/veridyn/command.hpp"
#include "apps/veridyn/domains.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/numerics/batches/block_store.hpp"
#include "veridyn/numerics/batches/value_log.hpp"

namespace veridyn::app {

/// The options --checkpoint, --shard and --merge of commands whose long work may be resumed and shared.
[[nodiscard]] std::vector<Argument> checkpoint_arguments();

/// Those of a search, whose processes work at the same time: --checkpoint and --shard.
[[nodiscard]] std::vector<Argument> search_checkpoint_arguments();

/// Where long work is kept, and which part of it this process does.
struct Checkpoint {
  std::filesystem::path folder;  ///< empty: it is not kept
  numerics::ProcessShare share = {};
  bool first = true;      ///< writes the results; one of several that a launcher started does not
  CommonOptions options;  ///< of this process: only the first talks, and they share the processors

  /// Ends the command that could not go on: says what is missing of a shard or merge, or that it was interrupted.
  /// @return the exit code
  /// @throws Interrupted
  [[nodiscard]] int stopped(const numerics::BlockStore& store) const;
};

/// What options and launcher ask for.
/// @throws InputError when they contradict each other or need a folder that was not named.
[[nodiscard]] Checkpoint checkpoint_of(const Arguments& arguments);

/// The same of a search: shards wait for each other, and the first writes the results.
[[nodiscard]] Checkpoint search_checkpoint_of(const Arguments& arguments);

/// The store of a checkpoint, of this version, study and files; one that keeps nothing where there is no folder.
/// @throws as the constructor of `BlockStore`.
[[nodiscard]] numerics::BlockStore open_store(const Checkpoint& checkpoint, const StudyRun& run,
                                              const std::vector<std::filesystem::path>& inputs);

/// What a search asks of its model, kept in the checkpoint's folder; nullptr where none is named.
/// @throws as `open_store` and the constructor of `numerics::ValueLog`.
[[nodiscard]] std::unique_ptr<numerics::ValueLog> open_value_log(const Checkpoint& checkpoint, const StudyRun& run,
                                                                 const std::vector<std::filesystem::path>& inputs,
                                                                 const Progress& progress);

/// Whether this process is to run a command that shares no work: of several under a launcher none is.
/// @throws InputError in the first of them, so that it is said once.
[[nodiscard]] bool runs_alone(std::string_view command);

}  // namespace veridyn::app
