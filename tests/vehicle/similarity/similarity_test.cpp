#include "veridyn/vehicle/similarity/similarity.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include "tests/support/refusal.hpp"
#include "tests/vehicle/similarity/builtin_subject.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/vehicle/model/bicycle_model.hpp"
#include "veridyn/vehicle/model/builtin_vehicles.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {
namespace {

using testing::subject_of;

using MotionState = Eigen::Matrix<double, 5, 1>;  // v, r, yaw, x, y

/// The reference manoeuvre of the linear bicycle with `step` [s] of its time, until 20 of them in units of `time`.
MotionState reference_run(const VehicleParameters<double>& p, double u, double time, double until) {
  const BicycleModel<double, LinearTyre<double>> model{
      p, {.stiffness = p.C_f}, {.stiffness = p.C_r}, 9.80665, BicycleGeometry::kSmallAngles};
  const auto derivative = [&](double t, const MotionState& s) {
    const double steer =
        5.0 * kDegree * std::min(std::clamp(t / time - 2.0, 0.0, 1.0), std::clamp(16.0 - t / time, 0.0, 1.0));
    const BicycleRates<double> rates = model.rates(s(0), s(1), steer, u);
    MotionState d;
    d << rates.dv, rates.dr, s(1), u * std::cos(s(2)) - s(0) * std::sin(s(2)),
        u * std::sin(s(2)) + s(0) * std::cos(s(2));
    return d;
  };
  MotionState s = MotionState::Zero();
  const int steps = static_cast<int>(std::lround(until * 1000.0));
  for (int k = 0; k < steps; ++k) s = numerics::runge_kutta_4_step(derivative, k * 1e-3 * time, s, 1e-3 * time);
  return s;
}

TEST(Similarity, HasOneGroupForEachQuantityBeyondTheRank) {
  SimilaritySubject subject = subject_of("reference");
  const auto formulas = [&](std::span<const std::string> repeating) {
    std::set<std::string> set;
    const auto groups = similarity_groups(subject, repeating);
    EXPECT_EQ(groups.size(), similarity_parameters(subject).size() - 3U);
    for (const auto& group : groups) set.insert(group.formula);
    return set;
  };
  const std::set<std::string> groups = formulas(default_repeating_variables());
  for (const char* formula : {"a/L", "b/L", "W_f/L", "c/L", "M_w/m", "I_z/(m L^2)", "C_f L/(m u^2)", "K_sf L^2/(m u^2)",
                              "K_tr L^2/(m u^2)", "C_sf L/(m u)", "g L/u^2"}) {
    EXPECT_TRUE(groups.contains(formula)) << formula;
  }
  EXPECT_FALSE(groups.contains("mu"));
  subject.parameters.mu = 0.9;
  subject.steer = 0.1;
  EXPECT_TRUE(formulas(default_repeating_variables()).contains("mu"));
  EXPECT_TRUE(formulas(default_repeating_variables()).contains("delta"));
  EXPECT_TRUE(formulas(std::array<std::string, 3>{"M_w", "c", "g"}).contains("u/(c^(1/2) g^(1/2))"));
}

TEST(Similarity, GivesAQuantityOfTheUserItsGroup) {
  SimilaritySubject prototype = subject_of("reference");
  prototype.further = {{"motor_torque_gradient", "dT", 3.0, parse_unit("N m s/rad"), "drive"},
                       {"air_density", "rho", 1.2, parse_unit("kg/m^3"), "drag"}};
  const ScaledVehicle twin = scale(prototype, {.length_ratio = 0.2});
  EXPECT_NEAR(twin.model.further[0].value, 3.0 / 125.0 / 25.0, 1e-15);  // torque 1/3125, on the same time axis
  EXPECT_NEAR(twin.model.further[1].value, 1.2, 1e-15);
  const SimilarityReport same = compare(prototype, twin.model);
  EXPECT_TRUE(same.similar_without_gravity()) << same.message();
  const auto found = std::ranges::find(same.groups, "motor_torque_gradient", &GroupComparison::parameter);
  ASSERT_NE(found, same.groups.end());
  EXPECT_EQ(found->formula, "dT/(m L u)");
  SimilaritySubject without = twin.model;
  without.further.pop_back();
  const SimilarityReport lacking = compare(prototype, without);
  ASSERT_EQ(lacking.mismatches().size(), 1U);
  EXPECT_EQ(lacking.mismatches()[0].parameter, "air_density");
}

// Groups are numbers without a unit: in any system of units they are the same.
TEST(Similarity, GroupsDoNotDependOnTheSystemOfUnits) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> exponent(-3.0, 3.0);
  const SimilaritySubject subject = subject_of("reference");
  const std::vector<SimilarityParameter> parameters = similarity_parameters(subject);
  const auto reference = similarity_groups(subject);
  for (int round = 0; round < 20; ++round) {
    const std::array<double, 3> unit{std::pow(10.0, exponent(random)), std::pow(10.0, exponent(random)),
                                     std::pow(10.0, exponent(random))};  // m, kg, s
    std::vector<SimilarityParameter> changed = parameters;
    for (SimilarityParameter& p : changed) {
      for (std::size_t i = 0; i < 3; ++i) p.value *= std::pow(unit[i], p.unit.dimension[i]);
    }
    const auto groups = internal::similarity_groups(changed, default_repeating_variables()).groups;
    ASSERT_EQ(groups.size(), reference.size());
    for (std::size_t i = 0; i < groups.size(); ++i) {
      EXPECT_NEAR(groups[i].value, reference[i].value, 1e-12 * std::abs(reference[i].value)) << groups[i].formula;
    }
  }
}

