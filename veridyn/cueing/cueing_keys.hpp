#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/study_keys.hpp"
#include "veridyn/cueing/score/frequency_response.hpp"
#include "veridyn/cueing/score/tuning.hpp"
#include "veridyn/cueing/washout/driver_settings.hpp"
#include "veridyn/recording/motion_recording.hpp"

namespace veridyn::cueing {

/// What algorithms that plan ahead foresee forces by.
enum class ForesightBy { kFade, kLap, kDriver };

/// `[cue]` as it is written.
struct CueTable {
  std::vector<std::string> algorithms = {"classical"};
  DriverSettings settings;
  std::string perception = "young_meiry";
  bool reid_nahon = false;                           ///< whose thresholds
  Eigen::Vector3d driver = Eigen::Vector3d::Zero();  ///< the driver's head from the centre of gravity, flu [m]
  recording::MotionOptions motion;
  bool optimum = true;
  bool knobs = false;
  std::optional<ForesightBy> foresee;

  [[nodiscard]] static const KeyTable<CueTable>& keys();
};

/// `[[omct.mask]]` as it is written; empty columns limit nothing.
struct MaskTable {
  Cue cue = Cue::kSurge;
  std::vector<double> frequency, least_gain, most_gain, least_phase, most_phase;

  [[nodiscard]] static const KeyTable<MaskTable>& keys();
};

/// `[omct]`.
[[nodiscard]] const KeyTable<ResponseOptions>& response_keys();
/// `[tune]`.
[[nodiscard]] const KeyTable<TuningOptions>& tuning_keys();

/// The keys of the tables of a cueing study, in the order in which one writes them.
[[nodiscard]] std::vector<StudyKeys> study_keys();

}  // namespace veridyn::cueing
