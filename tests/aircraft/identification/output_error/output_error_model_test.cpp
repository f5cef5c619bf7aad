#include "veridyn/aircraft/identification/output_error/output_error_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {
namespace {

TEST(OutputErrorModel, MovesAsTheBodyAxesDynamicsDo) {
  // Signals of a grid whose "measured" states are arbitrary; one integration step against flight_dynamics.hpp, which
  // knows inertial velocity and a quaternion instead.
  Study study = Study::parse(std::string("[subject]\nbuiltin = \"unatrap\"\n"), "s.toml");
  const Subject subject = read_subject(study.root().table("subject"));
  FlightSignals signals;
  signals.grid = {0.0, 2e-4, 10501};
  const std::size_t n = signals.size();
  const auto fill = [&](FlightSignal s, double value) { signals[s].value.assign(n, value); };
  for (std::size_t i = 0; i < kFlightSignals; ++i) fill(static_cast<FlightSignal>(i), 0.0);
  const double Va = 19.0, alpha = 0.08, beta = -0.05, p = 0.4, q = -0.2, r = 0.3, phi = 0.5, theta = 0.1;
  fill(FlightSignal::kAirspeed, Va);
  fill(FlightSignal::kAlpha, alpha);
  fill(FlightSignal::kBeta, beta);
  fill(FlightSignal::kP, p);
  fill(FlightSignal::kQ, q);
  fill(FlightSignal::kR, r);
  fill(FlightSignal::kElevator, 0.03);
  fill(FlightSignal::kAileron, -0.04);
  fill(FlightSignal::kRudder, 0.05);
  signals.air_density.assign(n, 1.2);
  signals.roll.assign(n, phi);
  signals.pitch.assign(n, theta);
  signals.yaw.assign(n, 0.0);
  std::vector<CoefficientModel> models;
  for (const auto& c : subject.model.coefficients) models.push_back(*c);
  const OutputErrorModel model(signals, std::vector<TimeSpan>{{0.0, 2.1}}, subject, models, false);
  ASSERT_EQ(model.outputs().size(), 11u);
  Eigen::VectorXd theta_all(model.parameters().size() + 8);
  Eigen::Index at = 0;
  for (const auto& parameter : model.parameters()) theta_all(at++) = parameter.start;
  for (const auto& initial : model.initial_conditions(0)) theta_all(at++) = initial.start;
  estimation::ModelResponse response;
  ASSERT_TRUE(model.respond(0, theta_all, {}, response));

  Subject glider = subject;  // thrust is a measured input here, 0
  glider.propulsion = {};
  glider.model.stall.reset();
  const Eigen::Vector3d v(Va * std::cos(alpha) * std::cos(beta), Va * std::sin(beta),
                          Va * std::sin(alpha) * std::cos(beta));
  const Controls<double> controls{.de = 0.03, .da = -0.04, .dr = 0.05};
  const AeroLoads<double> loads = aero_loads<double>(glider, v, Eigen::Vector3d(p, q, r), controls, 1.2);
  // Specific forces at the first sample.
  for (Eigen::Index i = 0; i < 3; ++i) EXPECT_NEAR(response.output(0, 8 + i), loads.force(i) / glider.mass, 1e-12);
  // Slopes of the body rates from the first four samples, 0.4 ms apart.
  Eigen::Matrix3d J;
  const Inertia& I = *glider.inertia;
  J << I.Jx, 0.0, -I.Jxz, 0.0, I.Jy, 0.0, -I.Jxz, 0.0, I.Jz;
  const Eigen::Vector3d omega(p, q, r);
  const Eigen::Vector3d slope = J.inverse() * (loads.moment - omega.cross(J * omega));
  const double h = 4e-4;
  for (Eigen::Index i = 0; i < 3; ++i) {
    // Error h^3/4 of the fourth derivative, which the roll mode (30 1/s) makes 20 30^3.
    const auto y = [&](Eigen::Index k) { return response.output(k, 3 + i); };
    const double measured = (-11.0 * y(0) + 18.0 * y(1) - 9.0 * y(2) + 2.0 * y(3)) / (6.0 * h);
    EXPECT_NEAR(measured, slope(i), 2e-5 * (1.0 + std::abs(slope(i)))) << i;
  }
  // Airspeed and flow angles: v' = F/m + g - omega x v.
  const Eigen::Vector3d gravity =
      9.80665 * Eigen::Vector3d(-std::sin(theta), std::cos(theta) * std::sin(phi), std::cos(theta) * std::cos(phi));
  const Eigen::Vector3d dv = loads.force / glider.mass + gravity - omega.cross(v);
  const double e = 1e-6;
  const Eigen::Vector3d later = v + e * dv;
  const double slopes[] = {(later.norm() - Va) / e, (std::atan2(later.z(), later.x()) - alpha) / e,
                           (std::asin(later.y() / later.norm()) - beta) / e};
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto y = [&](Eigen::Index k) { return response.output(k, i); };
    const double measured = (-11.0 * y(0) + 18.0 * y(1) - 9.0 * y(2) + 2.0 * y(3)) / (6.0 * h);
    EXPECT_NEAR(measured, slopes[i], 1e-4 * (1.0 + std::abs(slopes[i]))) << i;
  }
}

