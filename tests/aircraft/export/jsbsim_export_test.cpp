#include "veridyn/aircraft/export/jsbsim_export.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <pugixml.hpp>

#include "tests/aircraft/model/jsbsim_aircraft.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;

CompletedSubject partly_known() {
  Subject s = builtin_subject("thor");
  for (double& value : s.model.at(Coefficient::kCD).values) value = kNaN;
  return complete_subject(s, s, nullptr, {18.0, 1.2, "of the test"});
}

TEST(JsbsimExport, EveryParameterSaysWhereItIsFrom) {
  const CompletedSubject completed = partly_known();
  const TrialFlight trial = fly_trial(completed);
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(jsbsim_file(completed, &trial).c_str()));
  const pugi::xml_node root = document.child("fdm_config");
  int parameters = 0;
  for (const SourcedValue& value : completed.values) {
    if (!value.parameter) continue;
    const pugi::xml_node function =
        root.child("aerodynamics")
            .find_child_by_attribute("function", "name", ("aero/coefficient/" + value.name).c_str());
    ASSERT_TRUE(function) << value.name;
    EXPECT_EQ(function.child("description").text().get(), value.text) << value.name;
    ++parameters;
  }
  EXPECT_GT(parameters, 25);
  std::string notes;
  for (const pugi::xml_node note : root.child("fileheader").children("note"))
    notes += note.text().get() + std::string("\n");
  EXPECT_THAT(notes, HasSubstr("inertia: the study's"));
  EXPECT_THAT(notes, HasSubstr("trimmed at 18 m/s and"));
  EXPECT_THAT(notes, HasSubstr("short period"));
}

// What was flown is what stands in the file: no load is left at its trim but the weight.
TEST(JsbsimExport, TheTrimThatWasFlownIsOneOfTheFile) {
  const CompletedSubject completed = partly_known();
  const TrialFlight trial = fly_trial(completed);
  ASSERT_TRUE(trial.trim.usable());
  testing::JsbsimAircraft file(jsbsim_file(completed, &trial));
  const auto loads = file.loads(air_velocity(18.0, trial.trim.alpha, trial.trim.beta), Eigen::Vector3d::Zero(),
                                trial.trim.controls, 1.2, 0.0);
  const double theta = trial.trim.theta, weight = completed.subject.mass * kGravity;
  EXPECT_LT((loads.force + weight * Eigen::Vector3d(-std::sin(theta), 0.0, std::cos(theta))).norm(), 1e-7 * weight);
  EXPECT_LT(loads.moment.norm(), 1e-7);
}

}  // namespace
}  // namespace veridyn::aircraft
