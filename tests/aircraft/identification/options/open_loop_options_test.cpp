#include "veridyn/aircraft/identification/options/open_loop_options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "veridyn/aircraft/identification/validation/validation.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

OpenLoopOptions open_loop_of(const std::string& keys) {
  const Study study = Study::parse("[validate]\n" + keys, "s.toml");
  return ValidationOptions::keys().read(study.root().table("validate")).open_loop;
}

TEST(OpenLoopOptions, AreReadWithTheOtherKeysOfValidation) {
  EXPECT_FALSE(open_loop_of("").asked());
  const OpenLoopOptions options = open_loop_of(
      "open_loop = \"20 s\"\nopen_loop_start = 3\nopen_loop_offsets = [\"Cm\"]\nopen_loop_gusts = false\n");
  EXPECT_EQ(options.duration_s, 20.0);
  EXPECT_EQ(options.start_s, 3.0);
  EXPECT_THAT(options.offsets, ::testing::ElementsAre(Coefficient::kCm));
  EXPECT_EQ(options.gusts, false);
  EXPECT_TRUE(open_loop_of("open_loop = 5\nopen_loop_offsets = []\n").offsets.empty());
}

TEST(OpenLoopOptions, ThatMakeNoSenseAreRefusedByName) {
  for (const auto& [keys, message] : {std::pair{"open_loop = -1", "open_loop"},
                                      std::pair{"open_loop = 2\nopen_loop_start = 2", "must be longer than"},
                                      std::pair{"open_loop = 9\nopen_loop_offsets = [\"Cz\"]", "'Cz' is unknown"},
                                      std::pair{"open_loop_start = \"5 m\"", "open_loop_start"}}) {
    try {
      (void)open_loop_of(keys);
      FAIL() << keys;
    } catch (const InputError& error) {
      EXPECT_THAT(std::string(error.what()), ::testing::HasSubstr(message));
    }
  }
}

}  // namespace
}  // namespace veridyn::aircraft
