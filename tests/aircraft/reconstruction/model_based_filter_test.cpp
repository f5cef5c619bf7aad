#include "veridyn/aircraft/reconstruction/model_based_filter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/aircraft/simulated_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/wind_axes.hpp"
#include "veridyn/aircraft/reconstruction/filter_comparison.hpp"
#include "veridyn/aircraft/reconstruction/information_bound.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using testing::Flown;
using testing::fly;
using ::testing::HasSubstr;
using testing::linear_unatrap;
using testing::reconstructed;
using testing::reference_options;

using Model = ModelBasedAirData<true>;

Model some_model(const Subject& subject) {
  Model model;
  model.spectrum = {200.0, 200.0, 50.0, 2.12, 2.12, 1.4};
  model.subject = &subject;
  return model;
}

Model::State<double> model_based_state() {
  Model::State<double> x;
  x.attitude = numerics::quaternion_from_euler(0.4, 0.2, 2.0);
  x.velocity = x.attitude * Eigen::Vector3d(19.0, 1.0, 2.0) + Eigen::Vector3d(3.0, -4.0, 0.2);
  x.gust << 0.4, -0.8, 0.3, 0.6, 0.1;
  x.wind << 3.0, -4.0, 0.2;
  x.imu_bias << 0.01, -0.02, 0.005, 0.3, -0.1, 0.2;
  x.imu_scale << 0.02, -0.01, 0.03, 0.05, -0.02, 0.01;
  x.coefficient_error << 0.05, 0.01, -0.02;
  return x;
}

Model::Input some_input() {
  Model::Input u;
  u.gyro << 0.3, -0.2, 0.1;
  u.airspeed = 19.0;
  u.controls.de = 0.05;
  u.controls.da = -0.03;
  u.controls.dr = 0.02;
  u.controls.throttle = 0.4;
  u.air_density = 1.1;
  return u;
}

// In air at rest the state's Va, alpha and beta obey the wind-axes equations of section 8, written out independently.
TEST(ModelBasedAirData, ObeysTheWindAxesEquationsInStillAir) {
  const Subject subject = builtin_subject("unatrap", "test");
  const Model model = some_model(subject);
  Model::State<double> x = model_based_state();
  x.gust.setZero();
  x.imu_bias.setZero();
  x.imu_scale.setZero();
  x.coefficient_error.setZero();
  const Model::Input u = some_input();
  const auto air = [&](const Model::State<double>& s) { return air_data<double>(model.air_velocity(s)); };
  const AirData<double> now = air(x);
  constexpr double h = 1e-5;
  const AirData<double> next = air(model.propagate<double>(x, u, h));

  const AeroLoads<double> loads = aero_loads<double>(subject, model.air_velocity(x), u.gyro, u.controls, u.air_density);
  const auto euler = numerics::euler_from_quaternion(x.attitude);
  WindAxesInput<double> in;
  in.CL = loads.coefficients.CL;
  in.CD = loads.coefficients.CD;
  in.CY = loads.coefficients.CY;
  in.p = u.gyro(0);
  in.q = u.gyro(1);
  in.r = u.gyro(2);
  in.phi = euler.phi;
  in.theta = euler.theta;
  in.thrust = loads.propulsion.thrust;
  in.dynamic_pressure_area = loads.dynamic_pressure * subject.wing_area;
  in.mass = subject.mass;
  const WindAxesRate<double> rate = wind_axes_rate(now.Va, now.alpha, now.beta, in);
  // The difference quotient is off by h/2 times the second derivatives, some 1e-4.
  EXPECT_NEAR((next.Va - now.Va) / h, rate.Va, 5e-4);
  EXPECT_NEAR((next.alpha - now.alpha) / h, rate.alpha, 5e-4);
  EXPECT_NEAR((next.beta - now.beta) / h, rate.beta, 5e-4);
}

TEST(ModelBasedAirData, IntegratesWithSecondOrder) {
  const Subject subject = builtin_subject("unatrap", "test");
  const Model model = some_model(subject);
  const auto go = [&](int steps) {
    Model::State<double> x = model_based_state();
    Model::Input u = some_input();
    u.gyro.setZero();
    for (int k = 0; k < steps; ++k) x = model.propagate<double>(x, u, 0.2 / steps);
    return Eigen::Vector3d(x.velocity);
  };
  const Eigen::Vector3d best = go(1600);
  const double coarse = (go(10) - best).norm(), fine = (go(20) - best).norm();
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.25);
}

