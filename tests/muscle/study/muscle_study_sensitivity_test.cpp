#include "veridyn/muscle/study/muscle_study_sensitivity.hpp"

#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

SensitivityStudy read_text(const std::string& text) {
  Progress progress;
  return read_sensitivity_study(Study::parse("[subject]\nmodel = \"arm\"\n" + text, "study.toml"), progress);
}

TEST(SensitivityStudy, HasThePublishedSamplingByDefault) {
  const SensitivityStudy study = read_text("[tasks]\nnumbers = [8, 33]\nhold_out = [11]\n");
  EXPECT_EQ(study.tasks.size(), 2U);
  EXPECT_EQ(study.notes.size(), 1U);  // the task that is held out
  EXPECT_EQ(study.options.sampling.samples, 512U);
  EXPECT_EQ(study.options.sampling.range, 0.05);
  EXPECT_EQ(study.options.cover.tasks, 4U);
  EXPECT_EQ(study.options.indices.method, IndexMethod::kVariance);
  EXPECT_TRUE(study.options.inputs.empty());
}

TEST(SensitivityStudy, TakesItsKeysAndLeavesThoseOfOtherCommands) {
  const SensitivityStudy study = read_text(
      "[tasks]\nnumbers = [8]\n[sensitivity]\nsamples = 500\nrange = \"10 %\"\nscrambled = false\nchoose = "
      "0\n"
      "cover_share = 0.3\nmethod = \"morris\"\ntrajectories = 5\n[identify]\nstarts = 3\n[person]\nnoise = 0.01\n"
      "[[parameter]]\nmuscles = [\"brachialis\"]\nfields = [\"max_isometric_force\"]\n");
  EXPECT_EQ(study.options.sampling.samples, 500U);
  EXPECT_NEAR(study.options.sampling.range, 0.1, 1e-12);
  EXPECT_FALSE(study.options.sampling.scrambled);
  EXPECT_EQ(study.options.cover.tasks, 0U);
  EXPECT_EQ(study.options.cover.share, 0.3);
  EXPECT_EQ(study.options.indices.method, IndexMethod::kMorris);
  EXPECT_EQ(study.options.indices.morris_trajectories, 5U);
  ASSERT_EQ(study.options.inputs.size(), 1U);
  EXPECT_EQ(study.options.inputs[0].name, "brachialis.max_isometric_force");
}

TEST(SensitivityStudy, NamesLineAndKeyOfAMistake) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(read_text("[tasks]\nnumbers = [8]\n" + text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message("[sensitivity]\ncover_share = 50\n").find("study.toml:6: sensitivity.cover_share"),
            std::string::npos);
  EXPECT_NE(message("[sensitivity]\nchoose = -1\n").find("study.toml:6: sensitivity.choose"), std::string::npos);
  EXPECT_NE(message("[sensitivity]\nsampels = 4\n").find("did you mean 'samples'"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::muscle
