#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/cueing/platform/platform.hpp"
#include "veridyn/cueing/score/cueing_score.hpp"
#include "veridyn/cueing/score/frequency_response.hpp"
#include "veridyn/cueing/score/knob_effect.hpp"
#include "veridyn/cueing/score/least_error.hpp"
#include "veridyn/cueing/score/tuning.hpp"
#include "veridyn/recording/motion_recording.hpp"

namespace veridyn::cueing {

/// An algorithm of a study with its numbers.
struct StudyAlgorithm {
  std::string name;
  std::unique_ptr<WashoutDesign> design;
};

/// How the response of the chain is measured and what it has to be.
struct ResponseStudy {
  ResponseOptions options;
  std::map<Cue, std::vector<MaskPoint>> mask;
};

/// A study of how a platform renders a drive: `[cue]`, `[platform]`, `[washout.NAME]`, `[omct]`, `[tune]`, and the
/// drive in `[data]` (`vehicle::read_drive_log`) or `[subject]`, `[drive]`, `[road]`
/// (`vehicle::read_simulation_study`).
struct CueingStudy {
  std::string title;
  std::uint64_t seed = 1;
  std::vector<StudyAlgorithm> algorithms;
  std::string perception = "young_meiry";
  MotionThresholds thresholds = usual_thresholds();
  bool optimum = true;
  bool knobs = false;
  Platform platform;
  recording::MotionOptions motion;                   ///< of whatever recorded the drive
  Eigen::Vector3d driver = Eigen::Vector3d::Zero();  ///< the driver's head from the centre of gravity, flu [m]
  std::string drive;                                 ///< what drove, for reports
  std::vector<recording::MotionSample> vehicle;      ///< at the driver's head
  std::optional<ResponseStudy> response;
  std::optional<TuningOptions> tune;
  std::vector<recording::MotionSample> tune_on;  ///< empty: on the drive itself
  std::vector<std::filesystem::path> inputs;
  std::vector<std::string> notes;  ///< what was assumed
};

/// Reads a study and its drive; a simulated one is driven. All keys of the study are read: call
/// `study.root().finish()`.
/// @throws InputError for anything that is wrong in either.
[[nodiscard]] CueingStudy read_study(const Study& study, Progress& progress);
/// The same without a drive, for motion that is still to come: `vehicle` stays empty, and algorithms that plan ahead
/// foresee by `fade`. @throws InputError as above, and for keys that need a drive: [cue.lap], [cue.vehicle], `foresee`
/// other than "fade", [tune].
[[nodiscard]] CueingStudy read_study_without_drive(const Study& study);

/// What one algorithm made of the drive.
struct AlgorithmResult {
  CueingRun run;
  FeltMotion felt;
  CueingScore score;
  std::optional<Tuning> tuning;                        ///< where the study asked for it
  std::map<Cue, std::vector<ResponsePoint>> response;  ///< of cues that the platform can render
  std::map<Cue, std::vector<ResponsePoint>> outside_mask;
  std::vector<std::string> knobs;   ///< "onset = 0.8, 1, 1 rad/s"
  std::vector<KnobEffect> effects;  ///< where the study asked for them
};

/// What an algorithm with these numbers made of a drive that is over.
[[nodiscard]] AlgorithmResult scored(const CueingStudy& study, CueingRun run, WashoutDesign& design);

/// All of them.
struct CueingResult {
  std::vector<AlgorithmResult> algorithms;
  /// Of sway with roll and surge with pitch, where the platform renders them and the perception's orders allow.
  std::array<std::optional<LeastError>, 2> least = {};
  std::vector<std::string> notes;  ///< why something is not there, and how algorithms fared
  bool interrupted = false;
};

/// Tunes where asked, drives the platform with every algorithm, scores, and measures responses.
[[nodiscard]] CueingResult cue(const CueingStudy& study, Progress& progress);

}  // namespace veridyn::cueing
