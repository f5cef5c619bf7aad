#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "tests/vehicle/model/moments.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"

// Frequencies of the four-wheel model's heave, roll, pitch and wheel hop.

namespace veridyn::vehicle {
namespace {

using testing::linear_car;
using testing::Moment;
using testing::rates_at;

/// The rows and columns of the vertical motion at rest, by automatic differentiation.
Eigen::MatrixXd vertical_motion(const VehicleParameters<double>& p, const FourWheelOptions& options = {}) {
  constexpr int kSize = 14;
  using Jet = ceres::Jet<double, kSize>;
  const auto car = linear_car(p.cast<Jet>(), options);
  FourWheelState<Jet> state = car.steady_start(Jet(20.0));
  for (int i = 0; i < kSize; ++i) state(kHeave + i).v(i) = 1.0;
  FourWheelRates<Jet> rates;
  car.rates(state, car.wheel_controls(Jet(0.0)), {}, rates);
  Eigen::MatrixXd matrix(kSize, kSize);
  for (int i = 0; i < kSize; ++i) matrix.row(i) = rates.derivative(kHeave + i).v.transpose();
  return matrix;
}

/// Angular frequencies of an undamped body (inertia M, spring K to four wheels, negative spring G to the ground) on
/// wheels (each of inertia m against it, tyre spring T): the roots of the 2 x 2 characteristic equation.
std::array<double, 2> two_mass_frequencies(double M, double m, double K, double T, double G) {
  // M x'' = -K (x - y) + G x;  m y'' = K (x - y) - T y
  const double A = M * m, B = -(M * (K + T) + m * (K - G)), C = (K - G) * (K + T) - K * K;
  const double root = std::sqrt(B * B - 4.0 * A * C);
  return {std::sqrt((-B - root) / (2.0 * A)), std::sqrt((-B + root) / (2.0 * A))};
}

// Heave, roll and pitch of a car that is the same in front and behind are those of three quarter cars.
TEST(FourWheelModel, HeavesRollsAndPitchesAtTheFrequenciesOfTheQuarterCar) {
  VehicleParameters<double> p;
  p.a = p.b = 1.2;
  p.C_sf = p.C_sr = 0.0;
  p.C_f = p.C_r = 1e-9;  // contact points that move would damp
  p.K_sf = p.K_sr = 25000.0;
  p.K_tf = p.K_tr = 200000.0;
  p.K_bf = p.K_br = 6000.0;
  const double sprung = p.mass - 4.0 * p.unsprung_mass, gravity = sprung * 9.80665 * p.cg_height;
  const double y = 0.5 * p.track_f, x = p.a, w = 4.0 * p.unsprung_mass;
  std::vector<double> expected;
  const auto add = [&](double inertia, double wheels, double spring, double tyre, double tilting) {
    for (const double f : two_mass_frequencies(inertia, wheels, spring, tyre, tilting)) expected.push_back(f);
  };
  add(sprung, w, 4.0 * p.K_sf, 4.0 * p.K_tf, 0.0);
  add(p.I_x, w * y * y, 4.0 * (p.K_sf + 2.0 * p.K_bf) * y * y, 4.0 * p.K_tf * y * y, gravity);
  add(p.I_y, w * x * x, 4.0 * p.K_sf * x * x, 4.0 * p.K_tf * x * x, gravity);
  // The fourth: wheels cross over (warp), where the body rests.
  expected.push_back(std::sqrt((p.K_sf + 2.0 * p.K_bf + p.K_tf) / p.unsprung_mass));
  std::sort(expected.begin(), expected.end());
  std::vector<double> found;
  for (const std::complex<double>& e : numerics::general_eigenvalues(vertical_motion(p))) {
    EXPECT_NEAR(e.real(), 0.0, 1e-7);
    if (e.imag() > 0.0) found.push_back(e.imag());
  }
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-7 * expected[i]) << i;
}

TEST(FourWheelModel, MovesTheWholeMassAndIsNotTiltedInTheSourcesConvention) {
  VehicleParameters<double> p;
  p.a = p.b = 1.2;
  p.C_sf = p.C_sr = 0.0;
  FourWheelOptions options;
  options.convention = FourWheelConvention::kSource;
  options.geometry = BicycleGeometry::kSmallAngles;
  const double y = 0.5 * p.track_f;
  const auto heave = two_mass_frequencies(p.mass, 4.0 * p.unsprung_mass, 4.0 * p.K_sf, 4.0 * p.K_tf, 0.0);
  const auto roll =
      two_mass_frequencies(p.I_x, 4.0 * p.unsprung_mass * y * y, 4.0 * p.K_sf * y * y, 4.0 * p.K_tf * y * y, 0.0);
  for (const double expected : {heave[0], heave[1], roll[0], roll[1]}) {
    double nearest = 1e9;
    for (const std::complex<double>& e : numerics::general_eigenvalues(vertical_motion(p, options))) {
      nearest = std::min(nearest, std::abs(e - std::complex<double>(0.0, expected)));
    }
    EXPECT_LT(nearest, 1e-6);
  }
  // Slips know nothing of roll, forces have their whole lateral part, tyres may pull while the load ends at zero.
  const auto car = linear_car(p, options);
  Moment m{car.steady_start(20.0), 0.05, 0.0, 0.0, {}};
  m.state(kV) = 0.4;
  m.state(kR) = 0.3;
  m.state(kRollRate) = 0.5;
  m.state(kWheelHeight) = 1.0;
  const auto rates = rates_at(car, m);
  EXPECT_NEAR(rates.slip_angle(0), 0.05 - (0.4 + 1.2 * 0.3) / (20.0 - 0.75 * 0.3), 1e-15);
  EXPECT_NEAR(rates.slip_angle(1), 0.05 - (0.4 + 1.2 * 0.3) / (20.0 + 0.75 * 0.3), 1e-15);
  EXPECT_NEAR(rates.slip_angle(3), -(0.4 - 1.2 * 0.3) / (20.0 + 0.75 * 0.3), 1e-15);
  EXPECT_NEAR(p.mass * rates.lateral_acceleration, rates.Fy(0) + rates.Fy(1) + rates.Fy(2) + rates.Fy(3), 1e-9);
  EXPECT_EQ(rates.Fz(0), 0.0);
  EXPECT_NEAR(rates.derivative(kWheelHeightRate), -(p.K_tf + p.K_sf) / p.unsprung_mass, 1e-9);
}

}  // namespace
}  // namespace veridyn::vehicle