TEST(ModelBasedAirData, TransitionEqualsFiniteDifferences) {
  const Subject subject = builtin_subject("unatrap", "test");
  const Model model = some_model(subject);
  Model::State<double> after;
  const auto F = estimation::transition(model, model_based_state(), some_input(), 0.01, after);
  constexpr double h = 1e-6;
  for (int j = 0; j < Model::kStates; ++j) {
    Model::Vector e = Model::Vector::Zero();
    e(j) = h;
    const auto plus = model.propagate<double>(Model::retract<double>(model_based_state(), e), some_input(), 0.01);
    const auto minus =
        model.propagate<double>(Model::retract<double>(model_based_state(), Model::Vector(-e)), some_input(), 0.01);
    const Model::Vector column = (Model::local<double>(after, plus) - Model::local<double>(after, minus)) / (2.0 * h);
    EXPECT_LT((F.col(j) - column.head<Model::kDynamic>()).cwiseAbs().maxCoeff(), 1e-7) << "error component " << j;
  }
}

TEST(ModelBasedAirData, AccelerometerRowsEqualFiniteDifferences) {
  const Subject subject = builtin_subject("unatrap", "test");
  const Model model = some_model(subject);
  constexpr double h = 1e-6;
  double noise = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const Model::Vector H =
        Model::row(predict_specific_force(model, model_based_state(), some_input(), axis, 0.006, noise));
    EXPECT_GT(noise, 0.0);
    for (int j = 0; j < Model::kStates; ++j) {
      Model::Vector e = Model::Vector::Zero();
      e(j) = h;
      const auto at = [&](const Model::Vector& step) {
        double unused = 0.0;
        return predict_specific_force(model, Model::retract<double>(model_based_state(), step), some_input(), axis,
                                      0.006, unused)
            .value;
      };
      EXPECT_NEAR(H(j), (at(e) - at(Model::Vector(-e))) / (2.0 * h), 1e-5) << "axis " << axis << ", component " << j;
    }
  }
}

// --- Against the bound ----------------------------------------------------------------------------------------------

/// Flies the linear aircraft and compares both filters with bound and truth; means over the seeds.
void compare(double airspeed, int seeds, double duration) {
  std::vector<FilterError> mean;
  double worst_bias = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Flown f = fly({.airspeed = airspeed, .duration = duration, .seed = static_cast<std::uint64_t>(seed)});
    Progress quiet;
    const auto errors = compare_filters(f.measured, f.truth, reference_options(), f.subject, quiet);
    if (mean.empty()) mean.resize(errors.size());
    for (std::size_t i = 0; i < errors.size(); ++i) {
      mean[i].quantity = errors[i].quantity;
      for (const auto which : {&FilterError::model_free, &FilterError::model_based}) {
        auto& m = mean[i].*which;
        const auto& e = errors[i].*which;
        m.filter_rms += e.filter_rms / seeds;
        m.smoother_rms += e.smoother_rms / seeds;
        m.filter_bound = e.filter_bound;
        m.smoother_bound = e.smoother_bound;
      }
      if (errors[i].quantity == "airspeed")
        worst_bias = std::max(worst_bias, std::abs(errors[i].model_based.smoother_bias));
    }
  }
  for (const FilterError& e : mean) {
    const double unit = e.quantity == "alpha" || e.quantity == "beta" ? kDegree : 1.0;
    std::printf("  %2.0f m/s %-17s model-free %.3f / %.3f, model-based %.3f / %.3f, bound %.3f / %.3f\n", airspeed,
                e.quantity.c_str(), e.model_free.filter_rms / unit, e.model_free.smoother_rms / unit,
                e.model_based.filter_rms / unit, e.model_based.smoother_rms / unit, e.model_based.filter_bound / unit,
                e.model_based.smoother_bound / unit);
    EXPECT_LT(e.model_based.filter_rms, e.model_free.filter_rms) << e.quantity;
    EXPECT_LT(e.model_based.smoother_rms, e.model_free.smoother_rms) << e.quantity;
    if (e.model_based.filter_bound > 0.0) {
      // Specified: 1.2 times the bound. Reached: 1.05. Below it only by the scatter of short flights.
      EXPECT_LT(e.model_based.filter_rms, 1.12 * e.model_based.filter_bound) << e.quantity;
      EXPECT_LT(e.model_based.smoother_rms, 1.12 * e.model_based.smoother_bound) << e.quantity;
      EXPECT_GT(e.model_based.filter_rms, 0.93 * e.model_based.filter_bound) << e.quantity;
    }
  }
  EXPECT_LT(worst_bias, 0.05);
}

