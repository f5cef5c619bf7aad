#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_systems/lyapunov.hpp"
#include "veridyn/numerics/modulating_kernel.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/numerics/signal_band.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/vehicle/identification/fit/sampled_input.hpp"

namespace veridyn::vehicle {
namespace {

/// Beyond it a yaw rate is not that of a vehicle [rad/s].
constexpr double kLargestYawRate = 50.0;

/// Noise of the steering over its rms below which nothing is taken off.
constexpr double kNoNoise = 1e-3;

/// Derivatives with respect to initial conditions begin as one and count for nothing below this.
constexpr double kForgotten = 1e-8;
constexpr std::size_t kForgottenEvery = 25;  // samples

template <typename State>
bool depends_on_its_beginning(const State& x) {
  if constexpr (std::is_same_v<typename State::Scalar, double>)
    return true;
  else
    return std::ranges::any_of(x, [](const auto& state) { return state.v.cwiseAbs().maxCoeff() > kForgotten; });
}

template <typename Scalar>
typename LoadTransfer<Scalar>::Effect load_transfer_of(DriveStructure structure) {
  using Effect = typename LoadTransfer<Scalar>::Effect;
  return structure == DriveStructure::kSaturation     ? Effect::kLoads
         : structure == DriveStructure::kMagicFormula ? Effect::kLoss
                                                      : Effect::kNone;
}

std::vector<double> smoothed(const std::vector<double>& x, double rate_Hz, double cutoff_Hz) {
  if (!(cutoff_Hz > 0.0) || x.empty()) return x;
  return numerics::filter(x, numerics::modulating_kernel(rate_Hz, cutoff_Hz).smooth);
}

}  // namespace

DriveParametricModel::DriveParametricModel(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                           const VehicleParameters<double>& start, const DriveModelOptions& options)
    : grid_(signals.grid),
      accel_position_(signals.accel_position),
      gravity_removed_(signals.gravity_removed),
      removed_gradient_(signals.roll_gradient),
      steer_sigma_(signals[DriveSignal::kSteer].sigma),
      start_(start),
      options_(with_geometry(options, start, signals.roll_gradient)) {
  for (const DriveSignal s : {DriveSignal::kSteer, DriveSignal::kSpeed, DriveSignal::kYawRate}) {
    if (!signals[s].available()) {
      throw InputError(signals.source, fmt::format("has no {}, which output error is driven by or compared with",
                                                   kDriveSignalNames[s]));
    }
  }
  smoothing_Hz_ = std::max(0.0, options.smoothing_Hz);
  const GridSignal& steer = signals[DriveSignal::kSteer];
  if (options.smoothing_Hz < 0.0) {
    numerics::BandLimited limited =
        numerics::denoised(steer.value, grid_.rate_Hz(), kNoNoise * numerics::rms(steer.value));
    steer_ = std::move(limited.value);
    steer_error_share_ = limited.band_Hz > 0.0 ? limited.noise_share : 0.0;
  } else {
    steer_ = smoothed(steer.value, grid_.rate_Hz(), smoothing_Hz_);
  }
  speed_ = smoothed(signals[DriveSignal::kSpeed].value, grid_.rate_Hz(), smoothing_Hz_);
  if (options_.effects[DriveEffect::kPedals] || options_.start[DriveUnknown::kLoadSensitivity] != 0.0)
    speed_rate_ = numerics::filter(
        signals[DriveSignal::kSpeed].value,
        numerics::modulating_kernel(grid_.rate_Hz(), std::min(kPedalBand_Hz, 0.1 * grid_.rate_Hz())).first);
  const auto compare = [&](DriveSignal signal) {
    if (!signals[signal].available()) return;
    outputs_.push_back({std::string(kDriveSignalNames[signal]), std::string(kDriveSignalUnits[signal])});
    compared_.push_back({.signal = signal, .value = smoothed(signals[signal].value, grid_.rate_Hz(), smoothing_Hz_)});
  };
  for (const DriveSignal s : {DriveSignal::kYawRate, DriveSignal::kAccelY, DriveSignal::kLateralVelocity}) compare(s);
  if (has_roll(options_.structure))
    for (const DriveSignal s : {DriveSignal::kRoll, DriveSignal::kRollRate}) compare(s);
  for (const auto& [signal, bias] : {std::pair{DriveSignal::kRoll, DriveUnknown::kRollBias},
                                     std::pair{DriveSignal::kRollRate, DriveUnknown::kRollRateBias}})
    options_.free[bias] = options_.free[bias] && has_roll(options_.structure) && signals[signal].available();
  for (const DriveUnknown u : kAllDriveUnknowns) parameters_.push_back(model_parameter(u, options_, start.wheelbase()));
  for (const TimeSpan& span : spans) {
    const auto [begin, end] = signals.indices(span);
    if (end > begin + 1) segments_.push_back(make_segment(begin, end));
  }
}

Eigen::Index DriveParametricModel::samples_before_divergence(std::size_t segment, const Eigen::VectorXd& theta) const {
  estimation::RowMatrix output = estimation::RowMatrix::Constant(samples(segment), signed_index(outputs_.size()), kNaN);
  (void)simulate(segment, theta, output);
  Eigen::Index driven = 0;
  while (driven < output.rows() && output.row(driven).allFinite()) ++driven;
  return driven;
}

Eigen::Index DriveParametricModel::out_of_reach(DriveSignal signal) const {
  if (signal != DriveSignal::kYawRate && signal != DriveSignal::kAccelY) return 0;
  const DriveUnknown delay = signal == DriveSignal::kYawRate ? DriveUnknown::kYawRateDelay : DriveUnknown::kAccelYDelay;
  constexpr double kStandardDeviations = 3.0;
  // So many show the first or last value of the model, which is hardly another by then.
  constexpr Eigen::Index kHeld = 3;
  const double spread = options_.free[delay] ? kStandardDeviations * options_.prior[delay] : 0.0;
  const double longest = std::min(kLongestDelay_s, std::abs(options_.start[delay]) + spread);
  const auto samples = static_cast<Eigen::Index>(std::ceil(longest / grid_.step - 1e-9));
  return samples > kHeld ? samples : 0;
}

std::vector<estimation::RowMatrix> DriveParametricModel::measured() const {
  std::vector<estimation::RowMatrix> all;
  for (const Segment& s : segments_) {
    estimation::RowMatrix m = estimation::RowMatrix::Constant(s.samples, signed_index(compared_.size()), kNaN);
    for (std::size_t j = 0; j < compared_.size(); ++j) {
      const Eigen::Index edge = std::min(out_of_reach(compared_[j].signal), s.samples / 4);
      for (Eigen::Index k = edge; k < s.samples - edge; ++k)
        m(k, signed_index(j)) = compared_[j].value[s.begin + static_cast<std::size_t>(k)];
    }
    all.push_back(std::move(m));
  }
  return all;
}

bool DriveParametricModel::delays_outputs(double yaw_rate_delay, double accel_delay) const {
  return yaw_rate_delay != 0.0 || accel_delay != 0.0 || options_.free[DriveUnknown::kYawRateDelay] ||
         options_.free[DriveUnknown::kAccelYDelay];
}

template <int kStates, typename Scalar>
Scalar DriveParametricModel::true_output(DriveSignal signal, const Eigen::Matrix<Scalar, kStates, 1>& state,
                                         const RollingBicycleRates<Scalar, kStates>& rates,
                                         const Parameters<Scalar>& theta) const {
  const auto [given_x, y, z] = accel_position_;
  switch (signal) {
    case DriveSignal::kAccelY: {
      const Scalar x = given_x + theta(static_cast<Eigen::Index>(DriveUnknown::kAccelPlace));
      Scalar shown = rates.lateral_acceleration + x * rates.derivative(1) - y * state(1) * state(1);
      if constexpr (kStates > 2) {
        shown -= (z + theta(static_cast<Eigen::Index>(DriveUnknown::kAccelHeight))) * rates.derivative(3);
        if (!gravity_removed_ || removed_gradient_ != 0.0)
          shown = (shown + options_.gravity * state(2)) / (1.0 + options_.gravity * removed_gradient_);
      }
      return shown;
    }
    case DriveSignal::kLateralVelocity:
      return state(0);
    case DriveSignal::kRoll:
    case DriveSignal::kRollRate:
      if constexpr (kStates > 2) return state(signal == DriveSignal::kRoll ? 2 : 3);
      return Scalar(0.0);
    default:
      return state(1);
  }
}

template <typename Scalar>
Scalar DriveParametricModel::recorded(DriveSignal signal, const Scalar& shown, const Parameters<Scalar>& theta) const {
  const auto unknown = [&](DriveUnknown u) -> const Scalar& { return theta(static_cast<Eigen::Index>(u)); };
  switch (signal) {
    case DriveSignal::kYawRate:
      return shown + unknown(DriveUnknown::kYawRateBias);
    case DriveSignal::kAccelY:
      return (1.0 + unknown(DriveUnknown::kAccelYScale)) * shown + unknown(DriveUnknown::kAccelYBias);
    case DriveSignal::kRoll:
      return shown + unknown(DriveUnknown::kRollBias);
    case DriveSignal::kRollRate:
      return shown + unknown(DriveUnknown::kRollRateBias);
    default:
      return shown;
  }
}

template <typename Scalar>
void DriveParametricModel::delay_outputs(const std::vector<std::vector<Scalar>>& shown, const Parameters<Scalar>& theta,
                                         Outputs<Scalar>& output) const {
  for (std::size_t j = 0; j < compared_.size(); ++j) {
    const DriveSignal signal = compared_[j].signal;
    if (signal != DriveSignal::kYawRate && signal != DriveSignal::kAccelY) continue;
    const DriveUnknown which =
        signal == DriveSignal::kYawRate ? DriveUnknown::kYawRateDelay : DriveUnknown::kAccelYDelay;
    const Scalar delay = theta(static_cast<Eigen::Index>(which)) / grid_.step;
    for (std::size_t k = 0; k < shown[j].size(); ++k)
      output(k, j) = recorded(signal, between(shown[j], Scalar(static_cast<double>(k) - delay)), theta);
  }
}

template <int kStates, typename Scalar, typename Tyre>
bool DriveParametricModel::drive(const Segment& segment, const RollingBicycle<Scalar, Tyre>& model,
                                 const Parameters<Scalar>& theta, Extent extent, Outputs<Scalar>& output) const {
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Rates = RollingBicycleRates<Scalar, kStates>;
  const auto unknown = [&](DriveUnknown u) -> const Scalar& { return theta(static_cast<Eigen::Index>(u)); };
  const auto n = static_cast<std::size_t>(segment.samples);
  const std::span<const double> steer_all(steer_), speed_all(speed_);
  const double step = grid_.step;
  // The steering before and after the segment, as far as it is there, for its delay.
  const auto reach = static_cast<std::size_t>(kLongestDelay_s / step);
  std::size_t lead = 0, tail = 0;
  while (lead < reach && segment.begin > lead && std::isfinite(steer_all[segment.begin - lead - 1])) ++lead;
  while (tail < reach && segment.begin + n + tail < steer_all.size() &&
         std::isfinite(steer_all[segment.begin + n + tail]))
    ++tail;
  const SampledInput steer{std::span(steer_all).subspan(segment.begin - lead, lead + n + tail), step};
  const SampledInput speed{std::span(speed_all).subspan(segment.begin, n), step};

  const Scalar steer_gain = 1.0 / (1.0 + unknown(DriveUnknown::kSteerScale));
  const Scalar steer_lead = static_cast<double>(lead) - unknown(DriveUnknown::kSteerDelay) / step;
  struct Input {
    Scalar delta;
    Scalar u;
    DriveConditions<Scalar> conditions;
  };
  const auto first = signed_index(parameters_.size());
  const bool banked = options_.effects[DriveEffect::kBank];
  const Scalar bank =
      banked ? theta(first + signed_index(segment.initial.size() - options_.offsets.size()) - 1) : Scalar(0.0);
  const bool by_pedals = !speed_rate_.empty();
  const SampledInput speed_rate{
      by_pedals ? std::span<const double>(speed_rate_).subspan(segment.begin, n) : std::span<const double>(), step};
  const auto input = [&](double position) -> Input {
    const Scalar at = steer_lead + position;
    return {(steer.at(at) - unknown(DriveUnknown::kSteerBias)) * steer_gain,
            Scalar(speed.at(position)),
            {by_pedals ? speed_rate.at(position) : 0.0, banked, bank}};
  };
  const bool delayed = delays_outputs(sampled_value(unknown(DriveUnknown::kYawRateDelay)),
                                      sampled_value(unknown(DriveUnknown::kAccelYDelay)));
  std::vector<std::vector<Scalar>> shown(delayed ? compared_.size() : 0, std::vector<Scalar>(n));

  const double h = step / segment.substeps;
  Input now = input(0.0);
  State x = model.template steady<kStates>(theta(first), theta(first + 1), now.delta, now.u, now.conditions);
  for (Eigen::Index i = 2; i < kStates; ++i) x(i) += theta(first + i);
  for (std::size_t k = 0; k < n; ++k) {
    const auto row = signed_index(k);
    const bool plausible =
        x(0) < 2.0 * now.u && -x(0) < 2.0 * now.u && x(1) < kLargestYawRate && -x(1) < kLargestYawRate;
    if (!plausible) return false;
    if (extent == Extent::kTransient && k % kForgottenEvery == 0 && !depends_on_its_beginning(x)) {
      output.bottomRows(signed_index(n) - row).setConstant(Scalar(0.0));
      break;
    }
    for (int i = 0; i < segment.substeps; ++i) {
      const Rates k1 = model.rates(x, now.delta, now.u, now.conditions);
      if (i == 0) {
        for (std::size_t j = 0; j < compared_.size(); ++j) {
          const auto column = signed_index(j);
          Scalar true_value = true_output<kStates>(compared_[j].signal, x, k1, theta);
          if (compared_[j].signal == DriveSignal::kLateralVelocity)
            true_value += unknown(DriveUnknown::kSideslipBias) * now.u -
                          unknown(DriveUnknown::kCourseDelay) * k1.lateral_acceleration;
          if (delayed) shown[j][k] = true_value;
          output(row, column) = recorded(compared_[j].signal, true_value, theta);
        }
        if (k + 1 == n) break;
      }
      const double at = static_cast<double>(k) + static_cast<double>(i) / segment.substeps;
      const Input middle = input(at + 0.5 / segment.substeps);
      const Input next = input(at + 1.0 / segment.substeps);
      const auto rate = [&](numerics::RungeKuttaMoment moment, const State& stage) -> State {
        const Input& there = moment == numerics::RungeKuttaMoment::kMiddle ? middle : next;
        return model.rates(stage, there.delta, there.u, there.conditions).derivative;
      };
      x = numerics::runge_kutta_4_from(k1.derivative, rate, x, h);
      now = next;
    }
  }
  if (delayed) delay_outputs(shown, theta, output);
  return true;
}

template <typename Scalar, typename Work>
auto DriveParametricModel::with_model(const Parameters<Scalar>& theta, const Work& work) const {
  const auto unknown = [&](DriveUnknown u) -> const Scalar& { return theta(static_cast<Eigen::Index>(u)); };
  VehicleParameters<Scalar> p = start_.cast<Scalar>();
  p.C_f = unknown(DriveUnknown::kCf);
  p.C_r = unknown(DriveUnknown::kCr);
  p.I_z = unknown(DriveUnknown::kIz);
  p.a = unknown(DriveUnknown::kA);
  p.b = start_.wheelbase() - p.a;
  const auto with_tyres = [&]<typename Tyre>(const Tyre& front, const Tyre& rear) {
    const RollingBicycle<Scalar, Tyre> model{
        .bicycle = {.parameters = p, .front = front, .rear = rear, .gravity = options_.gravity},
        .roll = {.gradient = unknown(DriveUnknown::kRollGradient),
                 .frequency = unknown(DriveUnknown::kRollFrequency),
                 .damping = unknown(DriveUnknown::kRollDamping),
                 .arm = unknown(DriveUnknown::kRollArm)},
        .relaxation_length = unknown(DriveUnknown::kRelaxationLength),
        .load_transfer = {.effect = load_transfer_of<Scalar>(options_.structure),
                          .share = unknown(DriveUnknown::kLoadTransfer),
                          .loss = unknown(DriveUnknown::kLoadTransferLoss),
                          .balance = unknown(DriveUnknown::kLoadTransferBalance)},
        .axle_load = {.acts = moves_loads(),
                      .downforce_f = unknown(DriveUnknown::kDownforceF),
                      .downforce_r = unknown(DriveUnknown::kDownforceR),
                      .sensitivity = unknown(DriveUnknown::kLoadSensitivity),
                      .front_force_share = unknown(DriveUnknown::kFrontForceShare)},
        .roll_steer = {unknown(DriveUnknown::kRollSteerF), unknown(DriveUnknown::kRollSteerR)},
        .trail = unknown(DriveUnknown::kTrail)};
    switch (options_.structure) {
      case DriveStructure::kRoll:
        return work(model, std::integral_constant<int, 4>());
      case DriveStructure::kRelaxation:
        return work(model, std::integral_constant<int, 6>());
      case DriveStructure::kSaturation:
      case DriveStructure::kMagicFormula:
        if (sampled_value(model.relaxation_length) > 0.0) return work(model, std::integral_constant<int, 6>());
        return work(model, std::integral_constant<int, 4>());
      case DriveStructure::kBicycle:
      case DriveStructure::kScaledAccel:
        break;
    }
    return work(model, std::integral_constant<int, 2>());
  };
  return std::visit(
      [&]<typename Tyre>(const TyreLaw<Tyre>&) {
        const auto tyre = [&](const Scalar& stiffness, std::size_t wheel) {
          auto t = Tyre().template cast<Scalar>();
          t.stiffness = stiffness;
          if constexpr (Tyre::kNeedsFriction) t.mu = unknown(DriveUnknown::kMu);
          if constexpr (TyreWithShape<Tyre>) {
            t.C = unknown(DriveUnknown::kShape);
            t.E = unknown(DriveUnknown::kCurvature);
          }
          if constexpr (requires { t.nominal_load; }) t.nominal_load = static_loads(p, options_.gravity)[wheel];
          return t;
        };
        return with_tyres(tyre(p.C_f, kFrontLeft), tyre(p.C_r, kRearLeft));
      },
      options_.tyre);
}

template <typename Scalar>
bool DriveParametricModel::simulate(const Segment& segment, const Parameters<Scalar>& given, Extent extent,
                                    Outputs<Scalar>& output) const {
  Parameters<Scalar> theta = given;
  const std::vector<DriveUnknown>& offsets = options_.offsets;
  for (std::size_t i = 0; i < offsets.size(); ++i)
    theta(static_cast<Eigen::Index>(offsets[i])) += given(given.size() - signed_index(offsets.size() - i));
  return with_model(theta, [&](const auto& model, auto states) {
    return drive<decltype(states)::value>(segment, model, theta, extent, output);
  });
}

template <typename Scalar>
bool DriveParametricModel::simulate(std::size_t segment, const Parameters<Scalar>& theta,
                                    Outputs<Scalar>& output) const {
  return simulate(segments_[segment], theta, Extent::kWhole, output);
}

bool DriveParametricModel::simulate_transient(std::size_t segment,
                                              const Parameters<ceres::Jet<double, kDriveStride>>& theta,
                                              Outputs<ceres::Jet<double, kDriveStride>>& output) const {
  return simulate(segments_[segment], theta, Extent::kTransient, output);
}

template bool DriveParametricModel::simulate(std::size_t, const Parameters<double>&, Outputs<double>&) const;
template bool DriveParametricModel::simulate(std::size_t, const Parameters<ceres::Jet<double, kDriveStride>>&,
                                             Outputs<ceres::Jet<double, kDriveStride>>&) const;

LinearDrive DriveParametricModel::linearized(double u, const Eigen::VectorXd& theta) const {
  const auto outputs = signed_index(compared_.size());
  const double gain = 1.0 / (1.0 + theta(static_cast<Eigen::Index>(DriveUnknown::kSteerScale)));
  const double accel_scale = 1.0 + theta(static_cast<Eigen::Index>(DriveUnknown::kAccelYScale));
  return with_model(theta, [&](const auto& model, auto states) -> LinearDrive {
    constexpr int kStates = decltype(states)::value;
    using State = Eigen::Matrix<double, kStates, 1>;
    // There everything is odd in the state: a small step's difference is the derivative.
    constexpr double kSmall = 1e-6;
    LinearDrive out{.A = Eigen::MatrixXd(kStates, kStates),
                    .C = Eigen::MatrixXd(outputs, kStates),
                    .B = Eigen::VectorXd(kStates),
                    .D = Eigen::VectorXd(outputs)};
    for (Eigen::Index i = 0; i <= kStates; ++i) {
      State x = State::Zero();
      if (i < kStates) x(i) = kSmall;
      const RollingBicycleRates<double, kStates> rates = model.rates(x, i < kStates ? 0.0 : gain * kSmall, u);
      Eigen::VectorXd y(outputs);
      for (Eigen::Index j = 0; j < outputs; ++j) {
        const DriveSignal signal = compared_[at(j)].signal;
        const double scale = signal == DriveSignal::kAccelY ? accel_scale : 1.0;
        y(j) = scale * true_output<kStates>(signal, x, rates, theta) / kSmall;
        if (signal == DriveSignal::kLateralVelocity)
          y(j) -= theta(static_cast<Eigen::Index>(DriveUnknown::kCourseDelay)) * rates.lateral_acceleration / kSmall;
      }
      if (i < kStates) {
        out.A.col(i) = rates.derivative / kSmall;
        out.C.col(i) = y;
      } else {
        out.B = rates.derivative / kSmall;
        out.D = y;
      }
    }
    return out;
  });
}

estimation::InputNoise DriveParametricModel::steering_noise(const Eigen::VectorXd& theta) const {
  const auto outputs = signed_index(compared_.size());
  estimation::InputNoise out{.variance = Eigen::VectorXd::Zero(outputs),
                             .autocovariance = Eigen::VectorXd::Zero(outputs),
                             .memory = Eigen::VectorXd::Ones(outputs)};
  if (!(steer_sigma_ > 0.0) || !(steer_error_share_ > 0.0) || segments_.empty()) return out;
  const SpeedRange range = speeds();
  const DriveNoise noise = drive_noise(linearized(0.5 * (range.slowest + range.fastest), theta),
                                       {.sigma = steer_sigma_, .band_share = steer_error_share_, .step = grid_.step});
  if (!(numerics::general_eigenvalues(noise.F).cwiseAbs().maxCoeff() < 1.0)) return out;
  const Eigen::MatrixXd P = numerics::discrete_lyapunov(noise.F, noise.G * noise.G.transpose()).X;
  out.variance = (noise.C * P * noise.C.transpose()).diagonal().cwiseMax(0.0);
  // C F^k P C' is the autocovariance at k samples; all of them together are 2 C (1 - F)^-1 P C' less that at 0.
  const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(noise.F.rows(), noise.F.cols()) - noise.F;
  const Eigen::VectorXd sum =
      (noise.C * numerics::HouseholderQr(rest).solve(Eigen::MatrixXd(P * noise.C.transpose()))).diagonal();
  Eigen::MatrixXd later = P;
  for (Eigen::Index lag = 0; lag < estimation::kColourLags; ++lag) {
    later = noise.F * later;
    out.autocovariance +=
        (noise.C * later * noise.C.transpose()).diagonal() / static_cast<double>(estimation::kColourLags);
  }
  for (Eigen::Index j = 0; j < outputs; ++j)
    if (out.variance(j) > 0.0) out.memory(j) = std::max(1.0, 2.0 * sum(j) / out.variance(j) - 1.0);
  return out;
}

bool DriveParametricModel::moves_loads() const {
  return !speed_rate_.empty() || options_.effects[DriveEffect::kDownforce] ||
         options_.start[DriveUnknown::kDownforceF] != 0.0 || options_.start[DriveUnknown::kDownforceR] != 0.0;
}

DriveParametricModel::SpeedRange DriveParametricModel::speeds() const {
  double slowest = kInfinity, fastest = 0.0;
  for (const Segment& segment : segments_) {
    const auto [low, high] =
        std::ranges::minmax(std::span(speed_).subspan(segment.begin, static_cast<std::size_t>(segment.samples)));
    slowest = std::min(slowest, low);
    fastest = std::max(fastest, high);
  }
  return {slowest, fastest};
}

}  // namespace veridyn::vehicle
