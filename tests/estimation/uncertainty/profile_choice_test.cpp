#include "veridyn/estimation/uncertainty/profile_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::vector<std::string> kFreeUnknowns{"C_f", "C_r", "I_z"};

std::vector<std::string> chosen_profiles(const std::string& text) {
  return read_profiles(Study::parse(text, "study.toml").root(), kFreeUnknowns);
}

TEST(ProfileChoice, IsAListOrAllOrNone) {
  EXPECT_THAT(chosen_profiles("profiles = [\"I_z\", \"C_f\"]"), ElementsAre("I_z", "C_f"));
  EXPECT_THAT(chosen_profiles("profiles = true"), ElementsAre("C_f", "C_r", "I_z"));
  EXPECT_THAT(chosen_profiles("profiles = false"), IsEmpty());
  EXPECT_THAT(chosen_profiles(""), IsEmpty());
}

TEST(ProfileChoice, RefusesWhatIsNotEstimated) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(chosen_profiles(text));
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_THAT(message("profiles = [\"C_ff\"]"), HasSubstr("study.toml:1: profiles"));
  EXPECT_THAT(message("profiles = [\"C_ff\"]"), HasSubstr("did you mean 'C_f'?"));
  EXPECT_THAT(message("profiles = [\"C_f\", \"C_f\"]"), HasSubstr("has 'C_f' twice"));
  EXPECT_THAT(message("profiles = \"C_f\""), HasSubstr("profiles"));
}

}  // namespace
}  // namespace veridyn::estimation
