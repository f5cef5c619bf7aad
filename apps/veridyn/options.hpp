#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/study.hpp"

namespace veridyn::app {

/// The options that every verb takes.
struct CommonOptions {
  std::string out;                     ///< --out: folder of the results
  std::vector<std::string> overrides;  ///< --set key=value
  std::optional<std::uint64_t> seed;   ///< --seed
  int threads = 0;                     ///< --threads; 0: as many as there are
  bool quiet = false;                  ///< --quiet
  bool json = false;                   ///< --json: a machine-readable summary on stdout
};

/// Adds the common options to a verb, and `example` to its help.
void add_common(CLI::App& verb, CommonOptions& options, const std::string& default_out, const std::string& example);

/// Reads a study with the overrides of `--set` and the seed of `--seed` applied.
[[nodiscard]] Study load_study(const std::string& path, const CommonOptions& options);

/// Each verb adds itself to the program and runs when chosen; its exit code goes to `exit_code`.
void add_demo(CLI::App& program, int& exit_code);
void add_export(CLI::App& program, int& exit_code);
void add_identify(CLI::App& program, int& exit_code);
void add_init(CLI::App& program, int& exit_code);
void add_inspect(CLI::App& program, int& exit_code);
void add_reconstruct(CLI::App& program, int& exit_code);
void add_reproduce(CLI::App& program, int& exit_code);
void add_scale(CLI::App& program, int& exit_code);
void add_simulate(CLI::App& program, int& exit_code);
void add_track(CLI::App& program, int& exit_code);
void add_validate(CLI::App& program, int& exit_code);

inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;      ///< the computation failed: the message says why
inline constexpr int kWrongInput = 2;  ///< the input is wrong: the message says where

}  // namespace veridyn::app