TEST(Similarity, ScalesToThePublishedModelButForItsRounding) {
  const ScaledVehicle twin = scale(subject_of("reference"), {.length_ratio = 0.2});
  const VehicleParameters<double>& p = twin.model.parameters;
  EXPECT_NEAR(p.mass, 8.8, 1e-12);
  EXPECT_NEAR(p.C_f, 96.0, 1e-12);
  EXPECT_NEAR(p.C_r, 192.0, 1e-12);
  EXPECT_NEAR(p.I_x, 0.1888, 1e-12);
  EXPECT_NEAR(p.K_sf, 160.0, 1e-11);
  EXPECT_NEAR(p.C_sf, 80.0, 1e-12);
  EXPECT_NEAR(twin.model.speed, 4.0, 1e-14);
  EXPECT_NEAR(1.0 / twin.factors.force(), 625.0, 1e-10);
  EXPECT_NEAR(twin.similar_gravity, 9.80665 / 5.0, 1e-12);
  EXPECT_TRUE(std::isinf(p.mu));
}

// The reference manoeuvre of the twin, to rounding: the published figures divided by the length ratio.
TEST(Similarity, TheTwinDrivesTheReferenceManoeuvreAtOneFifthTheSize) {
  const SimilaritySubject prototype = subject_of("reference");
  const ScaledVehicle twin = scale(prototype, {.length_ratio = 0.2});
  EXPECT_DOUBLE_EQ(twin.factors.time(), 1.0);
  const MotionState full = reference_run(prototype.parameters, prototype.speed, 1.0, 20.0);
  const MotionState small = reference_run(twin.model.parameters, twin.model.speed, 1.0, 20.0);
  EXPECT_NEAR(small(2) / kDegree, 454.369, 5e-4);
  EXPECT_NEAR(small(3), 15.455, 5e-4);
  const MotionState ten = reference_run(twin.model.parameters, twin.model.speed, 1.0, 10.0);
  EXPECT_NEAR(std::hypot(4.0, ten(0)) / ten(1), 6.557, 5e-4);
  EXPECT_NEAR(small(0) * 5.0, full(0), 1e-11);
  EXPECT_NEAR(small(1), full(1), 1e-12);
  EXPECT_NEAR(small(2), full(2), 1e-11);
  EXPECT_NEAR(small(3) * 5.0, full(3), 1e-9);
  EXPECT_NEAR(small(4) * 5.0, full(4), 1e-9);
}

// Any ratios: the twin runs on the time axis L/u.
TEST(Similarity, TwinsOfAnyLengthMassAndSpeedMoveSimilarly) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-1.0, 1.0);
  const SimilaritySubject prototype = subject_of("reference");
  const MotionState full = reference_run(prototype.parameters, prototype.speed, 1.0, 8.0);
  for (int round = 0; round < 5; ++round) {
    const double length = std::pow(10.0, exponent(random));
    const ScaledVehicle twin = scale(prototype, {.length_ratio = length,
                                                 .mass = 1100.0 * std::pow(10.0, exponent(random)),
                                                 .speed = 20.0 * std::pow(10.0, exponent(random))});
    EXPECT_TRUE(compare(prototype, twin.model).similar_without_gravity());
    const double time = twin.factors.time();
    const MotionState s = reference_run(twin.model.parameters, twin.model.speed, time, 8.0);
    EXPECT_NEAR(s(2), full(2), 1e-10);
    EXPECT_NEAR(s(3) / length, full(3), 1e-9);
    EXPECT_NEAR(s(1) * time, full(1), 1e-11);
  }
}

TEST(Similarity, AFroudeTwinKeepsTheGravityGroup) {
  const SimilaritySubject prototype = subject_of("reference");
  const ScaledVehicle twin = scale(prototype, {.length_ratio = 0.2, .froude = true});
  EXPECT_NEAR(twin.model.speed, 20.0 * std::sqrt(0.2), 1e-12);
  EXPECT_NEAR(twin.similar_gravity, 9.80665, 1e-12);
  const SimilarityReport report = compare(prototype, twin.model);
  EXPECT_TRUE(report.similar()) << report.message();
  EXPECT_TRUE(report.gravity_changes.empty());
  EXPECT_NEAR(twin.factors.acceleration(), 1.0, 1e-14);
  for (const BehaviourComparison& one : report.behaviour) EXPECT_NEAR(one.change_percent, 0.0, 1e-9) << one.name;
}

