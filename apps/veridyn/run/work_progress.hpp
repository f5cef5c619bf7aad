#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/core/progress.hpp"

namespace veridyn::app {

/// The name of the file of progress, in the hidden folder of an output folder.
inline constexpr const char* kProgressFile = "progress.json";

/// The progress of a command on the terminal, and in a file for `veridyn serve`: whole at every moment, written with
/// each stage and then twice a second at most, gone with the command. A disk that does not take it changes nothing.
class WorkProgress final : public TerminalProgress {
 public:
  /// @param folder of the results; null: only the terminal
  WorkProgress(const StudyRun& run, OutputFolder* folder);

  void stage(std::string_view name) override;
  /// A stage that the terminal says in other words.
  void quiet_stage(std::string_view name);
  [[nodiscard]] bool update(double fraction) override;
  /// What is known by now, for people: some lines.
  void note(std::string text);

 private:
  using Clock = std::chrono::steady_clock;
  void write();

  std::filesystem::path file_;  ///< empty: there is none
  std::string command_, study_, stage_, note_;
  int stages_ = 0;
  double fraction_ = 0.0;
  double started_, stage_began_ = 0.0;  ///< since 1970 [s]
  Clock::time_point written_;
};

/// What goes on in an output folder, or went on last, as JSON for the page; empty where nothing is known.
/// @param before what this said of the folder last
[[nodiscard]] std::string work_in(const std::filesystem::path& folder, const std::string& before);

}  // namespace veridyn::app
