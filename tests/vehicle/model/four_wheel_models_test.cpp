#include "veridyn/vehicle/model/four_wheel_models.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "tests/vehicle/cars.hpp"
#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle {
namespace {

using AnyScalar = ceres::Jet<double, 1>;

/// The compiled model, whose four tyres are calculated at once, against the model for derivatives, whose tyres are one
/// by one: at random motions from gentle to beyond the limit of the tyres.
template <template <typename> typename Tyre>
void expect_rates_of_tyres_one_by_one(const PerWheel<Tyre<double>>& tyres, const PerWheel<Tyre<AnyScalar>>& general) {
  const VehicleParameters<double> p = testing::road_car();
  const FourWheelOptions options = testing::with_longitudinal({});
  const FourWheelModel<double, Tyre<double>> compiled(p, tyres, options);
  const FourWheelModel<AnyScalar, Tyre<AnyScalar>> one_by_one(p.cast<AnyScalar>(), general, options);
  std::mt19937_64 random(7);
  const auto about = [&](double most) { return std::uniform_real_distribution(-most, most)(random); };
  for (int k = 0; k < 200; ++k) {
    FourWheelState<double> state = compiled.steady_start(20.0);
    for (const auto& [at, most] : {std::pair{kU, 5.0},
                                   {kV, 2.0},
                                   {kR, 0.5},
                                   {kRoll, 0.1},
                                   {kPitch, 0.02},
                                   {kHeave, 0.03},
                                   {kRollRate, 0.3},
                                   {kPitchRate, 0.1},
                                   {kHeaveRate, 0.2}})
      state(at) += about(most);
    for (Eigen::Index w = 0; w < 4; ++w) {
      state(kWheelHeight + w) += about(0.02);
      state(kWheelSpin + w) *= 1.0 + about(0.2);
    }
    const double steer = about(0.1);
    FourWheelRates<double> rates;
    FourWheelRates<AnyScalar> expected;
    compiled.rates(state, compiled.wheel_controls(steer, 200.0, 50.0), {}, rates);
    one_by_one.rates(state.cast<AnyScalar>(), one_by_one.wheel_controls(AnyScalar(steer), 200.0, 50.0), {}, expected);
    for (Eigen::Index i = 0; i < kFourWheelStates; ++i) {
      const double exact = expected.derivative(i).a;
      // Forces agree to rounding of friction times load, masses and inertias make accelerations of that.
      ASSERT_NEAR(rates.derivative(i), exact, 1e-11 * std::max(1.0, std::abs(exact))) << "case " << k << " state " << i;
    }
    for (Eigen::Index w = 0; w < 4; ++w) ASSERT_NEAR(rates.Fy[w], expected.Fy[w].a, 1e-8) << "case " << k;
  }
}

template <template <typename> typename Tyre>
PerWheel<Tyre<AnyScalar>> cast(const PerWheel<Tyre<double>>& tyres) {
  return {tyres[0].template cast<AnyScalar>(), tyres[1].template cast<AnyScalar>(), tyres[2].template cast<AnyScalar>(),
          tyres[3].template cast<AnyScalar>()};
}

TEST(FourWheelModels, OnLinearTyresHaveTheRatesOfTyresOneByOne) {
  const LinearTyre<double> front{.stiffness = 50000.0, .mu = 0.9}, rear{.stiffness = 60000.0, .mu = 0.9};
  const LinearTyre<AnyScalar> f{.stiffness = AnyScalar(50000.0), .mu = AnyScalar(0.9)},
      r{.stiffness = AnyScalar(60000.0), .mu = AnyScalar(0.9)};
  expect_rates_of_tyres_one_by_one<LinearTyre>({front, front, rear, rear}, {f, f, r, r});
}

TEST(FourWheelModels, OnFialaTyresHaveTheRatesOfTyresOneByOne) {
  const FialaTyre<double> front{.stiffness = 50000.0, .mu = 0.8}, rear{.stiffness = 60000.0, .mu = 0.9};
  const PerWheel<FialaTyre<double>> tyres{front, front, rear, rear};
  expect_rates_of_tyres_one_by_one<FialaTyre>(tyres, cast<FialaTyre>(tyres));
}

TEST(FourWheelModels, OnSimpleMagicFormulaTyresHaveTheRatesOfTyresOneByOne) {
  const SimpleMagicFormulaTyre<double> front{.mu = 0.8, .E = -0.5, .stiffness_saturation = 0.4, .mu_load = 0.1};
  const SimpleMagicFormulaTyre<double> rear{.mu = 0.9, .C = 1.5};
  const PerWheel<SimpleMagicFormulaTyre<double>> tyres{front, front, rear, rear};
  expect_rates_of_tyres_one_by_one<SimpleMagicFormulaTyre>(tyres, cast<SimpleMagicFormulaTyre>(tyres));
}

TEST(FourWheelModels, OnATyreFileHaveTheRatesOfTyresOneByOne) {
  const TirFile file = parse_tir(testing::small_tir(), "small.tir");
  const auto left = file.on(TyreSide::kLeft), right = file.on(TyreSide::kRight);
  const PerWheel<MagicFormulaTyre<double>> tyres{left, right, left, right};
  expect_rates_of_tyres_one_by_one<MagicFormulaTyre>(tyres, cast<MagicFormulaTyre>(tyres));
}

}  // namespace
}  // namespace veridyn::vehicle