TEST(ModelBasedFilter, ReachesTheBoundAndBeatsTheModelFreeFilter) { compare(20.0, 2, 50.0); }

// Without a longitudinal gust the airspeed is known, and the specification's figures are attained: 0.04 deg.
TEST(ModelBasedFilter, ReachesTheSpecificationsBoundWhereTheAirspeedIsKnown) {
  Flown f = fly({.airspeed = 20.0, .duration = 60.0, .longitudinal_gust = false});
  ReconstructOptions o = reference_options();
  o.filter = FilterKind::kModelBased;
  o.turbulence->spectrum.sigma_u = 1e-3;
  o.model_error = {0.0, 0.0, 0.0};
  o.wind_walk = o.wind_down_walk = 0.0;
  const Reconstruction r = reconstructed(f, o);
  const ModelBound b = information_bound(gust_spectrum("low_moderate"), f.subject, 20.0, {.airspeed_known = true});
  const double filter = testing::rms_error(r.filtered, f.truth, "alpha", 30.0);
  const double smoother = testing::rms_error(r.smoothed, f.truth, "alpha", 30.0);
  std::printf("  alpha %.4f / %.4f deg, bound %.4f / %.4f\n", filter / kDegree, smoother / kDegree,
              b.angles.alpha.filter / kDegree, b.angles.alpha.smoother / kDegree);
  EXPECT_LT(filter, 1.2 * b.angles.alpha.filter);
  EXPECT_LT(smoother, 1.2 * b.angles.alpha.smoother);
}

class ModelBasedSoak : public ::testing::TestWithParam<double> {};
TEST_P(ModelBasedSoak, ReachesTheBoundOverTenSeeds) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "long-running test; set VERIDYN_SOAK=1 to run it";
  compare(GetParam(), 10, 200.0);
}
INSTANTIATE_TEST_SUITE_P(Speeds, ModelBasedSoak, ::testing::Values(15.0, 20.0, 25.0));

TEST(ModelBasedFilter, TakesAnUnknownDragFromTheAccelerometer) {
  Flown f = fly({.duration = 50.0});
  Subject half = f.subject;
  half.model.coefficients[Coefficient::kCD].reset();
  ReconstructOptions o = reference_options();
  o.filter = FilterKind::kModelBased;
  Progress quiet;
  const Reconstruction r = reconstruct(f.measured, o, quiet, &half);
  o.filter = FilterKind::kModelFree;
  const Reconstruction free = reconstructed(f, o);
  EXPECT_LT(testing::rms_error(r.smoothed, f.truth, "alpha"),
            0.7 * testing::rms_error(free.smoothed, f.truth, "alpha"));
  EXPECT_THAT(r.warnings, ::testing::Contains(HasSubstr("CD are not known")));
}

TEST(ModelBasedFilter, RefusesASubjectWithoutLiftAndARecordingWithoutControls) {
  Flown f = fly({.duration = 5.0});
  ReconstructOptions o = reference_options();
  o.filter = FilterKind::kModelBased;
  Progress quiet;
  const auto message = [&](const Recording& recording, const Subject* subject) -> std::string {
    try {
      static_cast<void>(reconstruct(recording, o, quiet, subject));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(message(f.measured, nullptr), HasSubstr("needs a subject"));
  Subject blind = f.subject;
  blind.model.at(Coefficient::kCL).values[0] = kNaN;
  EXPECT_THAT(message(f.measured, &blind), HasSubstr("derivatives of CL"));
  Recording without_elevator;
  without_elevator.frame = f.measured.frame;
  for (const Channel& c : f.measured.channels()) {
    if (c.name != "elevator") without_elevator.add(c);
  }
  EXPECT_THAT(message(without_elevator, &f.subject), HasSubstr("'elevator'"));
}

}  // namespace
}  // namespace veridyn::aircraft
