#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/aircraft/exact_sensors.hpp"
#include "veridyn/aircraft/model/air_data.hpp"
#include "veridyn/core/constants.hpp"

/// Vanes that show something else than the flow at the centre of gravity, and a study that says so.
namespace veridyn::aircraft {
namespace {

using aircraft::testing::campaign_flight;
using aircraft::testing::Identified;
using aircraft::testing::identified;
using Vector = Eigen::Vector3d;

/// What alpha and beta are shown where the flow at the centre of gravity is `v` and the aircraft turns by `rates`.
using Shown = std::function<std::array<double, 2>(const Vector& v, const Vector& rates)>;

/// The flight whose vanes differ from those of the centre of gravity by what the true motion makes of it.
FlightStudy with_vanes(FlightStudy study, const Shown& shown) {
  const auto true_at = [&](const char* name, std::span<const double> stamps) {
    return recording::interpolated(study.truth->at(name), stamps);
  };
  for (const int i : {0, 1}) {
    Channel vane = study.mapped.recording.at(i == 0 ? "alpha" : "beta");
    const auto Va = true_at("airspeed", vane.times()), alpha = true_at("alpha", vane.times()),
               beta = true_at("beta", vane.times()), p = true_at("gyro_x", vane.times()),
               q = true_at("gyro_y", vane.times()), r = true_at("gyro_z", vane.times());
    for (std::size_t k = 0; k < vane.size(); ++k) {
      const std::array<double, 2> there = shown(air_velocity(Va[k], alpha[k], beta[k]), Vector(p[k], q[k], r[k]));
      const double more = there[static_cast<std::size_t>(i)] - (i == 0 ? alpha[k] : beta[k]);
      if (std::isfinite(more)) vane.value[k] += more;
    }
    study.mapped.recording.set(vane);
  }
  return study;
}

double value(const Identified& flight, const std::string& name) {
  for (const estimation::ParameterGroup& group : flight.analysis.groups)
    for (const estimation::Parameter& p : group.parameters)
      if (p.name == name) return p.value;
  ADD_FAILURE() << "there is no " << name;
  return kNaN;
}

/// The largest difference of the parameters of two flights, over the standard errors of the first.
std::pair<double, std::string> largest_difference(const Identified& one, const Identified& other) {
  std::pair<double, std::string> largest{0.0, "none"};
  std::size_t compared = 0;
  for (const estimation::ParameterGroup& group : one.analysis.groups) {
    for (const estimation::Parameter& p : group.parameters) {
      if (p.status != estimation::ParameterStatus::kIdentified) continue;
      ++compared;
      const double difference = std::abs(value(other, p.name) - p.value) / p.sigma;
      if (!(difference <= largest.first)) largest = {difference, p.name};
    }
  }
  EXPECT_GT(compared, 15U);
  return largest;
}

// What rotation adds at the end of a boom is not the aircraft's. Two standard errors: the noise of both flights is the
// same, but the method that suits a coefficient may be another.
TEST(VanesOnABoom, AreMovedToTheCentreOfGravity) {
  const FlightStudy clean = aircraft::testing::with_exact_sensors(campaign_flight("unatrap", 3, 120.0, "none"));
  const Vector boom(2.0, 0.0, 0.0);
  FlightStudy study = with_vanes(clean, [&](const Vector& v, const Vector& rates) -> std::array<double, 2> {
    const AirData<double> there = air_data<double>(Vector(v + rates.cross(boom)));
    return {there.alpha, there.beta};
  });
  study.reconstruct.vane_position = boom;
  const Identified expected = identified(clean);
  const auto [difference, name] = largest_difference(expected, identified(study));
  EXPECT_LT(difference, 2.0) << name;
  // That the flight can tell: the same vanes without a word of the boom.
  study.reconstruct.vane_position = Vector::Zero();
  EXPECT_GT(largest_difference(expected, identified(study)).first, 5.0);
}

TEST(VanesInUpwash, AreDividedByTheScaleThatTheReconstructionFinds) {
  const FlightStudy clean = campaign_flight("unatrap", 3, 120.0, "none");
  FlightStudy study = with_vanes(clean, [](const Vector& v, const Vector&) -> std::array<double, 2> {
    const AirData<double> there = air_data<double>(v);
    return {1.12 * there.alpha, there.beta};
  });
  const double lift_slope = value(identified(aircraft::testing::with_exact_sensors(clean)), "CL_alpha");
  // The check of the vane's scale in manoeuvres finds it to 2 %, where the study does not say that the vane is right.
  EXPECT_NEAR(value(identified(study), "CL_alpha") / lift_slope, 1.0, 0.05);
  study = aircraft::testing::with_exact_sensors(std::move(study));
  EXPECT_NEAR(value(identified(study), "CL_alpha") / lift_slope, 1.0 / 1.12, 0.02) << "that the flight can tell";
  study.reconstruct.alpha_scale = true;
  study.reconstruct.filter = FilterKind::kModelBased;  // which sees it in calm air
  EXPECT_NEAR(value(identified(study), "CL_alpha") / lift_slope, 1.0, 0.03);
}

}  // namespace
}  // namespace veridyn::aircraft
