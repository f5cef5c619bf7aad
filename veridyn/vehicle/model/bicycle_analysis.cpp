#include "veridyn/vehicle/model/bicycle_analysis.hpp"

#include <ceres/jet.h>

#include <Eigen/LU>
#include <algorithm>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
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

Eigen::Matrix<double, kBicycleCharacteristics, Eigen::Dynamic> characteristic_sensitivities(
    const VehicleParameters<double>& parameters, double speed) {
  constexpr int kColumns = static_cast<int>(kVehicleFields.size()) + 1;
  using Jet = ceres::Jet<double, kColumns>;
  VehicleParameters<Jet> p = parameters.cast<Jet>();
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) field_of(p, i).v(static_cast<int>(i)) = 1.0;
  const LinearBicycle<Jet> bicycle{p.mass, p.I_z, p.a, p.b, p.C_f, p.C_r, Jet(speed, kColumns - 1)};
  const std::array<Jet, kBicycleCharacteristics> values = to_array(characteristics(bicycle));
  Eigen::Matrix<double, kBicycleCharacteristics, Eigen::Dynamic> out(kBicycleCharacteristics, kColumns);
  for (std::size_t i = 0; i < kBicycleCharacteristics; ++i) {
    out.row(i) = values[i].v.transpose();
    if (!std::isfinite(values[i].a)) out.row(i).setConstant(kNaN);
  }
  return out;
}

std::array<double, kBicycleCharacteristics> characteristic_sigmas(const VehicleParameters<double>& parameters,
                                                                  double speed, std::span<const std::size_t> fields,
                                                                  const Eigen::MatrixXd& covariance) {
  const auto count = signed_index(fields.size());
  VERIDYN_ASSERT(covariance.rows() == count && covariance.cols() == count);
  const auto all = characteristic_sensitivities(parameters, speed);
  Eigen::MatrixXd J(kBicycleCharacteristics, count);
  for (Eigen::Index j = 0; j < count; ++j) {
    J.col(j) = all.col(fields[j]);
  }
  const Eigen::VectorXd variance = (J * covariance * J.transpose()).diagonal();
  std::array<double, kBicycleCharacteristics> sigma{};
  for (std::size_t i = 0; i < sigma.size(); ++i) sigma[i] = std::sqrt(variance(i));
  return sigma;
}

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

BicycleStepResponse step_response(const LinearBicycle<double>& bicycle, double steer, double time) {
  if (!(time >= 0.0)) return {};
  const Eigen::Matrix2d A = bicycle.A();
  const Eigen::Vector2d drive = bicycle.B() * steer;
  // x = integral of exp(A t) B: with M = A - s I, s half the trace, M^2 = d I, so exp(A t) = e^(s t) (cosh I + sinh/w
  // M) for w = sqrt(d), cos and sin for negative d.
  const double s = 0.5 * A.trace();
  const Eigen::Matrix2d M = A - s * Eigen::Matrix2d::Identity();
  const double d = -M.determinant();
  const double w = std::sqrt(std::abs(d));
  const double wt = w * time;
  const double even = d > 0.0 ? std::cosh(wt) : std::cos(wt);
  const double odd = wt < 1e-8 ? time : (d > 0.0 ? std::sinh(wt) : std::sin(wt)) / w;
  const Eigen::Matrix2d exponential = std::exp(s * time) * (even * Eigen::Matrix2d::Identity() + odd * M);
  const Eigen::Vector2d x = A.fullPivLu().solve((exponential - Eigen::Matrix2d::Identity()) * drive);
  const Eigen::Vector3d y = bicycle.C() * x + bicycle.D() * steer;
  return {x(0), x(1), y(1)};
}

}  // namespace veridyn::vehicle
