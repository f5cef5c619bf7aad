#pragma once

#include <filesystem>
#include <vector>

#include "apps/veridyn/command.hpp"
#include "apps/veridyn/domains.hpp"
#include "veridyn/numerics/batches/block_store.hpp"

namespace veridyn::app {

/// The options --checkpoint, --shard and --merge of commands whose long work may be resumed and shared.
[[nodiscard]] std::vector<Argument> checkpoint_arguments();

/// Where long work is kept, and which part of it this process does.
struct Checkpoint {
  std::filesystem::path folder;  ///< empty: it is not kept
  numerics::BlockShare share = {};
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

/// The store of a checkpoint, of this version, study and files; one that keeps nothing where there is no folder.
/// @throws as the constructor of `BlockStore`.
[[nodiscard]] numerics::BlockStore open_store(const Checkpoint& checkpoint, const StudyRun& run,
                                              const std::vector<std::filesystem::path>& inputs);

}  // namespace veridyn::app
