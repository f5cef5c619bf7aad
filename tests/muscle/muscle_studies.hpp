#pragma once

#include <filesystem>
#include <string>

#include "veridyn/muscle/muscle_study.hpp"

namespace veridyn::muscle::test {

/// Subject of a study: the built-in arm.
inline const std::string kArm = "[subject]\nmodel = \"arm\"\n";

inline MuscleStudy read_muscle_study(const std::string& text, const std::filesystem::path& folder = {}) {
  const Study study = Study::parse(text, "s.toml", folder);
  Progress progress;
  return read_study(study, progress);
}

}  // namespace veridyn::muscle::test
