// Monte Carlo uncertainty of all six coefficients: 1e5 draws of 25 coupled inputs and their errors.
#include <benchmark/benchmark.h>

#include "veridyn/aircraft/identification/fit/coefficient_uncertainty.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace {
using namespace veridyn::aircraft;

void monte_carlo_six_coefficients(benchmark::State& state) {
  const Subject subject = builtin_subject("thor");
  const auto n = static_cast<Eigen::Index>(kCoefficientInputs);
  veridyn::estimation::UncertainInputs inputs;
  for (const auto& name : kFlightSignalNames) inputs.names.emplace_back(name);
  inputs.names.emplace_back("air_density");
  for (const auto& name : kBodyConstantNames) inputs.names.emplace_back(name);
  inputs.low = Eigen::VectorXd::Constant(n, -0.2);
  inputs.high = Eigen::VectorXd::Constant(n, 0.2);
  inputs.low(2) = 12.0;
  inputs.high(2) = 20.0;
  inputs.low(static_cast<Eigen::Index>(kFlightSignals)) = inputs.high(static_cast<Eigen::Index>(kFlightSignals)) = 1.2;
  const auto body = body_constants<double>(subject);
  for (std::size_t i = 0; i < kBodyConstants; ++i) {
    const auto at = static_cast<Eigen::Index>(kFlightSignals + 1 + i);
    inputs.low(at) = inputs.high(at) = body.value[i];
  }
  inputs.correlation = Eigen::MatrixXd::Constant(n, n, 0.3);
  inputs.correlation.diagonal().setOnes();
  inputs.error_covariance = 1e-4 * Eigen::MatrixXd::Identity(n, n);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        coefficient_uncertainty(inputs, subject, {}, 1, static_cast<unsigned>(state.range(0))).coefficients.data());
  }
}
BENCHMARK(monte_carlo_six_coefficients)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
