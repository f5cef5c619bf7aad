#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/veridyn/run/command.hpp"

namespace veridyn::app {

/// What a run was made from, for `run.json`: enough to repeat it.
struct RunRecord {
  std::string command;  ///< "identify"
  std::string study_name;
  std::string study_toml;  ///< after overrides
  std::uint64_t seed = 0;
  std::vector<std::filesystem::path> inputs;  ///< hashed
  std::string study_to_write = {};            ///< written as study.toml where not empty
};

/// An input of a run as run.json names it.
struct HashedInput {
  std::string name;
  std::string sha1;
};

/// SHA-1 of a file in hexadecimal; of a folder (a bag of ROS 2, a folder of CSV) that of the lines "SHA-1 name" of its
/// files by name, as `sha1sum` prints them with one blank. Where `stop` becomes true, of what was read until then.
/// @throws InputError when it cannot be read.
[[nodiscard]] std::string sha1_of(const std::filesystem::path& path, const std::atomic<bool>* stop = nullptr);

/// The text of `run.json`: version, command, options, seed, inputs and the names of the files written.
[[nodiscard]] std::string run_json(const RunRecord& run, const CommonOptions& options,
                                   const std::vector<HashedInput>& inputs, const std::vector<std::string>& files);

/// The results that the run before left in a folder: `files` of its run.json, or for the run of an earlier version the
/// known results of its command that are there. Empty where the folder holds no run.json of this program. Only plain
/// names: never a path to somewhere else, a folder, or `study.toml`.
[[nodiscard]] std::vector<std::string> files_of_earlier_run(const std::filesystem::path& folder);

}  // namespace veridyn::app
