#include "veridyn/aircraft/absent_surfaces.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace veridyn::aircraft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

AeroModel lateral_model() {
  AeroModel model;
  model.set(coefficient_model(Coefficient::kCn,
                              std::vector<std::pair<std::string_view, double>>{
                                  {"1", 0.0}, {"beta", 0.1}, {"da", 0.01}, {"dr", -0.05}, {"beta*dr", 0.02}}));
  return model;
}

/// The notes; `model` is changed.
std::vector<std::string> notes_of(AeroModel& model, const char* subject, const std::vector<std::string>& recorded) {
  const Study study = Study::parse(subject, "study.toml");
  return without_absent_surfaces(model, study.root().table("subject"), [&](std::string_view name) {
    return std::ranges::find(recorded, name) != recorded.end();
  });
}

TEST(AbsentSurfaces, TakeTheirTermsWithThemAndLeaveTheAxis) {
  AeroModel model = lateral_model();
  EXPECT_THAT(notes_of(model, "[subject]\n", {"elevator", "aileron"}),
              ElementsAre(HasSubstr("no rudder is recorded, and the study describes none")));
  EXPECT_THAT(model.at(Coefficient::kCn).parameter_names(), ElementsAre("Cn_0", "Cn_beta", "Cn_da"));
  EXPECT_THAT(model.at(Coefficient::kCn).values, ElementsAre(0.0, 0.1, 0.01));
  EXPECT_THAT(notes_of(model, "[subject]\n", {"elevator", "aileron"}), IsEmpty()) << "nothing is left to take";
}

TEST(AbsentSurfaces, AreOnlyThoseThatNothingSpeaksOf) {
  const std::pair<const char*, std::vector<std::string>> cases[] = {
      {"[subject]\n", {"aileron", "rudder"}},
      {"[subject.actuators.rudder]\nupper = 0.3\n", {"aileron"}},
      {"[subject]\nbuiltin = \"thor\"\n", {"aileron"}},
      {"[subject]\n", {"elevator"}}};
  for (const auto& [subject, recorded] : cases) {
    AeroModel model = lateral_model();
    EXPECT_THAT(notes_of(model, subject, recorded), IsEmpty()) << subject;
    EXPECT_EQ(model, lateral_model()) << subject;
  }
}

}  // namespace
}  // namespace veridyn::aircraft
