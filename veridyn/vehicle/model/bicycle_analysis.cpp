#include "veridyn/vehicle/model/bicycle_analysis.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"

namespace veridyn::vehicle {

const std::array<CharacteristicField, kBicycleCharacteristics> kBicycleCharacteristicFields{{
    {"understeer_gradient", "rad s^2/m"},
    {"characteristic_speed", "m/s"},
    {"critical_speed", "m/s"},
    {"neutral_steer_point", "m"},
    {"static_margin", "1"},
    {"yaw_rate_gain", "1/s"},
    {"lateral_acceleration_gain", "m/s^2/rad"},
    {"sideslip_gain", "1"},
    {"curvature_gain", "1/m"},
    {"natural_frequency", "rad/s"},
    {"damping_ratio", "1"},
    {"yaw_rate_zero_time", "s"},
    {"bandwidth", "rad/s"},
    {"peak_frequency", "rad/s"},
    {"peak_ratio", "1"},
    {"equivalent_time", "s"},
}};

std::vector<Mode> modes(const Eigen::MatrixXd& A) {
  std::vector<Mode> list;
  for (const std::complex<double>& value : numerics::general_eigenvalues(A)) {
    if (value.imag() < 0.0) continue;
    Mode mode{.eigenvalue = value};
    const double size = std::abs(value);
    mode.frequency_Hz = size / (2.0 * kPi);
    mode.damping_ratio = size > 0.0 ? -value.real() / size : 0.0;
    mode.oscillates = value.imag() > 0.0;
    mode.stable = value.real() < 0.0;
    list.push_back(mode);
  }
  std::ranges::sort(list, {}, &Mode::frequency_Hz);
  return list;
}

BicycleResponse frequency_response(const LinearBicycle<double>& bicycle, double frequency_Hz) {
  const std::complex<double> s(0.0, 2.0 * kPi * frequency_Hz);
  const Eigen::Matrix2cd resolvent = (s * Eigen::Matrix2cd::Identity() - bicycle.A().cast<std::complex<double>>());
  const Eigen::Vector2cd state = resolvent.inverse() * bicycle.B().cast<std::complex<double>>();
  const Eigen::Vector3cd out =
      bicycle.C().cast<std::complex<double>>() * state + bicycle.D().cast<std::complex<double>>();
  return {frequency_Hz, out(0), out(1), out(2)};
}

std::vector<BicycleResponse> frequency_response(const LinearBicycle<double>& bicycle, double low_Hz, double high_Hz,
                                                std::size_t count) {
  VERIDYN_ASSERT(low_Hz > 0.0 && high_Hz > low_Hz && count >= 2);
  std::vector<BicycleResponse> list;
  list.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    list.push_back(frequency_response(bicycle, low_Hz * std::pow(high_Hz / low_Hz, share)));
  }
  return list;
}

}  // namespace veridyn::vehicle
