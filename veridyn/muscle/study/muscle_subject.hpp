#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// A parameter that the study sets otherwise than the model file.
struct ParameterChange {
  std::string muscle;
  std::string parameter;
  double before = 0.0;
  double after = 0.0;
};

/// The musculoskeletal model of a study, read, changed as the study says and prepared.
struct MuscleSubject {
  std::string title;             ///< of the study; the model's name when left out
  std::string model_name;        ///< as the study names it
  std::optional<OsimFile> file;  ///< as read; always set where a study was read
  Model written;                 ///< the file's model with the study's parameters: what is written back
  std::vector<HeldLoad> loads;   ///< in the system's masses, not in `written`
  std::vector<ParameterChange> changes;
  std::unique_ptr<MusculoskeletalSystem> system;
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> inputs;  ///< files read
};

}  // namespace veridyn::muscle