TEST(OutputErrorModel, DrivesWhatIsNotModelledByItsMeasurement) {
  Study study = Study::parse(std::string("[subject]\nbuiltin = \"unatrap\"\n"), "s.toml");
  const Subject subject = read_subject(study.root().table("subject"));
  FlightSignals signals;
  signals.grid = {0.0, 0.02, 201};
  for (std::size_t i = 0; i < kFlightSignals; ++i)
    signals[static_cast<FlightSignal>(i)].value.assign(signals.size(), 0.0);
  signals[FlightSignal::kAirspeed].value.assign(signals.size(), 20.0);
  signals[FlightSignal::kAz].value.assign(signals.size(), -9.8);
  signals[FlightSignal::kAlpha].value[100] = std::nan("");  // a hole: two segments of 2 s
  for (auto* v : {&signals.roll, &signals.pitch, &signals.yaw}) v->assign(signals.size(), 0.0);
  signals.air_density.assign(signals.size(), 1.2);
  const std::vector<CoefficientModel> only_lift{subject.model.at(Coefficient::kCL)};
  const OutputErrorModel model(signals, std::vector<TimeSpan>{{0.0, 4.0}}, subject, only_lift, false);
  ASSERT_EQ(model.outputs().size(), 2u);
  EXPECT_EQ(model.outputs()[0].name, "alpha");
  EXPECT_EQ(model.outputs()[1].name, "accel_z");
  ASSERT_EQ(model.segments(), 2u);
  EXPECT_EQ(model.samples(0), 100);
  EXPECT_EQ(model.segment_name(1), "the segment from 2.0 to 4.0 s");
  EXPECT_EQ(model.initial_conditions(0).size(), 1u);
}

// One set of parameters; each segment its own initial state, and no segment of one flight in the inputs of another.
TEST(OutputErrorModel, OfTwoFlightsSharesTheParameters) {
  const Subject subject = builtin_subject("unatrap");
  std::array<FlightSignals, 2> flights;
  for (std::size_t f = 0; f < 2; ++f) {
    FlightSignals& signals = flights[f];
    signals.grid = {0.0, 0.02, 251};
    for (auto& signal : signals.signals) signal.value.assign(signals.size(), 0.0);
    signals[FlightSignal::kAirspeed].value.assign(signals.size(), 19.0 + static_cast<double>(f));
    signals.air_density.assign(signals.size(), 1.2);
    for (auto* angle : {&signals.roll, &signals.pitch, &signals.yaw}) angle->assign(signals.size(), 0.0);
  }
  const std::vector<TimeSpan> spans{{0.0, 4.0}};
  const std::vector<CoefficientModel> models{*subject.model.find(Coefficient::kCL),
                                             *subject.model.find(Coefficient::kCD)};
  const std::array both{OutputErrorModel::FlownSpans{flights[0], spans, false, "a.csv"},
                        OutputErrorModel::FlownSpans{flights[1], spans, false, "b.csv"}};
  const OutputErrorModel model(both, subject, models), alone(flights[1], spans, subject, models, false);
  ASSERT_EQ(model.segments(), 2u);
  EXPECT_EQ(model.parameters().size(), alone.parameters().size());
  EXPECT_EQ(model.segment_name(1), "the segment from 0.0 to 4.0 s of b.csv");
  EXPECT_EQ(alone.segment_name(0), "the segment from 0.0 to 4.0 s");
  EXPECT_EQ(model.initial_conditions(0)[0].start, 19.0);
  EXPECT_EQ(model.initial_conditions(1)[0].start, 20.0);
  EXPECT_EQ(model.measured()[1], alone.measured()[0]);
}

}  // namespace
}  // namespace veridyn::aircraft