TEST(Similarity, ChoosesWhatIsNotGivenAndSaysSo) {
  const SimilaritySubject prototype = subject_of("reference");
  EXPECT_NEAR(scale(prototype, {.mass = 8.8}).factors.length, 0.2, 1e-15);
  EXPECT_NEAR(scale(prototype, {.speed = 4.0}).model.parameters.wheelbase(), 0.45, 1e-15);
  EXPECT_NEAR(scale(prototype, {.speed = 10.0, .froude = true}).factors.length, 0.25, 1e-15);
  const ScaledVehicle twin = scale(prototype, {.length_ratio = 0.2});
  ASSERT_EQ(twin.chosen.size(), 2U);
  EXPECT_EQ(twin.chosen[0], "mass 8.8 kg: the same density");
  EXPECT_EQ(twin.chosen[1], "speed 4 m/s: equal times");
}

TEST(Similarity, ScalesATrajectoryThereAndBack) {
  VehicleTrajectory t;
  t.time = {0.0, 1.0};
  t.x = {0.0, 10.0};
  t.r = {0.5, 0.5};
  t.lateral_acceleration = {3.0, 3.0};
  t.roll = {0.1, 0.1};
  t.Fy[0] = {100.0, 100.0};
  const ScaleFactors factors{.length = 0.2, .mass = 0.008, .speed = 0.4};
  const VehicleTrajectory small = scaled(t, factors);
  EXPECT_DOUBLE_EQ(small.time[1], 0.5);
  EXPECT_DOUBLE_EQ(small.x[1], 2.0);
  EXPECT_DOUBLE_EQ(small.r[1], 1.0);
  EXPECT_DOUBLE_EQ(small.lateral_acceleration[0], 3.0 * 0.8);
  EXPECT_DOUBLE_EQ(small.roll[0], 0.1);
  EXPECT_DOUBLE_EQ(small.Fy[0][0], 100.0 * 0.008 * 0.8);
  EXPECT_NEAR(scaled(small, factors.inverse()).Fy[0][0], 100.0, 1e-12);
}

TEST(Similarity, RefusesWhatCannotBeScaled) {
  SimilaritySubject prototype = subject_of("reference");
  const auto refused = [&](const ScaleRequest& request) { return why([&] { (void)scale(prototype, request); }); };
  EXPECT_EQ(refused({}), "scale: needs at least one of length_ratio, mass and speed");
  EXPECT_EQ(refused({.length_ratio = -0.2}), "scale: length_ratio is -0.2 ; must be > 0");
  EXPECT_EQ(refused({.speed = 0.0}), "scale: speed is 0 m/s; must be > 0");
  prototype.further = {{"heat", "heat", 3.0, parse_unit("K"), ""}};
  EXPECT_NE(why([&] { (void)similarity_groups(prototype); }).find("cannot express the dimension of heat [K]"),
            std::string::npos);
  prototype.further = {{"a", "a", 3.0, parse_unit("m"), ""}};
  EXPECT_EQ(why([&] { (void)similarity_groups(prototype); }),
            "parameter a: is there already under this name or symbol");
  prototype.further.clear();
  prototype.speed = 0.0;
  EXPECT_EQ(why([&] { (void)similarity_groups(prototype); }), "vehicle: speed is 0 m/s; must be > 0");
  EXPECT_EQ(why([&] { (void)builtin_vehicle("referense"); }),
            "vehicle: no built-in vehicle is called 'referense' (did you mean 'reference'?)");
  prototype.speed = 20.0;
  EXPECT_EQ(why([&] {
              (void)similarity_groups(prototype, std::array<std::string, 3>{"m", "L", "K_bf"});
            }),
            "repeating variables: K_bf is 0 N/m; a repeating variable must be > 0");
}

TEST(Similarity, ReadsItsStudyTable) {
  const Study study = Study::parse(R"(
[scale]
length_ratio = 0.2
speed = "8 kph"
[[scale.parameter]]
name = "motor_inertia"
symbol = "J_m"
value = "2 kg m^2"
[[scale.parameter]]
name = "backlash"
value = 3
unit = "deg"
)",
                                   "study.toml");
  const StudyTable table = study.root().table("scale");
  const ScaleRequest request = ScaleRequest::keys().read(table);
  EXPECT_EQ(request.length_ratio, 0.2);
  EXPECT_FALSE(request.mass.has_value());
  EXPECT_NEAR(*request.speed, 8.0 / 3.6, 1e-12);
  const auto list = read_similarity_parameters(table);
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].unit.dimension, parse_unit("kg m^2").dimension);
  EXPECT_NEAR(list[1].value, 3.0 * kDegree, 1e-15);
  table.finish();
  const Study wrong = Study::parse("[[scale.parameter]]\nname = \"x\"\nvalue = \"2 kgm\"\n", "study.toml");
  EXPECT_TRUE(why([&] {
                (void)read_similarity_parameters(wrong.root().table("scale"));
              }).starts_with("study.toml:3: scale.parameter"));
}

}  // namespace
}  // namespace veridyn::vehicle
