#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

/// Ten seconds at 20 m/s, every signal but the thrust there and constant.
FlightSignals constant_signals() {
  FlightSignals s;
  s.grid = {0.0, 0.1, 101};
  for (std::size_t i = 0; i < kFlightSignals; ++i) {
    const auto signal = static_cast<FlightSignal>(i);
    if (signal != FlightSignal::kThrust) s[signal].value.assign(s.size(), 0.01);
  }
  s[FlightSignal::kAirspeed].value.assign(s.size(), 20.0);
  s.air_density.assign(s.size(), 1.2);
  return s;
}

TEST(CoefficientRows, NeedTheSignalsOfTheirTerms) {
  const CoefficientModel cm{Coefficient::kCm, {parse_term("1", "t"), parse_term("alpha*de", "t")}, {kNaN, kNaN}};
  EXPECT_THAT(internal::needed_signals(cm),
              ::testing::ElementsAre(FlightSignal::kAirspeed, FlightSignal::kAlpha, FlightSignal::kElevator));
  // Lift is turned into wind axes, whatever its terms.
  const CoefficientModel cl{Coefficient::kCL, {parse_term("1", "t")}, {kNaN}};
  EXPECT_THAT(internal::needed_signals(cl), ::testing::Contains(FlightSignal::kAlpha));
}

TEST(CoefficientRows, LeaveOutWhatIsMissingAndBeginASegmentBehindIt) {
  FlightSignals s = constant_signals();
  const Subject subject = builtin_subject("unatrap");
  s[FlightSignal::kAlpha].value[30] = kNaN;
  const CoefficientModel cl{Coefficient::kCL, {parse_term("1", "t"), parse_term("alpha", "t")}, {kNaN, kNaN}};
  const estimation::RegressionData data = coefficient_data(cl, s, std::vector<TimeSpan>{{0.0, 10.0}}, subject);
  ASSERT_EQ(data.rows(), 100);
  EXPECT_EQ(data.segment[29], data.segment[0]);
  EXPECT_NE(data.segment[30], data.segment[29]);
  EXPECT_EQ(data.segment[30], data.segment.back());
}

TEST(CoefficientRows, AreRefusedByTheNameOfWhatTheLogLacks) {
  const Subject subject = builtin_subject("unatrap");
  FlightSignals s = constant_signals();
  EXPECT_THAT(identification_obstacle(subject.model.at(Coefficient::kCD), s, subject),
              ::testing::HasSubstr("CD needs the thrust"));
  EXPECT_EQ(identification_obstacle(subject.model.at(Coefficient::kCm), s, subject), "");
  s[FlightSignal::kElevator].value.clear();
  EXPECT_EQ(identification_obstacle(subject.model.at(Coefficient::kCm), s, subject),
            "Cm needs elevator, which the log does not have");
}

TEST(CoefficientRows, AxisOfACoefficientIsWhatItsMotionIs) {
  for (const Coefficient c : {Coefficient::kCL, Coefficient::kCD, Coefficient::kCm})
    EXPECT_EQ(axis_of(c), Axis::kLongitudinal);
  for (const Coefficient c : {Coefficient::kCY, Coefficient::kCl, Coefficient::kCn})
    EXPECT_EQ(axis_of(c), Axis::kLateral);
}

}  // namespace
}  // namespace veridyn::aircraft
