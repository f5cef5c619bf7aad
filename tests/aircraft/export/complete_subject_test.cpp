#include "veridyn/aircraft/export/complete_subject.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/export/handbook.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::ParameterStatus;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kDensity = 1.2;
const ExportCondition kAt20{20.0, kDensity, "of the test"};

Subject without(Subject s, Coefficient c) {
  std::ranges::fill(s.model.at(c).values, kNaN);
  return s;
}

/// `known` with a structure and no numbers: a study of which a flight identified something.
Subject structure_of(Subject s) {
  for (auto& model : s.model.coefficients)
    if (model) std::ranges::fill(model->values, kNaN);
  s.propulsion = {};
  return s;
}

estimation::Estimate estimate_of(const Subject& s) {
  estimation::Estimate estimate;
  for (const auto& model : s.model.coefficients) {
    if (!model || !model->known()) continue;
    for (std::size_t i = 0; i < model->size(); ++i) {
      const double value = model->values[i];
      estimate.parameters.push_back({.name = parameter_name(model->coefficient, model->terms[i]),
                                     .value = value,
                                     .sigma = 0.1,
                                     .low95 = value - 0.2,
                                     .high95 = value + 0.2,
                                     .status = ParameterStatus::kIdentified});
    }
  }
  return estimate;
}

const SourcedValue& named(const CompletedSubject& completed, std::string_view name) {
  const auto at = std::ranges::find(completed.values, name, &SourcedValue::name);
  EXPECT_NE(at, completed.values.end()) << name;
  return *at;
}

TEST(CompleteSubject, WhatIsCompleteStaysAsItIs) {
  for (const std::string& name : builtin_subject_names()) {
    const Subject s = builtin_subject(name);
    if (!s.inertia || !s.model.unknown_parameters().empty() || s.propulsion.kind == PropulsionKind::kNone) continue;
    const CompletedSubject completed = complete_subject(s, s, nullptr, kAt20);
    EXPECT_EQ(completed.subject.model, s.model) << name;
    EXPECT_EQ(completed.subject.propulsion, s.propulsion) << name;
    EXPECT_TRUE(completed.all_known()) << name;
    EXPECT_EQ(origin_lines(completed).size(), 1u);
  }
}

// A log without thrust: drag is not identified. It becomes the handbook's, and an engine of twice the drag flies it.
TEST(CompleteSubject, DragAndEngineOfALogWithoutThrustAreEstimates) {
  Subject known = without(builtin_subject("unatrap"), Coefficient::kCD);
  known.propulsion = {};
  const Subject study = structure_of(known);
  const estimation::Estimate estimate = estimate_of(known);
  const CompletedSubject completed = complete_subject(known, study, &estimate, kAt20);
  EXPECT_EQ(named(completed, "CL_alpha").origin, ValueOrigin::kFlight);
  EXPECT_THAT(named(completed, "CL_alpha").text, HasSubstr("identified, 95 %: 3.407 to 3.807"));
  EXPECT_EQ(named(completed, "CD_alpha2").origin, ValueOrigin::kHandbook);
  EXPECT_THAT(named(completed, "CD_alpha2").text, HasSubstr("Raymer"));
  EXPECT_EQ(named(completed, "CD_CT").origin, ValueOrigin::kZero);
  EXPECT_EQ(named(completed, "CD_CT").value, 0.0);
  EXPECT_EQ(named(completed, "inertia").origin, ValueOrigin::kStudy);
  EXPECT_TRUE(completed.subject.model.unknown_parameters().empty());
  EXPECT_FALSE(completed.all_known());
  // Half of the full thrust carries the drag of level flight, but for what the lift of the elevator changes.
  const Trim trim = find_trim(completed.subject, {.airspeed = 20.0, .density = kDensity});
  ASSERT_TRUE(trim.usable()) << trim.message();
  EXPECT_NEAR(trim.controls.throttle, 0.5, 0.05);
}

TEST(CompleteSubject, TheStudysValueComesBeforeAnEstimate) {
  const Subject study = builtin_subject("aerosonde");
  const Subject known = without(study, Coefficient::kCn);
  const estimation::Estimate estimate = estimate_of(known);
  const CompletedSubject completed = complete_subject(known, study, &estimate, kAt20);
  EXPECT_EQ(completed.subject.model, study.model);
  EXPECT_EQ(named(completed, "Cn_beta").origin, ValueOrigin::kStudy);
  EXPECT_EQ(named(completed, "Cn_beta").text, "the study's, not identified");
  EXPECT_TRUE(completed.all_known());
}

// The sign of what is estimated is that of the surface in what is known: thor counts trailing edge down, unatrap up.
TEST(CompleteSubject, EstimatedSurfacesHaveTheSignOfTheKnownOnes) {
  for (const char* name : {"thor", "unatrap"}) {
    Subject known = without(builtin_subject(name), Coefficient::kCY);
    const Subject study = structure_of(known);
    const estimation::Estimate estimate = estimate_of(known);
    const CompletedSubject completed = complete_subject(known, study, &estimate, kAt20);
    EXPECT_EQ(named(completed, "CY_dr").origin, ValueOrigin::kHandbook);
    EXPECT_LT(named(completed, "CY_dr").value * named(completed, "Cn_dr").value, 0.0) << name;
  }
}

