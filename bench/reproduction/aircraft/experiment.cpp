#include "bench/reproduction/aircraft/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {

ExperimentOptions ExperimentOptions::read(const StudyTable& root) {
  ExperimentOptions o;
  o.flight = read_simulation(root);
  const StudyTable table = root.table("experiment");
  const std::vector<std::string> names(kCoefficientNames.begin(), kCoefficientNames.end());
  o.coefficient = *find_coefficient(table.choice_or("coefficient", names, "CL"));
  if (o.flight.subject.model.find(o.coefficient) == nullptr)
    table.fail("coefficient", fmt::format("{} is not in the subject's model", name_of(o.coefficient)));
  o.seeds = static_cast<int>(table.integer_or("seeds", o.seeds));
  if (!(o.seeds >= 1 && o.seeds <= 1000000)) table.fail("seeds", fmt::format("= {} must be from 1 to 1e6", o.seeds));
  o.rate_Hz = table.positive_or("rate", "Hz", o.rate_Hz);
  if (o.rate_Hz > o.flight.truth_rate * (1.0 + 1e-9))
    table.fail("rate", fmt::format("= {:g} Hz is above flight.truth_rate, {:g} Hz", o.rate_Hz, o.flight.truth_rate));
  const std::vector<double> ends = table.has("spans") ? table.numbers("spans", "s") : std::vector<double>{};
  if (ends.size() % 2 != 0) table.fail("spans", "must hold a beginning and an end for each span");
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    if (!(ends[i + 1] > ends[i])) table.fail("spans", fmt::format("{:g} s is not after {:g} s", ends[i + 1], ends[i]));
    o.spans.push_back({ends[i], ends[i + 1]});
  }
  o.snr_dB = table.number_or("snr", "1", o.snr_dB);
  o.regressor_snr_dB = table.optional_number("regressor_snr", "1");
  if (table.has("events")) o.events_s = table.numbers("events", "s");
  o.noise_time_s = table.number_or("noise_time", "s", 0.0);
  if (!(o.noise_time_s >= 0.0)) table.fail("noise_time", "must be >= 0");
  return o;
}

ExactRows exact_rows(const ExperimentOptions& o, Progress& progress) {
  const SimulatedFlight flight = simulate(o.flight, progress);
  if (!flight.usable()) throw InputError("flight", flight.message());
  Subject subject = o.flight.subject;
  const CoefficientModel& structure = subject.model.at(o.coefficient);
  const Recording& truth = flight.truth;
  const std::span<const double> time = truth.at("alpha").times();
  const auto stride = static_cast<std::size_t>(std::max(1L, std::lround(o.flight.truth_rate / o.rate_Hz)));
  std::vector<std::size_t> used;
  for (std::size_t k = 0; k < time.size(); k += stride) {
    const bool inside = o.spans.empty() || std::any_of(o.spans.begin(), o.spans.end(), [&](const TimeSpan& s) {
                          return time[k] >= s.begin && time[k] < s.end;
                        });
    if (inside) used.push_back(k);
  }
  const auto n = signed_index(structure.size());
  const auto count = signed_index(used.size());
  if (count < 2 * n) throw InputError("experiment.spans", "leave no rows of the flight");

  ExactRows rows;
  rows.names = structure.parameter_names();
  rows.truth = Eigen::Map<const Eigen::VectorXd>(structure.values.data(), n);
  rows.regressors.resize(count, n);
  rows.regressand.resize(count);
  rows.truth_at.resize(count, n);
  using F = FlightSignal;
  constexpr std::pair<F, const char*> sources[] = {
      {F::kAlpha, "alpha"},   {F::kBeta, "beta"},    {F::kAirspeed, "airspeed"}, {F::kP, "gyro_x"},
      {F::kQ, "gyro_y"},      {F::kR, "gyro_z"},     {F::kElevator, "elevator"}, {F::kAileron, "aileron"},
      {F::kRudder, "rudder"}, {F::kThrust, "thrust"}};
  std::vector<const std::vector<double>*> columns;
  for (const auto& [signal, name] : sources) columns.push_back(&truth.at(name).value);
  const std::vector<double>& density = truth.at("air_density").value;
  std::size_t changed = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t k = used[i];
    while (changed < o.flight.changes.size() && time[k] >= o.flight.changes[changed].time - 1e-9)
      subject.model = o.flight.changes[changed++].model;
    FlightSample<double> sample;
    for (std::size_t c = 0; c < columns.size(); ++c) sample[sources[c].first] = (*columns[c])[k];
    const AeroVariables<double> v = aero_variables(sample, subject, density[k]);
    const CoefficientModel& model = subject.model.at(o.coefficient);
    rows.time.push_back(time[k]);
    rows.regressors.row(i) = model.regressors(v).transpose();
    rows.regressand(i) = select(subject.model.evaluate(v), o.coefficient);
    rows.truth_at.row(i) = Eigen::Map<const Eigen::RowVectorXd>(model.values.data(), n);
  }

  const auto deviation = [](const Eigen::VectorXd& x) { return std::sqrt((x.array() - x.mean()).square().mean()); };
  rows.noise_sd = Eigen::VectorXd::Zero(n + 1);
  for (Eigen::Index j = 0; j < n; ++j) {
    if (!o.regressor_snr_dB || structure.terms[j].constant()) continue;
    rows.noise_sd(j) = deviation(rows.regressors.col(j)) * std::pow(10.0, -*o.regressor_snr_dB / 20.0);
    if (!(rows.noise_sd(j) > 0.0))
      throw InputError("experiment", fmt::format("the flight never moves the regressor of {}", rows.names[j]));
  }
  rows.noise_sd(n) = deviation(rows.regressand) * std::pow(10.0, -o.snr_dB / 20.0);
  return rows;
}

estimation::RegressionData noisy_rows(const ExactRows& rows, const ExperimentOptions& o, std::uint64_t number) {
  const Eigen::Index n = rows.regressors.cols();
  estimation::RegressionData data;
  data.parameter_names = rows.names;
  data.regressand_name = name_of(o.coefficient);
  data.regressors = rows.regressors;
  data.regressand = rows.regressand;
  if (o.regressor_snr_dB) data.error_covariance = rows.error_covariance();
  // First-order noise of unit variance with that correlation time, started in its stationary distribution.
  const double keep = o.noise_time_s > 0.0 ? std::exp(-1.0 / (o.rate_Hz * o.noise_time_s)) : 0.0;
  const double fresh = std::sqrt(1.0 - keep * keep);
  for (Eigen::Index j = 0; j <= n; ++j) {
    if (rows.noise_sd(j) == 0.0) continue;
    numerics::RandomStream random(o.flight.seed, fmt::format("experiment {} column {}", number, static_cast<long>(j)));
    double state = random.normal();
    for (Eigen::Index i = 0; i < data.regressand.size(); ++i) {
      if (i > 0) state = keep * state + fresh * random.normal();
      (j < n ? data.regressors(i, j) : data.regressand(i)) += rows.noise_sd(j) * state;
    }
  }
  return data;
}

}  // namespace veridyn::aircraft
