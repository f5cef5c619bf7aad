#include "veridyn/aircraft/identification/fit/coefficient_uncertainty.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/fit/body_error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/gaussian_copula.hpp"

namespace veridyn::aircraft {
namespace {

/// Samples from which ranges and correlation are taken: more would not change them.
constexpr std::size_t kRangeSamples = 20000;
constexpr double kTail = 0.005;

template <typename Scalar>
AeroCoefficients<Scalar> coefficients_of(const Scalar* x, const Subject& subject) {
  FlightSample<Scalar> sample;
  std::copy(x, x + kFlightSignals, sample.value.begin());
  BodyConstants<Scalar> body;
  std::copy(x + kFlightSignals + 1, x + kCoefficientInputs, body.value.begin());
  return measured_coefficients(sample, subject, body, x[kFlightSignals], Scalar(0.0));
}

Eigen::MatrixXd jacobian_at(const Eigen::VectorXd& x, const Subject& subject) {
  using Jet = ceres::Jet<double, static_cast<int>(kCoefficientInputs)>;
  std::array<Jet, kCoefficientInputs> jets;
  for (std::size_t i = 0; i < kCoefficientInputs; ++i)
    jets[i] = Jet(x(static_cast<Eigen::Index>(i)), static_cast<int>(i));
  const AeroCoefficients<Jet> c = coefficients_of(jets.data(), subject);
  Eigen::MatrixXd J(static_cast<Eigen::Index>(kCoefficients), static_cast<Eigen::Index>(kCoefficientInputs));
  for (std::size_t i = 0; i < kCoefficients; ++i)
    J.row(static_cast<Eigen::Index>(i)) = select(c, static_cast<Coefficient>(i)).v.transpose();
  return J;
}

/// A moment of one of the flights.
struct FlightMoment {
  const FlightSignals* signals;
  std::size_t at;
};

std::vector<FlightMoment> airborne_samples(std::span<const PreparedFlight> flights) {
  std::vector<FlightMoment> rows;
  for (const PreparedFlight& flight : flights) {
    if (!flight.usable()) continue;
    for (const TimeSpan& span : flight.segments.airborne) {
      const auto [begin, end] = flight.signals.indices(span);
      for (std::size_t k = begin; k < end; ++k) {
        const FlightSample<double> s = flight.signals.sample(k);
        if (std::all_of(s.value.begin(), s.value.end(), [](double v) { return std::isfinite(v); }) &&
            s[FlightSignal::kAirspeed] > 0.0) {
          rows.push_back({&flight.signals, k});
        }
      }
    }
  }
  const std::size_t step = std::max<std::size_t>(1, rows.size() / kRangeSamples);
  std::vector<FlightMoment> thinned;
  for (std::size_t i = 0; i < rows.size(); i += step) thinned.push_back(rows[i]);
  return thinned;
}

}  // namespace

const KeyTable<UncertaintyOptions>& UncertaintyOptions::keys() {
  using O = UncertaintyOptions;
  static constexpr EnumArray<FlightSignal, std::string_view, kFlightSignals> kUnits{
      {"rad", "rad", "m/s", "m/s^2", "m/s^2", "m/s^2", "rad/s", "rad/s", "rad/s", "rad/s^2", "rad/s^2", "rad/s^2",
       "rad", "rad", "rad", "N"}};
  static const auto table = [] {
    KeyTable<O> errors("sigma",
                       "Standard deviations of the errors of flight signals, in place of what the sensors leave.");
    for (const FlightSignal signal : enumerators<FlightSignal, kFlightSignals>())
      errors.number(
          std::string(kFlightSignalNames[signal]), [signal](O & o) -> auto& { return o.sigma[signal]; },
          std::string(kUnits[signal]), kNotNegative, "");
    errors.number("air_density", &O::sigma_air_density, "kg/m^3", kNotNegative, "");
    return KeyTable<O>("uncertainty", "The Monte Carlo run of what measured coefficients are worth.")
        .flag("enabled", &O::enabled, "whether it is run")
        .count("draws", &O::draws, 100, 100'000'000, "how often every input is drawn")
        .table("sigma", std::identity(), errors);
  }();
  return table;
}

estimation::UncertainInputs coefficient_inputs(std::span<const PreparedFlight> flights, const Subject& subject,
                                               const UncertaintyOptions& options, const CalibrationSigma& calibration) {
  const auto n = static_cast<Eigen::Index>(kCoefficientInputs);
  const auto measured = static_cast<Eigen::Index>(kFlightSignals + 1);
  estimation::UncertainInputs inputs;
  inputs.low = Eigen::VectorXd::Zero(n);
  inputs.high = Eigen::VectorXd::Zero(n);
  inputs.correlation = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(n);

  const std::vector<FlightMoment> rows = airborne_samples(flights);
  Eigen::MatrixXd samples(signed_index(rows.size()), measured);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const FlightSample<double> s = rows[i].signals->sample(rows[i].at);
    for (std::size_t j = 0; j < kFlightSignals; ++j)
      samples(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = s.value[j];
    samples(static_cast<Eigen::Index>(i), measured - 1) = rows[i].signals->air_density[rows[i].at];
  }
  for (std::size_t j = 0; j < kFlightSignals; ++j) {
    inputs.names.emplace_back(kFlightSignalNames[j]);
    double squares = 0.0, count = 0.0;
    for (const PreparedFlight& flight : flights) {
      const GridSignal& signal = flight.signals.signals[j];
      if (!signal.available()) continue;
      squares += signal.sigma * signal.sigma;
      count += 1.0;
    }
    if (count > 0.0) sigma(static_cast<Eigen::Index>(j)) = options.sigma[j].value_or(std::sqrt(squares / count));
  }
  inputs.names.emplace_back("air_density");
  sigma(measured - 1) = options.sigma_air_density;
  if (!rows.empty()) {
    inputs.correlation.topLeftCorner(measured, measured) = numerics::rank_correlation(samples);
    for (Eigen::Index j = 0; j < measured; ++j) {
      std::vector<double> column(samples.col(j).begin(), samples.col(j).end());
      std::sort(column.begin(), column.end());
      const auto tail = static_cast<std::size_t>(kTail * static_cast<double>(column.size()));
      inputs.low(j) = column[tail];
      inputs.high(j) = column[column.size() - 1 - tail];
    }
  } else {
    inputs.names.clear();  // nothing was flown: there is no operating range
    return inputs;
  }
  const BodyConstants<double> body = body_constants<double>(subject);
  const EnumArray<BodyConstant, double, kBodyConstants> known = body_sigma(subject);
  for (std::size_t j = 0; j < kBodyConstants; ++j) {
    const Eigen::Index at = measured + static_cast<Eigen::Index>(j);
    inputs.names.emplace_back(kBodyConstantNames[j]);
    inputs.low(at) = inputs.high(at) = body.value[j];
    sigma(at) = known[j];
  }
  const auto airspeed = static_cast<Eigen::Index>(FlightSignal::kAirspeed);
  const double Va = 0.5 * (inputs.low(airspeed) + inputs.high(airspeed));
  const double rho = 0.5 * (inputs.low(measured - 1) + inputs.high(measured - 1));
  for (const auto& [channel, left] : calibration) {
    const auto add = [&](FlightSignal which, double s) {
      const auto at = static_cast<Eigen::Index>(which);
      sigma(at) = std::hypot(sigma(at), s);
    };
    if (channel == "alpha") add(FlightSignal::kAlpha, left);
    if (channel == "beta") add(FlightSignal::kBeta, left);
    if (channel == "airspeed") add(FlightSignal::kAirspeed, left);
    if (channel == "dynamic_pressure" && Va > 0.0) add(FlightSignal::kAirspeed, left / (rho * Va));
  }
  inputs.error_covariance = sigma.cwiseAbs2().asDiagonal();
  return inputs;
}

UncertaintyReport coefficient_uncertainty(const estimation::UncertainInputs& inputs, const Subject& subject,
                                          const UncertaintyOptions& options, std::uint64_t seed, int threads) {
  UncertaintyReport report;
  report.inputs = inputs;
  if (!options.enabled || inputs.names.size() != kCoefficientInputs) return report;
  const estimation::InputsToOutputs f = [&](const double* x, double* y) {
    const AeroCoefficients<double> c = coefficients_of(x, subject);
    for (std::size_t i = 0; i < kCoefficients; ++i) y[i] = select(c, static_cast<Coefficient>(i));
  };
  const estimation::InputsToJacobian jacobian = [&](const Eigen::VectorXd& x) { return jacobian_at(x, subject); };
  const estimation::MonteCarloResult result = estimation::propagate_errors(
      inputs, kCoefficients, f, {.draws = options.draws, .seed = seed, .threads = threads});

  const auto linear = [&](bool sensors, bool body) {
    estimation::UncertainInputs part = inputs;
    const auto measured = static_cast<Eigen::Index>(kFlightSignals + 1);
    if (!sensors) part.error_covariance.topLeftCorner(measured, measured).setZero();
    if (!body)
      part.error_covariance.bottomRightCorner(part.low.size() - measured, part.low.size() - measured).setZero();
    return estimation::linear_error_propagation(part, kCoefficients, jacobian, 500, seed);
  };
  const Eigen::VectorXd all = linear(true, true), sensors = linear(true, false), body = linear(false, true);
  // The coefficient's spread: what the error is to be compared with.
  estimation::UncertainInputs spread = inputs;
  const Eigen::VectorXd width = inputs.high - inputs.low;
  spread.low = spread.high = 0.5 * (inputs.low + inputs.high);
  spread.error_covariance = width.asDiagonal() * inputs.correlation * width.asDiagonal() / 12.0;
  const Eigen::VectorXd range = estimation::linear_error_propagation(spread, kCoefficients, jacobian, 0, seed);

  const std::size_t count = subject.inertia ? kCoefficients : 3;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    report.coefficients.push_back({.coefficient = static_cast<Coefficient>(i),
                                   .error = result.outputs[i],
                                   .sigma_linear = all(at),
                                   .sigma_sensors = sensors(at),
                                   .sigma_body = body(at),
                                   .range = range(at)});
  }
  report.draws = result.draws;
  report.correlation_change = result.correlation_change;
  report.seconds = result.seconds;
  report.text = fmt::format(
      "{} draws of {} inputs over the operating range of this flight (Gaussian copula of the measured rank "
      "correlation{}){}",
      result.draws, kCoefficientInputs,
      result.correlation_change > 0.005 ? fmt::format(", repaired by at most {:.2f}", result.correlation_change) : "",
      subject.inertia ? "" : "; without inertia the forces only");
  return report;
}

std::string to_csv(const UncertaintyReport& report) {
  std::string text =
      "coefficient,mc_sigma,low95,high95,mean,sd,endpoint_error,linear_sigma,sensor_sigma,body_sigma,range_sd\n";
  for (const CoefficientUncertainty& c : report.coefficients) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", name_of(c.coefficient), c.error.sigma, c.error.low,
                        c.error.high, c.error.mean, c.error.sd, c.error.endpoint_error, c.sigma_linear, c.sigma_sensors,
                        c.sigma_body, c.range);
  }
  return text;
}

}  // namespace veridyn::aircraft
