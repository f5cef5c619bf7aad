#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/veridyn/run/command.hpp"
#include "apps/veridyn/run/run_record.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::app {

/// What a study is of.
enum class Domain {
  kAircraft,     ///< a flight: the rest
  kVehicle,      ///< a drive: [subject] with kind = "vehicle"
  kMuscle,       ///< a musculoskeletal model: [subject] with `model`
  kSwingTest,    ///< inertia on the ground: [swing_test]
  kCalibration,  ///< air data in a wind tunnel: [calibration]
  kCueing,       ///< a drive on a motion platform: [cue]
};
/// How many there are.
inline constexpr std::size_t kDomains = 6;

/// Decides which domain a study is of.
/// @throws InputError for a `kind` of subject that there is not, and for a [drive] or [motion] whose [subject] does not
/// say that it is of a vehicle or a musculoskeletal model.
[[nodiscard]] Domain domain_of(const Study& study);

/// A command at work on a study.
struct StudyRun {
  std::string command;         ///< as run.json names it
  std::filesystem::path path;  ///< of the study
  Study study;
  Arguments arguments;
  std::string text_to_write = {};  ///< of a study that comes with the program and is written with its results
  std::vector<std::filesystem::path> subject_files = {};  ///< from which it takes a subject

  [[nodiscard]] const CommonOptions& options() const { return arguments.common; }
  /// What run.json says of this run; `inputs` are the files read beyond the study, its subject's and the estimate of
  /// `--estimate-file`, which are added.
  [[nodiscard]] RunRecord record(std::uint64_t seed, std::vector<std::filesystem::path> inputs = {}) const;
};

/// A study with the overrides of `--set` and the seed of `--seed`.
[[nodiscard]] StudyRun parse_study(std::string command, const std::filesystem::path& path, std::string_view text,
                                   const Arguments& arguments);

/// Runs a command on its study: what it does for the study's domain, by the table domain x command.
/// @throws InputError when it does not apply to that domain: for which it does, and what is possible instead.
int run_on_study(std::string_view command, const Arguments& arguments);

/// Names of the commands in the table.
[[nodiscard]] std::span<const std::string_view> study_commands();

// The cells of the table, each in the file of its command.
int simulate_aircraft(const StudyRun& run);
int simulate_vehicle(const StudyRun& run);
int simulate_muscle(const StudyRun& run);
int reconstruct_aircraft(const StudyRun& run);
int identify_aircraft(const StudyRun& run);
int identify_vehicle(const StudyRun& run);
int identify_muscles(const StudyRun& run);
int identify_swing_test(const StudyRun& run);
int identify_calibration(const StudyRun& run);
int validate_aircraft(const StudyRun& run);
int validate_vehicle(const StudyRun& run);
int validate_muscles(const StudyRun& run);
int track_aircraft(const StudyRun& run);
int track_vehicle(const StudyRun& run);
int sensitivity_aircraft(const StudyRun& run);
int sensitivity_vehicle(const StudyRun& run);
int sensitivity_muscle(const StudyRun& run);
int export_aircraft(const StudyRun& run);
int export_vehicle(const StudyRun& run);
int scale_vehicle(const StudyRun& run);
int cue_platform(const StudyRun& run);

}  // namespace veridyn::app
