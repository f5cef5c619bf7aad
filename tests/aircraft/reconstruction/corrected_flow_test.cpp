#include "veridyn/aircraft/reconstruction/corrected_flow.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "veridyn/aircraft/model/air_data.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;
using Vector = Eigen::Vector3d;

/// A flight of formulas, whose vanes show what the sensors' definition says.
struct TurningFlight {
  explicit TurningFlight(const FlowSensors& of) : sensors(of) {
    for (int k = 0; k < 400; ++k) {
      const double t = 0.01 * k;
      time.push_back(t);
      const Vector v = air_velocity(22.0 + std::sin(t), 0.1 + 0.05 * std::sin(3.0 * t), 0.08 * std::cos(2.0 * t));
      const Vector rates(0.6 * std::cos(t), 0.4 * std::sin(2.0 * t), -0.3 * std::cos(3.0 * t));
      const Vector there = v + rates.cross(sensors.position);
      const AirData<double> at_centre = air_data<double>(v), at_vane = air_data<double>(there);
      airspeed.push_back(at_centre.Va);
      alpha.push_back(at_centre.alpha);
      beta.push_back(at_centre.beta);
      shown_alpha.push_back((1.0 + sensors.alpha_scale) * at_vane.alpha + sensors.alpha_bias);
      shown_beta.push_back((sensors.beta_is_flank ? std::atan2(there.y(), there.x()) : at_vane.beta) +
                           sensors.beta_bias);
      for (int i = 0; i < 3; ++i) rate[static_cast<std::size_t>(i)].push_back(rates(i));
    }
  }
  [[nodiscard]] static Channel channel(const std::string& name, const char* unit, const std::vector<double>& time,
                                       const std::vector<double>& value) {
    return make_channel(name, unit, make_time_base(std::vector<double>(time)), std::vector<double>(value));
  }
  [[nodiscard]] recording::MappedRecording recorded(bool with_alpha = true, bool with_beta = true) const {
    recording::MappedRecording mapped;
    const char* const gyros[] = {"gyro_x", "gyro_y", "gyro_z"};
    for (std::size_t i = 0; i < 3; ++i) mapped.recording.add(channel(gyros[i], "rad/s", time, rate[i]));
    if (with_alpha) mapped.recording.add(channel("alpha", "rad", time, shown_alpha));
    if (with_beta) mapped.recording.add(channel("beta", "rad", time, shown_beta));
    return mapped;
  }
  [[nodiscard]] Recording reconstructed() const {
    Recording smoothed;
    smoothed.add(channel("airspeed", "m/s", time, airspeed));
    smoothed.add(channel("alpha", "rad", time, alpha));
    smoothed.add(channel("beta", "rad", time, beta));
    return smoothed;
  }
  FlowSensors sensors;
  std::vector<double> time, airspeed, alpha, beta, shown_alpha, shown_beta, rate[3];
};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::fmax(largest, std::abs(a[k] - b[k]));
  return largest;
}

TEST(CorrectedFlow, IsThatOfTheCentreOfGravity) {
  for (const FlowSensors& sensors :
       {FlowSensors{.position = {14.0, 0.5, -0.4}}, FlowSensors{.alpha_bias = 0.03, .beta_bias = -0.02},
        FlowSensors{.alpha_scale = 0.12}, FlowSensors{.beta_is_flank = true},
        FlowSensors{.position = {3.0, -1.0, 0.2},
        .beta_is_flank = true,
        .alpha_bias = 0.01,
        .beta_bias = 0.02,
        .alpha_scale = 0.2}}) {
    const TurningFlight flight(sensors);
    const CorrectedFlow flow = with_corrected_flow(flight.recorded(), sensors, flight.reconstructed());
    EXPECT_LT(largest_difference(flow.mapped.recording.at("alpha").value, flight.alpha), 1e-12) << flow.note;
    EXPECT_LT(largest_difference(flow.mapped.recording.at("beta").value, flight.beta), 1e-12) << flow.note;
    EXPECT_THAT(flow.note, HasSubstr("vanes: "));
  }
}

TEST(CorrectedFlow, TakesTheReconstructionsAngleWhereOneVaneIsMissing) {
  const FlowSensors sensors{.position = {14.0, 0.0, 0.0}, .alpha_scale = 0.12};
  const TurningFlight flight(sensors);
  const CorrectedFlow alone = with_corrected_flow(flight.recorded(true, false), sensors, flight.reconstructed());
  EXPECT_LT(largest_difference(alone.mapped.recording.at("alpha").value, flight.alpha), 1e-12);
  EXPECT_FALSE(alone.mapped.recording.has("beta"));
}

TEST(CorrectedFlow, LeavesAloneWhatIsExactAndGivesNoAngleWithoutAirspeed) {
  const TurningFlight flight(FlowSensors{});
  const CorrectedFlow exact = with_corrected_flow(flight.recorded(), {}, flight.reconstructed());
  EXPECT_EQ(exact.mapped.recording.at("alpha").value, flight.shown_alpha);
  EXPECT_EQ(exact.note, "");
  // The reconstruction ends in the middle.
  Recording half;
  half.add(TurningFlight::channel("airspeed", "m/s", {flight.time.begin(), flight.time.begin() + 200},
                                  {flight.airspeed.begin(), flight.airspeed.begin() + 200}));
  const CorrectedFlow flow = with_corrected_flow(flight.recorded(), FlowSensors{.position = {1.0, 0.0, 0.0}}, half);
  EXPECT_TRUE(std::isfinite(flow.mapped.recording.at("alpha").value[199]));
  EXPECT_TRUE(std::isnan(flow.mapped.recording.at("alpha").value[201]));
}

TEST(FlowSensors, AreWhatTheStudySaysAndTheReconstructionFound) {
  ReconstructOptions options;
  options.vane_position = Vector(1.0, 2.0, 3.0);
  Recording smoothed;
  const std::vector<double> time{0.0, 1.0, 2.0};
  smoothed.add(TurningFlight::channel("alpha_scale", "1", time, {0.12, 0.12, 0.3}));
  const FlowSensors sensors = flow_sensors(options, smoothed);
  EXPECT_EQ(sensors.alpha_scale, 0.12);
  EXPECT_EQ(sensors.alpha_bias, 0.0);
  EXPECT_EQ(sensors.position, options.vane_position);
}

}  // namespace
}  // namespace veridyn::aircraft
