#include "veridyn/aircraft/tracking/filter_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// What a filter leaves at every second from `begin` on: an angle of attack, and whether the model was used.
Recording piece(double begin, double alpha, const std::vector<double>& model_based) {
  std::vector<double> time;
  for (std::size_t i = 0; i < model_based.size(); ++i) time.push_back(begin + static_cast<double>(i));
  const TimeBase stamps = make_time_base(std::move(time));
  Recording r;
  const auto add = [&](const char* name, const char* unit, double value) {
    r.add(make_channel(name, unit, stamps, std::vector<double>(model_based.size(), value)));
  };
  add("airspeed", "m/s", 20.0);
  add("sigma_airspeed", "m/s", 0.5);
  add("alpha", "rad", alpha);
  add("sigma_alpha", "rad", 0.01);
  add("beta", "rad", 0.0);
  add("sigma_beta", "rad", 0.01);
  for (const char* wind : {"wind_north", "wind_east", "wind_down"}) add(wind, "m/s", 1.0);
  add("guard_ratio", "1", 0.5);
  r.add(make_channel("model_based", "1", stamps, model_based));
  return r;
}

FilterModel study_model(double from_s) {
  FilterModel model;
  model.from_s = from_s;
  model.aero = builtin_subject("unatrap").model;
  model.source = {ModelSource::kStudy, ModelSource::kStudy, ModelSource::kTracked};
  model.reason = "CY identified";
  return model;
}

TEST(FilterHistory, TakesPiecesThatOverlapOnce) {
  FilterHistory history;
  EXPECT_TRUE(history.empty());
  history.append(piece(0.0, 0.1, {0, 0, 1, 1}), piece(0.0, 0.2, {0, 0, 0, 0}));
  history.append(piece(2.0, 0.1, {1, 1, 0, 1}), piece(2.0, 0.2, {0, 0, 0, 0}));
  EXPECT_THAT(history.time(), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_DOUBLE_EQ(history.model_based_share(), 0.5);
  EXPECT_EQ(history.reverts(), 1U);
  const std::vector<TimeSpan> free = history.model_free();
  ASSERT_EQ(free.size(), 2U);
  EXPECT_EQ(free[0].begin, 0.0);
  EXPECT_EQ(free[0].end, 1.0);
  EXPECT_EQ(free[1].begin, 4.0);
  EXPECT_EQ(free[1].end, 4.0);
}

// Where a sensor was lost the model-free filter ends, and with it what can be said.
TEST(FilterHistory, EndsWithTheModelFreeFilter) {
  FilterHistory history;
  history.append(piece(0.0, 0.1, {1, 1, 1, 1}), piece(0.0, 0.2, {0, 0}));
  EXPECT_THAT(history.time(), ElementsAre(0, 1));
  history.append({}, {});
  EXPECT_EQ(history.time().size(), 2U) << "a piece without samples";
}

TEST(FilterHistory, SaysWhereTheModelInUseComesFrom) {
  FilterHistory history;
  history.append(piece(0.0, 0.1, {0, 0, 1, 1}), piece(0.0, 0.2, {0, 0, 0, 0}));
  history.add_model(study_model(2.0));
  const Recording recording = history.recording();
  EXPECT_THAT(recording.at("model_CL").value, ElementsAre(0, 0, 1, 1));
  EXPECT_THAT(recording.at("model_CY").value, ElementsAre(0, 0, 2, 2));
  EXPECT_THAT(recording.at("alpha").value, ElementsAre(0.1, 0.1, 0.1, 0.1));
  EXPECT_THAT(recording.at("alpha_model_free").value, ElementsAre(0.2, 0.2, 0.2, 0.2));
  EXPECT_EQ(history.statement(),
            "The model-based filter was used 50 % of the time; it was never taken back; models given: 1.");
}

// From the tenth second on; the truth grows by 0.01 rad/s from 0.05 rad on, and is known until the 14th second.
TEST(FilterHistory, ComparesBothFiltersWithTheTruth) {
  FilterHistory history;
  history.append(piece(0.0, 0.15, std::vector<double>(20, 1.0)), piece(0.0, 0.25, std::vector<double>(20, 0.0)));
  Recording truth;
  truth.add(make_channel("alpha", "rad", make_time_base({0.0, 14.0}), {0.05, 0.19}));
  const std::vector<TrackedFilterError> errors = history.errors(truth);
  ASSERT_EQ(errors.size(), 1U) << "of the airspeed nothing is known";
  EXPECT_EQ(errors[0].quantity, "alpha");
  double guarded = 0.0, free = 0.0;
  for (int t = 10; t <= 14; ++t) {
    guarded += std::pow(0.15 - (0.05 + 0.01 * t), 2) / 5.0;
    free += std::pow(0.25 - (0.05 + 0.01 * t), 2) / 5.0;
  }
  EXPECT_NEAR(errors[0].guarded, std::sqrt(guarded), 1e-12);
  EXPECT_NEAR(errors[0].model_free, std::sqrt(free), 1e-12);
}

TEST(ModelsCsv, HasALinePerCoefficientOfEachModel) {
  FilterModel none;
  none.from_s = -std::numeric_limits<double>::infinity();
  none.reason = "CL is not known";
  const std::string text = models_csv({none, study_model(12.5)});
  EXPECT_THAT(text, ::testing::StartsWith("from[s],coefficient,source,sigma,values,reason\n,CL,none,,"));
  EXPECT_THAT(text, HasSubstr("12.5,CY,tracked,"));
  EXPECT_THAT(text, HasSubstr("CL_alpha = "));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 7);
}

}  // namespace
}  // namespace veridyn::aircraft