// A flying wing has no rudder, and none is made up.
TEST(CompleteSubject, NoSurfaceIsAddedThatTheStudyDoesNotHave) {
  Subject known = builtin_subject("thor");
  for (const Coefficient c : {Coefficient::kCY, Coefficient::kCl, Coefficient::kCn}) {
    CoefficientModel& model = known.model.at(c);
    model.terms.pop_back(), model.values.pop_back();
    ASSERT_FALSE(model.terms.back().uses(AeroVariable::kDr));
  }
  known = without(known, Coefficient::kCn);
  const CompletedSubject completed = complete_subject(known, structure_of(known), nullptr, kAt20);
  for (const SourcedValue& value : completed.values) EXPECT_EQ(value.name.find("_dr"), std::string::npos) << value.name;
  EXPECT_EQ(named(completed, "Cn_beta").origin, ValueOrigin::kHandbook);
}

// Moments that were identified per unit of inertia turn the body as it was measured to, whatever the inertia.
TEST(CompleteSubject, MomentsPerUnitOfInertiaTurnTheBodyAsMeasured) {
  const Subject truth = builtin_subject("thor");
  Subject known = truth;
  known.inertia.reset();
  for (const Coefficient c : {Coefficient::kCl, Coefficient::kCm, Coefficient::kCn}) known = without(known, c);
  estimation::Estimate estimate = estimate_of(known);
  const double Jy = truth.inertia->Jy;
  for (const auto& [term, name] : {std::pair{"1", "Cm/Jy_0"}, std::pair{"alpha", "Cm/Jy_alpha"},
                                   std::pair{"q_n", "Cm/Jy_q"}, std::pair{"de", "Cm/Jy_de"}}) {
    const double value = *truth.model.at(Coefficient::kCm).value_of(term) / Jy;
    estimate.parameters.push_back(
        {.name = name, .value = value, .low95 = value, .high95 = value, .status = ParameterStatus::kIdentified});
  }
  const CompletedSubject completed = complete_subject(known, structure_of(known), &estimate, kAt20);
  ASSERT_TRUE(completed.subject.inertia);
  EXPECT_EQ(*completed.subject.inertia, handbook_inertia(known));
  EXPECT_EQ(named(completed, "Cm_alpha").origin, ValueOrigin::kFlight);
  EXPECT_NEAR(named(completed, "Cm_alpha").value / completed.subject.inertia->Jy,
              *truth.model.at(Coefficient::kCm).value_of("alpha") / Jy, 1e-12);
  EXPECT_EQ(named(completed, "Cl_p").origin, ValueOrigin::kHandbook);
  EXPECT_EQ(named(completed, "inertia").origin, ValueOrigin::kHandbook);
}

TEST(CompleteSubject, NothingKnownIsNoAircraft) {
  const Subject s = structure_of(builtin_subject("thor"));
  try {
    (void)complete_subject(s, s, nullptr, kAt20);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no parameter of its model is known"));
  }
}

// Whatever one coefficient is known, there is an aircraft that flies level.
TEST(CompleteSubject, IsTrimmedWhicheverCoefficientIsKnown) {
  for (const char* name : {"thor", "aerosonde", "unatrap", "x8"}) {
    for (const Coefficient only : enumerators<Coefficient, kCoefficients>()) {
      const Subject whole = builtin_subject(name), study = structure_of(whole);
      Subject known = study;
      known.model.at(only) = whole.model.at(only);
      const CompletedSubject completed = complete_subject(known, study, nullptr, kAt20);
      const Trim trim = find_trim(completed.subject, {.airspeed = 20.0, .density = kDensity});
      EXPECT_NE(trim.end, TrimEnd::kNoSolution) << name << " " << name_of(only) << ": " << trim.message();
    }
  }
}

TEST(CompleteSubject, LinesSayWhatIsFromWhere) {
  Subject known = without(builtin_subject("unatrap"), Coefficient::kCD);
  known.propulsion = {};
  const estimation::Estimate estimate = estimate_of(known);
  const std::vector<std::string> lines = origin_lines(complete_subject(known, structure_of(known), &estimate, kAt20));
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_THAT(lines[0], HasSubstr("the flight   26: CL, CY, Cl, Cm, Cn"));
  EXPECT_THAT(lines[1], HasSubstr("the study     1: inertia"));
  EXPECT_THAT(lines[2], HasSubstr("an estimate   4: CD_0 0.0"));
  EXPECT_THAT(lines[2], HasSubstr("thrust at full throttle"));
  EXPECT_THAT(lines[3], HasSubstr("left zero     3: CD_q, CD_de, CD_CT"));
}

}  // namespace
}  // namespace veridyn::aircraft
