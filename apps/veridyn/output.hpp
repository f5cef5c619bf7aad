#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "apps/veridyn/options.hpp"

namespace veridyn::app {

/// What a run was made from, for `run.json`: enough to repeat it.
struct RunRecord {
  std::string verb;
  std::string study_name;
  std::string study_toml;  ///< after overrides
  std::uint64_t seed = 0;
  std::vector<std::filesystem::path> inputs;  ///< hashed
};

/// Writes `run.json` into the folder: version, verb, options, seed, and SHA-1 of every input.
void write_run_record(const std::filesystem::path& folder, const RunRecord& run, const CommonOptions& options);

/// Prints the summary on stdout when `--json` was given.
void print_summary(const nlohmann::ordered_json& summary, const CommonOptions& options);

/// A line for people on stderr, unless quiet.
void tell(const CommonOptions& options, const std::string& line);

}  // namespace veridyn::app
