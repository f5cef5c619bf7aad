#include "veridyn/vehicle/tracking/known_body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/vehicle/campaign/rolling_cars.hpp"
#include "tests/vehicle/drive_with_drop.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using ::testing::HasSubstr;

estimation::Estimate estimate_of(const std::vector<std::pair<std::string, double>>& values) {
  estimation::Estimate out;
  for (const auto& [name, value] : values)
    out.parameters.push_back({.name = name,
                              .value = value,
                              .sigma = 0.1 * std::abs(value),
                              .status = estimation::ParameterStatus::kIdentified});
  const auto n = static_cast<Eigen::Index>(values.size());
  out.covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) out.covariance(i, i) = std::pow(0.1 * values[i].second, 2);
  return out;
}

TEST(KnownBody, IsThatOfTheEstimate) {
  const KnownBody body = known_body(estimate_of({{"C_f", 50000.0},
                                                 {"C_r", 60000.0},
                                                 {"I_z", 2500.0},
                                                 {"roll_gradient", 0.009},
                                                 {"roll_frequency", 8.0},
                                                 {"roll_damping", 0.2},
                                                 {"roll_arm", 0.45},
                                                 {"relaxation_length", 0.35},
                                                 {"mu", 0.9},
                                                 {"load_transfer", 0.6}}),
                                    family_car(), {});
  EXPECT_EQ(body.source, BodySource::kEstimate);
  EXPECT_EQ(body.I_z, 2500.0);
  EXPECT_EQ(body.roll.gradient, 0.009);
  EXPECT_EQ(body.roll.frequency, 8.0);
  EXPECT_EQ(body.roll.damping, 0.2);
  EXPECT_EQ(body.roll.arm, 0.45);
  EXPECT_EQ(body.relaxation_length, 0.35);
  using Fiala = RollingBicycle<double, FialaTyre<double>>;
  ASSERT_TRUE(std::holds_alternative<Fiala>(body.tyres));
  const Fiala& car = std::get<Fiala>(body.tyres);
  EXPECT_EQ(car.bicycle.front.mu, 0.9);
  EXPECT_EQ(car.bicycle.rear.stiffness, 60000.0);
  EXPECT_EQ(car.load_transfer.share, 0.6);
  EXPECT_THAT(body.text,
              HasSubstr("I_z 2500 kg m^2, a body that leans 5.1 deg per g at 1.3 Hz, tyres that follow after "
                        "0.35 m and saturate"));
}

// An estimate of equation error, or of a tracked drive, has less.
TEST(KnownBody, DoesNotLeanWhereTheEstimateDoesNot) {
  const KnownBody body = known_body(estimate_of({{"C_f", 50000.0}, {"C_r", 60000.0}}), family_car(), {});
  EXPECT_EQ(body.I_z, family_car().I_z);
  EXPECT_EQ(body.roll.gradient, 0.0);
  EXPECT_EQ(body.relaxation_length, 0.0);
  EXPECT_TRUE(is_linear(body.tyres));
  EXPECT_EQ(body.sigma, (std::array{0.0, 0.0, 0.0}));
  EXPECT_THAT(body.text, HasSubstr("a body that does not lean, tyres that push at once"));
}

// Of two correlated normal variables the part of one's variance that the other explains is correlation^2.
TEST(KnownBody, SaysWhatItsOwnErrorMakesOfTheStiffnesses) {
  estimation::Estimate estimate = estimate_of({{"C_f", 50000.0}, {"C_r", 60000.0}, {"I_z", 2500.0}});
  estimate.covariance(0, 2) = estimate.covariance(2, 0) =
      0.8 * std::sqrt(estimate.covariance(0, 0) * estimate.covariance(2, 2));
  const KnownBody body = known_body(estimate, family_car(), {});
  EXPECT_NEAR(body.sigma[0], 0.8 * 0.1, 1e-9);
  EXPECT_NEAR(body.sigma[1], 0.0, 1e-9);
  EXPECT_GT(body.sigma[2], 0.0);
  estimate.fit["C_f.structure_doubt"] = 0.06 * 50000.0;
  EXPECT_NEAR(known_body(estimate, family_car(), {}).sigma[0], 0.1, 1e-9);
}

TEST(KnownBody, SaysThatItsEstimateWasNotAccepted) {
  estimation::Estimate estimate = estimate_of({{"C_f", 50000.0}, {"C_r", 60000.0}, {"I_z", 2500.0}});
  EXPECT_TRUE(known_body(estimate, family_car(), {}).accepted);
  estimate.parameters[0].status = estimation::ParameterStatus::kRejected;
  const KnownBody body = known_body(estimate, family_car(), {});
  EXPECT_FALSE(body.accepted);
  EXPECT_THAT(body.text, HasSubstr("not accepted"));
}

TEST(KnownBody, DoesNotLeanByNumbersThatNoBodyHas) {
  for (const double damping : {0.0, -0.2}) {
    const KnownBody body = known_body(estimate_of({{"C_f", 50000.0},
                                                   {"C_r", 60000.0},
                                                   {"I_z", 2500.0},
                                                   {"roll_gradient", 0.009},
                                                   {"roll_frequency", 8.0},
                                                   {"roll_damping", damping},
                                                   {"roll_arm", 0.45}}),
                                      family_car(), {});
    EXPECT_EQ(body.roll.gradient, 0.0) << damping;
  }
}

TEST(LearnedBody, LeansAsTheCarDoes) {
  const testing::RollingCar car = testing::rolling_car(1);
  const VehicleStudy study = testing::rolling_drive(car, testing::CarTyre::kLinear, 4, 3, {.duration_s = 60.0});
  Progress silent;
  const KnownBody body = learned_body(prepare_drive_signals(study.log.mapped, study.signals), study.segments,
                                      study.vehicle, study.signals, study.identify, silent);
  EXPECT_EQ(body.source, BodySource::kLearned);
  EXPECT_NEAR(body.I_z, car.parameters.I_z, 2.0 * body.sigma[0] * car.parameters.I_z);
  // The springs of tyres and body in series, as one mode.
  EXPECT_NEAR(body.roll.gradient, car.roll_gradient, 0.4 * car.roll_gradient);
  EXPECT_THAT(body.text, HasSubstr("learned from the first 60 s"));
  EXPECT_GT(body.sigma[0], 0.0);
  EXPECT_LT(body.sigma[0], 0.15);
}

TEST(LearnedBody, IsNoneWhereTheDriveDoesNotShowIt) {
  const VehicleStudy study = testing::study_of(testing::drive_with_drop(1, 40.0, 1e9, 1e-5));
  Progress silent;
  const KnownBody body = learned_body(prepare_drive_signals(study.log.mapped, study.signals), study.segments,
                                      study.vehicle, study.signals, study.identify, silent);
  EXPECT_EQ(body.source, BodySource::kNone);
  EXPECT_EQ(body.I_z, study.vehicle.I_z);
  EXPECT_THAT(body.text, HasSubstr("taken for a car that does not lean"));
}

}  // namespace
}  // namespace veridyn::vehicle
