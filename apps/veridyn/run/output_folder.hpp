#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/veridyn/run/input_hashes.hpp"
#include "apps/veridyn/run/run_record.hpp"
#include "apps/veridyn/run/summary.hpp"

namespace veridyn::app {

/// The folder of a command's results, `--out`.
///
/// Made (with its parents) and checked when the command begins, before any computation. Files are collected in a hidden
/// folder within and moved to their names when all of them are written: until `publish` nothing of an earlier run is
/// touched, and a run that fails, is interrupted or fills the disk leaves nothing, not even the folders that it made.
class OutputFolder {
 public:
  /// @throws InputError when a file is in the way, or nothing can be written there.
  explicit OutputFolder(std::filesystem::path path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// As the user wrote it.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Names of the files written so far, in order.
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

  /// Writes one file. @throws std::runtime_error when the disk is full, InputError when the folder went away.
  void write(const std::string& name, std::string_view content);
  /// Lets `writer` write a file at the path that it is given; errors name the path that the file will have.
  /// @throws std::runtime_error when it cannot be written.
  void write(const std::string& name, const std::function<void(const std::filesystem::path&)>& writer);

  /// Where a file may be written that is no result: it goes with the command.
  [[nodiscard]] std::filesystem::path aside(const std::string& name) const;

  /// Begins to hash inputs of the run, beside what it computes.
  void hash_ahead(std::vector<std::filesystem::path> inputs) { hashes_.begin(std::move(inputs)); }

  /// Writes run.json, prints the summary (`--json`), then moves all files to their names and removes the results of the
  /// run before that this one did not write (`files_of_earlier_run`) and did not read. Call it once, at the end.
  /// @throws as `write` and `print_summary`; then nothing has appeared.
  void publish(const RunRecord& run, const CommonOptions& options, const Summary& summary);
  /// The same without run.json and summary; nothing is removed.
  void publish();

 private:
  /// Where a new file of this run is until it is published.
  [[nodiscard]] std::filesystem::path staged(const std::string& name);
  /// Refuses a folder in the place of a file before the first file is moved.
  void check_names() const;
  /// Where a file of this run is until it is published; any other path as it is.
  [[nodiscard]] std::filesystem::path current(const std::filesystem::path& file) const;

  std::filesystem::path path_;
  std::filesystem::path staging_;            ///< made with the first file
  std::vector<std::filesystem::path> made_;  ///< folders that were not there before, innermost first
  std::vector<std::string> files_;
  InputHashes hashes_;
};

}  // namespace veridyn::app
