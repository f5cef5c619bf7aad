#include "veridyn/vehicle/model/four_wheel_analysis.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"
#include "veridyn/numerics/linear_algebra/real_form.hpp"

namespace veridyn::vehicle {
namespace {

struct NamedShare {
  const char* name;
  double energy;
};

/// What moves most in an eigenvector, and its share.
std::pair<std::string, double> main_motion(const LinearFourWheel& model, const Eigen::VectorXcd& vector) {
  const auto component = [&](Eigen::Index state) -> std::complex<double> {
    const auto found = std::ranges::find(model.states, state);
    return vector(found - model.states.begin());
  };
  const auto energy = [&](Eigen::Index state) {
    const auto at = std::ranges::find(model.states, state) - model.states.begin();
    return model.inertia(at) * std::norm(vector(at));
  };
  const auto wheels = [&](Eigen::Index left) { return energy(left) + energy(left + 1); };
  const std::array<NamedShare, 6> shares{{{"lateral and yaw", energy(kV) + energy(kR)},
                                          {"heave", energy(kHeaveRate)},
                                          {"roll", energy(kRollRate)},
                                          {"pitch", energy(kPitchRate)},
                                          {"front wheel hop", wheels(kWheelHeightRate)},
                                          {"rear wheel hop", wheels(kWheelHeightRate + 2)}}};
  double all = 0.0;
  for (const NamedShare& one : shares) all += one.energy;
  // Slip angles weigh nothing: where they alone move, no mass does.
  double lag = 0.0;
  for (std::size_t i = 0; i < model.states.size(); ++i) {
    if (model.states[i] >= kLaggedSlip && model.states[i] < kLaggedSlip + 4) {
      lag += std::norm(vector(i));
    }
  }
  if (lag > 0.999 * vector.squaredNorm()) return {"tyre lag", lag / vector.squaredNorm()};
  const NamedShare most = *std::ranges::max_element(shares, {}, &NamedShare::energy);
  std::string name = most.name;
  if (name.ends_with("wheel hop")) {
    const Eigen::Index left = kWheelHeightRate + (name.starts_with("front") ? 0 : 2);
    const double together = (component(left) * std::conj(component(left + 1))).real();
    name += together > 0.0 ? ", in phase" : ", opposed";
  }
  return {std::move(name), all > 0.0 ? most.energy / all : 0.0};
}

}  // namespace

namespace internal {

LinearFourWheel linear_four_wheel_frame(const VehicleParameters<double>& p, double u, bool lagged_slip) {
  LinearFourWheel out;
  out.u = u;
  out.states = {kV, kR, kHeave, kRoll, kPitch, kHeaveRate, kRollRate, kPitchRate};
  for (Eigen::Index i = 0; i < 4; ++i) out.states.push_back(kWheelHeight + i);
  for (Eigen::Index i = 0; i < 4; ++i) out.states.push_back(kWheelHeightRate + i);
  if (lagged_slip) {
    for (Eigen::Index i = 0; i < 4; ++i) out.states.push_back(kLaggedSlip + i);
  }
  out.inertia = Eigen::VectorXd::Zero(out.states.size());
  out.inertia(0) = p.mass;
  out.inertia(1) = p.I_z;
  out.inertia(5) = p.mass - 4.0 * p.unsprung_mass;
  out.inertia(6) = p.I_x;
  out.inertia(7) = p.I_y;
  out.inertia.segment<4>(12).setConstant(p.unsprung_mass);
  return out;
}

}  // namespace internal

std::vector<FourWheelMode> modes(const LinearFourWheel& model) {
  const numerics::GeneralEigen eigen = numerics::general_eigen(model.A);
  std::vector<FourWheelMode> list;
  for (Eigen::Index i = 0; i < eigen.values.size(); ++i) {
    const std::complex<double> value = eigen.values(i);
    if (value.imag() < 0.0) continue;
    FourWheelMode mode;
    mode.eigenvalue = value;
    const double size = std::abs(value);
    mode.frequency_Hz = size / (2.0 * kPi);
    mode.damping_ratio = size > 0.0 ? -value.real() / size : 0.0;
    mode.oscillates = value.imag() > 0.0;
    mode.stable = value.real() < 0.0;
    std::tie(mode.name, mode.share) = main_motion(model, eigen.vectors.col(i));
    list.push_back(mode);
  }
  std::ranges::stable_sort(list, {}, &FourWheelMode::frequency_Hz);
  return list;
}

SteadyCornering steady_cornering(const LinearFourWheel& model, double wheelbase) {
  constexpr double kSteady_Hz = 1e-7;
  const FourWheelResponse response = frequency_response(model, kSteady_Hz);
  return {.understeer_gradient = (model.u / response.yaw_rate.real() - wheelbase) / (model.u * model.u),
          .roll_gradient = response.roll.real() / response.lateral_acceleration.real()};
}

FourWheelResponse frequency_response(const LinearFourWheel& model, double frequency_Hz) {
  using Matrix = Eigen::MatrixXcd;
  const std::complex<double> s(0.0, 2.0 * kPi * frequency_Hz);
  const Matrix resolvent = s * Matrix::Identity(model.A.rows(), model.A.cols()) - model.A.cast<std::complex<double>>();
  const Eigen::VectorXcd x = numerics::solve_complex(resolvent, model.B.cast<std::complex<double>>());
  const Eigen::Vector4cd y = model.C.cast<std::complex<double>>() * x + model.D.cast<std::complex<double>>();
  return {frequency_Hz, y(0), y(1), y(2), y(3)};
}

}  // namespace veridyn::vehicle
