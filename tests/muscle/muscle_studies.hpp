#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/muscle_study.hpp"

namespace veridyn::muscle::test {

/// Subject of a study: the built-in arm.
inline const std::string kArm = "[subject]\nmodel = \"arm\"\n";

inline MuscleStudy read_muscle_study(const std::string& text, const std::filesystem::path& folder = {}) {
  const Study study = Study::parse(text, "s.toml", folder);
  Progress progress;
  return read_study(study, progress);
}

/// The same, of a motion that computed muscle control follows.
inline const std::string kFollow = kArm + "[motion]\nmethod = \"computed muscle control\"\nduration = 0.3\n";

/// What reading a study says is wrong with it.
inline std::string study_error(const std::string& text, const std::filesystem::path& folder = {}) {
  try {
    static_cast<void>(read_muscle_study(text, folder));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// A study that is refused: the message has both.
struct Refusal {
  std::string study, place, what;
};

inline void expect_refusals(const std::vector<Refusal>& refusals) {
  for (const Refusal& r : refusals) {
    SCOPED_TRACE(r.study);
    EXPECT_THAT(study_error(r.study), testing::AllOf(testing::HasSubstr(r.place), testing::HasSubstr(r.what)));
  }
}

}  // namespace veridyn::muscle::test
