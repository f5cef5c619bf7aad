#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/uncertainty/monte_carlo.hpp"

namespace veridyn::aircraft {

/// Monte Carlo uncertainty of the measured coefficients. Study table `[uncertainty]`.
struct UncertaintyOptions {
  bool enabled = true;
  std::size_t draws = 100000;
  EnumArray<FlightSignal, std::optional<double>, kFlightSignals> sigma;  ///< nothing: by the sensors
  double sigma_air_density = 0.0;

  [[nodiscard]] static const KeyTable<UncertaintyOptions>& keys();
};

/// Inputs of the six coefficients: the flight signals, the air density, the aircraft's constants.
inline constexpr std::size_t kCoefficientInputs = kFlightSignals + 1 + kBodyConstants;

/// Error of one coefficient as measured at a moment of this flight.
struct CoefficientUncertainty {
  Coefficient coefficient = Coefficient::kCL;
  estimation::ErrorDistribution error;  ///< by Monte Carlo
  double sigma_linear = 0.0;            ///< law of propagation of uncertainty, averaged over the operating range
  double sigma_sensors = 0.0;           ///< linear, of the sensors alone: differs from sample to sample
  double sigma_body = 0.0;              ///< linear, of mass, geometry and inertia: the same in all samples
  double range = 0.0;                   ///< standard deviation of the coefficient itself over the operating range
};

/// Uncertainty of all measured coefficients, and what it was computed from.
struct UncertaintyReport {
  estimation::UncertainInputs inputs;  ///< in the order of `kFlightSignalNames`, air_density, `kBodyConstantNames`
  std::vector<CoefficientUncertainty> coefficients;  ///< that can be measured: without inertia the forces only
  std::size_t draws = 0;
  double correlation_change = 0.0;  ///< by the repair of the copula
  double seconds = 0.0;             ///< of the Monte Carlo run
  std::string text;                 ///< one sentence
  [[nodiscard]] bool available() const { return !coefficients.empty(); }
};

/// Standard deviation that a calibration leaves, by channel (alpha, beta, airspeed, dynamic_pressure).
using CalibrationSigma = std::vector<std::pair<std::string, double>>;

/// Ranges and rank correlation of the signals while airborne: uniform between the 0.5 and 99.5 % quantiles of each
/// signal. Signals that the log has not are constant 0 without error. What a calibration leaves adds to the error of
/// alpha, beta and airspeed. Of several flights the range is that of all, and an error the root of the mean square over
/// the flights that have the signal.
[[nodiscard]] estimation::UncertainInputs coefficient_inputs(std::span<const PreparedFlight> flights,
                                                             const Subject& subject, const UncertaintyOptions& options,
                                                             const CalibrationSigma& calibration = {});

/// Errors of the coefficients that the subject allows for, by Monte Carlo and linearly.
[[nodiscard]] UncertaintyReport coefficient_uncertainty(const estimation::UncertainInputs& inputs,
                                                        const Subject& subject, const UncertaintyOptions& options,
                                                        std::uint64_t seed, int threads = 0);

/// As a table: coefficient, mc_sigma, low95, high95, mean, linear_sigma, sensor_sigma, body_sigma, range_sd.
[[nodiscard]] std::string to_csv(const UncertaintyReport& report);

}  // namespace veridyn::aircraft
