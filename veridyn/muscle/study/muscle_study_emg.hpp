#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/muscle/identification/emg_driven_model.hpp"
#include "veridyn/muscle/study/muscle_subject.hpp"
#include "veridyn/muscle/tasks/task.hpp"

namespace veridyn::muscle {

/// Which EMG drives which muscle, and how the recordings are read.
struct EmgSettings {
  std::vector<std::string> signals;  ///< columns of the EMG files
  std::vector<int> signal_of;        ///< by muscle; -1: it rests at its least activation
  std::vector<double> maximum;       ///< by signal, in the files' unit: what stands for 1
  EmgError error;
  /// How far all EMG is ahead of the excitations where no `[[parameter]]` is a delay: mean, standard deviation (0: it
  /// is known).
  double delay_s = kEmgDelay_s, delay_sigma_s = kEmgBudget[1].sigma;
  double low_pass_Hz = 0.0;  ///< of the angles; 0: none
  double settle_s = 0.1;     ///< not compared at the beginning, while activation and fibres forget how they began

  [[nodiscard]] static const KeyTable<EmgSettings>& keys();
};

/// `[emg]`: muscles along recorded angles, driven by EMG.
/// @throws InputError with file, line and key: muscles and columns that are not known, with the nearest name.
[[nodiscard]] EmgSettings read_emg(const StudyTable& emg, const Model& model);

/// What a recorded task is of.
struct EmgTask {
  EmgRecording recording;
  double end = 0.0;  ///< of what angles and EMG share [s]; they begin with the recording
  std::vector<std::filesystem::path> inputs;
  std::vector<std::string> notes;
};

/// A recorded task (`[[task]]` with `angles`, `moments` and `emg`). The model's limit forces are subtracted from the
/// moments, which are those of inverse dynamics: what is left is the muscles'.
///
/// `rest`: values of coordinates that the files do not have; `given`, by coordinate, whether the study says so.
/// @throws InputError with the study's line and key, and the file: a coordinate that muscles cross and nothing gives,
/// degrees taken for radians, gaps, cells without a number, a raw signal or one in volts in place of an envelope,
/// muscles without a column (with the nearest name), moments that the muscles could never make (N mm), files whose
/// times do not overlap.
[[nodiscard]] EmgTask read_emg_recording(const StudyTable& task, const MuscleSubject& subject,
                                         const EmgSettings& settings, std::span<const MuscleOutput> outputs,
                                         const Eigen::VectorXd& rest, std::span<const char> given);

}  // namespace veridyn::muscle
