#include "veridyn/aircraft/identification/other_estimators.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/aircraft/identification/output_error_model.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

constexpr const char* kCalmFlight = R"toml(
seed = 3
[subject]
builtin = "unatrap"
[flight]
duration = 150
airspeed = 20
turbulence = "none"
[sensors]
set = "reference"
[reconstruct]
sensors = "reference"
turbulence = "none"
)toml";

FlightAnalysis identify(const std::string& more, FlightStudy* out = nullptr) {
  Progress progress;
  FlightStudy study = read_study(Study::parse(std::string(kCalmFlight) + more, "calm.toml"), progress);
  FlightAnalysis analysis = identify(study, progress);
  if (out != nullptr) *out = std::move(study);
  return analysis;
}

TEST(OtherEstimators, InCalmAirOutputErrorHoldsTheTruthAndIsSharperThanRegression) {
  FlightStudy study;
  const FlightAnalysis a =
      identify("[identify]\noutput_error = true\nbootstrap = 60\nfrequency_band = [\"0.1 Hz\", \"2 Hz\"]\n", &study);
  ASSERT_EQ(a.others.output_error.size(), 2u);
  for (const AxisOutputError& axis : a.others.output_error) {
    ASSERT_TRUE(axis.attempted) << axis.text;
    EXPECT_EQ(axis.estimate.termination, estimation::OutputErrorTermination::kConverged) << axis.text;
    EXPECT_TRUE(axis.estimate.unidentifiable.empty()) << axis.text;
    EXPECT_EQ(axis.estimate.diverged_steps, 0);
  }
  int held = 0, count = 0, far = 0;
  double sharper = 0.0;
  std::map<std::string, int> of_method;
  for (const OtherParameter& p : a.others.parameters) {
    ++of_method[p.estimate.method];
    if (p.estimate.method != "output error") continue;
    const CoefficientModel& truth = study.true_subject->model.at(p.coefficient);
    const auto names = truth.parameter_names();
    const auto at = std::find(names.begin(), names.end(), p.estimate.parameter);
    ASSERT_NE(at, names.end());
    const double value = truth.values[static_cast<std::size_t>(at - names.begin())];
    ++count;
    held += p.estimate.low95 < value && value < p.estimate.high95;
    far += std::abs(p.estimate.value - value) > 4.0 * p.estimate.sigma;
    const auto* regression = a.estimate.find(p.estimate.parameter);
    ASSERT_NE(regression, nullptr);
    sharper += std::log(p.estimate.sigma / regression->sigma);
  }
  EXPECT_EQ(count, 32);
  // 95 % of 32 is 30.4 with a standard deviation of 1.2 were they independent; parameters of a coefficient are not.
  EXPECT_GE(held, 26);
  EXPECT_EQ(far, 0);
  EXPECT_LT(std::exp(sharper / count), 1.0);
  EXPECT_EQ(of_method["frequency domain"], 26);  // all but the six constants
  EXPECT_EQ(of_method["bootstrap of GTLS"] + of_method["bootstrap of OLS"], 32);
  EXPECT_EQ(a.estimate.other_methods.size(), a.others.parameters.size());
}

TEST(OtherEstimators, AreNotRunUnlessAskedFor) {
  const IdentifyOptions options;
  EXPECT_TRUE(estimate_otherwise({}, {}, {}, {}, options, *std::make_unique<Progress>()).empty());
}

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
  Eigen::VectorXd theta_all(static_cast<Eigen::Index>(model.parameters().size() + 8));
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

TEST(IdentifyOptions, TheKeysOfOtherEstimatorsAreChecked) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      const Study study = Study::parse("[identify]\n" + text, "study.toml");
      static_cast<void>(IdentifyOptions::read(study.root().table("identify")));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message("bootstrap = 10"),
            "study.toml:2: identify.bootstrap: = 10 must be 0 (none) or from 50 to 1000000 replicates");
  EXPECT_THAT(message("frequency_band = [2, 0.1]"), ::testing::HasSubstr("0 < low < high"));
  EXPECT_THAT(message("frequency_band = [\"0.1 kg\", \"2 Hz\"]"), ::testing::HasSubstr("kg"));
  EXPECT_THAT(message("structure = \"stepwize\""), ::testing::HasSubstr("stepwise"));
  EXPECT_THAT(message("[identify.candidates]\nCL = [\"1\", \"alpha\"]"), ::testing::HasSubstr("needs structure"));
  EXPECT_THAT(message("structure = \"stepwise\"\n[identify.candidates]\nCL = [\"alfa\"]"),
              ::testing::HasSubstr("alpha"));
  EXPECT_THAT(message("structure = \"stepwise\"\n[identify.candidates]\nCL = [\"alpha\", \"alpha\"]"),
              ::testing::HasSubstr("twice"));
}

TEST(StructureOfAFlight, FindsTheTermsOfTheTrueModelAmongCandidates) {
  FlightStudy study;
  const FlightAnalysis a = identify(
      "[identify]\nstructure = \"orthogonal\"\ncoefficients = [\"Cm\", \"Cl\"]\n"
      "[identify.candidates]\n"
      "Cm = [\"1\", \"alpha\", \"q_n\", \"de\", \"alpha^2\", \"alpha*de\", \"de^2\"]\n",
      &study);
  ASSERT_EQ(a.coefficients.size(), 2u);
  for (const CoefficientResult& r : a.coefficients) {
    ASSERT_TRUE(r.structure.has_value());
    EXPECT_EQ(r.verdict, CoefficientVerdict::kIdentified) << r.reason;
    // Strong terms must be there; Cl_dr of -0.0037 may be found or not.
    const std::vector<const char*> strong = r.coefficient == Coefficient::kCm
                                                ? std::vector<const char*>{"alpha", "q_n", "de"}
                                                : std::vector<const char*>{"beta", "p_n", "da"};
    for (const char* term : strong) EXPECT_TRUE(r.model.value_of(term).has_value()) << term;
    EXPECT_LE(r.model.size(), 8u);
    EXPECT_EQ(r.model.size(), r.structure->selected.size());
    // What is exported has the chosen terms.
    EXPECT_EQ(a.identified.model.at(r.coefficient).size(), r.model.size());
  }
}

}  // namespace
}  // namespace veridyn::aircraft
