#include "veridyn/muscle/identification/muscle_outputs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

TEST(MuscleOutput, IsReadAndNamedAlike) {
  const Model model = load_model("arm").model();
  for (const auto& [name, unit] : std::vector<std::pair<std::string, std::string>>{{"elbow_flexion", "rad"},
                                                                                   {"elbow_flexion.speed", "rad/s"},
                                                                                   {"elbow_flexion.moment", "N m"},
                                                                                   {"brachialis.fiber_length", "m"},
                                                                                   {"brachialis.tendon_force", "N"}}) {
    const MuscleOutput output = parse_output(model, name, "x");
    EXPECT_EQ(output_name(model, output), name);
    EXPECT_EQ(output_unit(model, output), unit);
  }
}

TEST(MuscleOutput, WrongNamesGetTheNearestOne) {
  const Model model = load_model("arm").model();
  const auto error = [&](const char* text) {
    try {
      static_cast<void>(parse_output(model, text, "study.toml:4: output"));
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(error("elbow_flexion.moments"), ::testing::HasSubstr("did you mean 'moment'"));
  EXPECT_THAT(error("brachiolis.tendon_force"), ::testing::HasSubstr("did you mean 'brachialis'"));
  EXPECT_THAT(error("elbow_flexon"), ::testing::HasSubstr("did you mean 'elbow_flexion'"));
}

}  // namespace
}  // namespace veridyn::muscle
