// Models that are written back into the file that they came from.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

std::string built_in_text() { return std::string(builtin_models()[0].text); }

TEST(OsimWriter, WritingAnUnchangedModelGivesTheFileByteForByte) {
  const OsimFile arm = load_model("arm");
  EXPECT_EQ(arm.text_with(arm.model()), built_in_text());
  const std::filesystem::path models = veridyn::test::shared_folder() / "data/opensim";
  if (!std::filesystem::exists(models)) GTEST_SKIP() << "the OpenSim models of ../shared/data are not here";
  for (const auto& entry : std::filesystem::directory_iterator(models)) {
    if (entry.path().extension() != ".osim") continue;
    const OsimFile file = OsimFile::load(entry.path());
    EXPECT_EQ(file.text_with(file.model()), read_file(entry.path())) << entry.path();
  }
}

TEST(OsimWriter, ChangesOnlyTheNumbersThatChanged) {
  const OsimFile arm = load_model("arm");
  Model changed = arm.model();
  changed.muscles[3].parameters.musculotendon.optimal_fiber_length = 0.1234567890123456;
  const std::string text = arm.text_with(changed);
  std::string expected = built_in_text();
  const std::string before = "<optimal_fiber_length>0.152<";
  ASSERT_NE(expected.find(before), std::string::npos);
  expected.replace(expected.find(before), before.size(), "<optimal_fiber_length>0.1234567890123456<");
  EXPECT_EQ(text, expected);
}

TEST(OsimWriter, AddsToTheMuscleWhatItLeftToItsDefaultsAndReadsBackTheSameDoubles) {
  const OsimFile arm = load_model("arm");
  Model changed = arm.model();
  for (Muscle& muscle : changed.muscles) {
    auto& m = muscle.parameters.musculotendon;
    m.activation_time_constant *= 1.0 / 3.0;
    m.tendon_slack_length *= 1.0 / 3.0;
    m.pennation_angle_at_optimal += 0.1;
  }
  const Model back = OsimFile::parse(arm.text_with(changed), "back").model();
  for (std::size_t i = 0; i < back.muscles.size(); ++i) {
    const auto& a = back.muscles[i].parameters.musculotendon;
    const auto& b = changed.muscles[i].parameters.musculotendon;
    EXPECT_EQ(a.activation_time_constant, b.activation_time_constant);
    EXPECT_EQ(a.tendon_slack_length, b.tendon_slack_length);
    EXPECT_EQ(a.pennation_angle_at_optimal, b.pennation_angle_at_optimal);
    EXPECT_EQ(a.max_isometric_force, b.max_isometric_force);
  }
}

TEST(OsimWriter, WritesToAMuscleAmongTheComponents) {
  std::string moved = built_in_text();
  const std::string type = "</Thelen2003Muscle>";
  const std::size_t begin = moved.rfind("<Thelen2003Muscle "), end = moved.rfind(type) + type.size();
  const std::string muscle = moved.substr(begin, end - begin);
  moved.erase(begin, end - begin);
  moved.insert(moved.find("</Model>"), "<components>" + muscle + "</components>");
  const OsimFile arm = OsimFile::parse(moved, "moved.osim");
  ASSERT_EQ(arm.model().muscles.size(), load_model("arm").model().muscles.size());
  Model changed = arm.model();
  changed.muscles.back().parameters.musculotendon.max_isometric_force = 123.5;
  const Model back = OsimFile::parse(arm.text_with(changed), "back").model();
  EXPECT_EQ(back.muscles.back().parameters.musculotendon.max_isometric_force, 123.5);
}

TEST(OsimWriter, RefusesAMuscleThatTheFileDoesNotHave) {
  const OsimFile arm = load_model("arm");
  Model changed = arm.model();
  changed.muscles[0].parameters.name = "soleus";
  EXPECT_THROW(static_cast<void>(arm.text_with(changed)), InputError);
}

}  // namespace
}  // namespace veridyn::muscle
