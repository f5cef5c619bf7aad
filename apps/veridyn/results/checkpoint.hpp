#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "apps/veridyn/run/command.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "veridyn/numerics/batches/block_store.hpp"
#include "veridyn/numerics/batches/value_log.hpp"

namespace veridyn::app {

/// The options --checkpoint, --shard and --merge of commands whose long work may be resumed and shared.
[[nodiscard]] std::vector<Argument> checkpoint_arguments();

/// The option --checkpoint of a search, whose steps depend on each other.
[[nodiscard]] Argument search_checkpoint_argument();

/// Where long work is kept, and which part of it this process does.
struct Checkpoint {
  std::filesystem::path folder;  ///< empty: it is not kept, or by the first of several processes
  numerics::ProcessShare share = {};
  CommonOptions options;  ///< of this process: several on a machine share its processors

  /// Whether this process writes the results: the first of those that a launcher started.
  [[nodiscard]] bool first() const { return options.ranks.first(); }

  /// Ends the command that could not go on: says what is missing of a shard or merge, or that it was interrupted.
  /// @return the exit code
  /// @throws Interrupted
  [[nodiscard]] int stopped(const numerics::BlockStore& store) const;
};

/// What options and launcher ask for.
/// @throws InputError when they contradict each other or need a folder that was not named.
[[nodiscard]] Checkpoint checkpoint_of(const Arguments& arguments);

/// The store of a checkpoint, of this version, study and files; one that keeps nothing where there is no folder. Of
/// several processes all call it.
/// @throws as the constructor of `BlockStore`; InputError where another process has read something else.
[[nodiscard]] numerics::BlockStore open_store(const Checkpoint& checkpoint, const StudyRun& run,
                                              const std::vector<std::filesystem::path>& inputs);

/// What a search asks of its model, kept in the checkpoint's folder; nullptr where there is none. Of several processes
/// all call it.
/// @throws as `open_store` and the constructor of `numerics::ValueLog`.
[[nodiscard]] std::unique_ptr<numerics::ValueLog> open_value_log(const Checkpoint& checkpoint, const StudyRun& run,
                                                                 const std::vector<std::filesystem::path>& inputs);

}  // namespace veridyn::app
