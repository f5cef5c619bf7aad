#include "veridyn/aircraft/flight_sensitivity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "veridyn/aircraft/simulation/flight_replay.hpp"
#include "veridyn/aircraft/simulation/simulate_study.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::IndexInput;
using estimation::Response;

/// Motion goes on after a manoeuvre's last deflection [s].
constexpr double kSettling_s = 1.0;
/// Differences below it, in standard deviations of the flight's signals, are rounding.
constexpr double kNoDifference = 1e-9;

/// View of a number of the subject that may vary.
struct SubjectNumber {
  std::string name, unit;
  double* value;
};

std::vector<SubjectNumber> subject_numbers(Subject& s) {
  std::vector<SubjectNumber> list;
  for (std::optional<CoefficientModel>& model : s.model.coefficients) {
    if (!model) continue;
    const std::vector<std::string> names = model->parameter_names();
    for (std::size_t i = 0; i < names.size(); ++i)
      list.push_back({names[i], model->terms[i].parameter_unit(), &model->values[i]});
  }
  list.push_back({"mass", "kg", &s.mass});
  if (s.inertia)
    for (const auto& [name, to] : {std::pair{"Jx", &s.inertia->Jx}, std::pair{"Jy", &s.inertia->Jy},
                                   std::pair{"Jz", &s.inertia->Jz}, std::pair{"Jxz", &s.inertia->Jxz}})
      list.push_back({name, "kg m^2", to});
  return list;
}

Subject subject_at(Subject subject, std::span<const IndexInput> inputs, const Eigen::VectorXd& point) {
  const std::vector<SubjectNumber> numbers = subject_numbers(subject);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (const SubjectNumber& number : numbers)
      if (number.name == inputs[i].name) *number.value = point(i);
  }
  return subject;
}

void check_flight_inputs(std::span<const IndexInput> inputs, const Subject& nominal) {
  for (const IndexInput& input : inputs) {
    for (const double end : {input.low, input.high}) {
      const Subject s = subject_at(nominal, std::span(&input, 1), Eigen::VectorXd::Constant(1, end));
      const bool heavy = s.mass > 0.0, turns = s.inertia && s.inertia->positive_definite();
      if (!heavy || !turns)
        throw InputError(input.place, fmt::format("{} from {:g}: {}", input.name, end,
                                                  heavy ? "the inertia is not positive definite" : "must be > 0"));
    }
  }
}

/// Samples of the flight that are flown again.
struct Stretch {
  std::string name;
  std::size_t begin, end;
};

std::string stretch_name(const Manoeuvre& m) {
  std::vector<std::string_view> surfaces;
  for (const Surface s : m.surfaces) surfaces.push_back(kSurfaceNames[s]);
  std::string text = fmt::format("{:g} s: {}", m.start, name_of(m.kind));
  if (!surfaces.empty()) text += fmt::format(" {}", fmt::join(surfaces, ", "));
  return text;
}

std::vector<Stretch> stretches_of(const SimulatedFlight& flight, const FlightReplay& replay, double longest) {
  std::vector<Stretch> list;
  const auto sample_at = [&](double t) {
    std::size_t k = 0;
    while (k < replay.samples() && replay.time(k) < t - 1e-9) ++k;
    return k;
  };
  for (const Manoeuvre& m : flight.manoeuvres) {
    const double end = std::min(m.end() + kSettling_s, m.start + longest);
    const Stretch stretch{stretch_name(m), sample_at(m.start), std::min(replay.samples(), sample_at(end) + 1)};
    if (stretch.end > stretch.begin + 1) list.push_back(stretch);
  }
  if (list.empty()) list.push_back({"straight and level", 0, std::min(replay.samples(), sample_at(longest) + 1)});
  return list;
}

double spread(const std::vector<double>& x) {
  double mean = 0.0, sum = 0.0;
  for (const double v : x) mean += v / static_cast<double>(x.size());
  for (const double v : x) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / static_cast<double>(x.size()));
}

/// Manoeuvres of the nominal flight, to be flown again by changed aircraft on any thread.
class ChangedFlights {
 public:
  ChangedFlights(const FlightSensitivityStudy& study, const SimulatedFlight& flight)
      : subject_(study.flight.subject), inputs_(study.inputs), replay_(flight.truth, study.flight.gravity) {
    for (std::size_t i = 0; i < kReplaySignals.size(); ++i) scale_[i] = spread(replay_.flown(i));
    stretches_ = stretches_of(flight, replay_, study.options.longest);
    for (const Stretch& s : stretches_) {
      Eigen::MatrixXd signals;
      if (!replay_.fly(subject_, s.begin, s.end, signals))
        throw std::runtime_error(
            fmt::format("the nominal aircraft departs when it flies {} again open loop; a shorter "
                        "sensitivity.longest helps",
                        s.name));
      nominal_.push_back(std::move(signals));
      responses_.push_back({.name = s.name, .negligible = kNoDifference});
    }
    for (const std::string_view name : kReplayNames)
      responses_.push_back({.name = std::string(name), .negligible = kNoDifference});
  }

  [[nodiscard]] const std::vector<Response>& responses() const { return responses_; }

  [[nodiscard]] std::uint64_t fingerprint() const {
    numerics::Fingerprint print;
    for (const Eigen::MatrixXd& signals : nominal_)
      for (const double v : signals.reshaped()) print.add(v);
    return print.value();
  }

  bool respond(const Eigen::VectorXd& point, std::span<double> values) const {
    const Subject subject = subject_at(subject_, inputs_, point);
    std::array<double, kReplaySignals.size()> by_signal{};
    double samples = 0.0;
    for (std::size_t s = 0; s < stretches_.size(); ++s) {
      Eigen::MatrixXd signals;
      if (!replay_.fly(subject, stretches_[s].begin, stretches_[s].end, signals)) return false;
      const auto columns = static_cast<double>(signals.cols());
      const Eigen::VectorXd squares = (signals - nominal_[s]).rowwise().squaredNorm();
      double sum = 0.0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < kReplaySignals.size(); ++i) {
        if (!(scale_[i] > kNoDifference)) continue;
        const double square = squares(i) / (scale_[i] * scale_[i]);
        by_signal[i] += square;
        sum += square / columns;
        ++count;
      }
      values[s] = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, count)));
      samples += columns;
    }
    for (std::size_t i = 0; i < kReplaySignals.size(); ++i)
      values[stretches_.size() + i] = std::sqrt(by_signal[i] / samples);
    return true;
  }

 private:
  Subject subject_;
  std::vector<IndexInput> inputs_;
  FlightReplay replay_;
  std::array<double, kReplaySignals.size()> scale_{};
  std::vector<Stretch> stretches_;
  std::vector<Eigen::MatrixXd> nominal_;
  std::vector<Response> responses_;
};

}  // namespace

const KeyTable<FlightSensitivityOptions>& FlightSensitivityOptions::keys() {
  using O = FlightSensitivityOptions;
  static const auto table =
      KeyTable<O>("sensitivity",
                  "What varies: by default each number of the aircraft that is not 0, parameters of the model by name "
                  "(`CL_alpha`), `mass`, `Jx`, `Jy`, `Jz`, `Jxz`; and how indices are computed.")
          .number("longest", &O::longest, "s", kPositive, "longest part of each manoeuvre that is flown again")
          .with(IndexOptions::keys())
          .with(&O::given, estimation::GivenInputs::keys())
          .check([](const StudyTable& t, O& o) {
            if (o.method == estimation::IndexMethod::kNone)
              t.fail("method", "= \"none\" leaves nothing to compute; take \"variance\" or \"morris\"");
          });
  return table;
}

FlightSensitivityStudy read_flight_sensitivity(const StudyTable& root) {
  FlightSensitivityStudy study{.flight = read_simulation(root)};
  if (!study.flight.changes.empty())
    root.table("flight").fail("change", "has no place in a sensitivity, which is of one aircraft: leave it out");
  study.options = FlightSensitivityOptions::keys().read(root.table_or_empty("sensitivity"));
  study.options.variance.seed = study.flight.seed;
  std::vector<IndexInput> known;
  std::vector<std::string> defaults;
  Subject subject = study.flight.subject;
  for (const SubjectNumber& number : subject_numbers(subject)) {
    if (!std::isfinite(*number.value)) continue;  // `simulate` says that it needs a value
    known.push_back({.name = number.name, .unit = number.unit, .nominal = *number.value});
    if (*number.value != 0.0) defaults.push_back(number.name);
  }
  study.inputs = estimation::index_inputs(study.options.given, known, defaults);
  check_flight_inputs(study.inputs, study.flight.subject);
  return study;
}

estimation::ResponseIndices analyse_flight(const FlightSensitivityStudy& study, numerics::BlockStore& store,
                                           Progress& progress) {
  SimulationOptions options = study.flight;
  const SimulatedFlight flight = simulate(options, progress);
  estimation::ResponseIndices stopped;
  stopped.completed = false;
  if (flight.end == FlightEnd::kInterrupted) return stopped;
  if (!flight.usable()) throw std::runtime_error(fmt::format("the nominal flight ends early: {}", flight.message()));
  const ChangedFlights flights(study, flight);
  progress.stage(fmt::format("flying it again with {} inputs varied", study.inputs.size()));
  return estimation::response_indices(
      {.inputs = study.inputs,
       .responses = flights.responses(),
       .run = [&](const Eigen::VectorXd& point, std::span<double> values) { return flights.respond(point, values); },
       .fingerprint = flights.fingerprint()},
      study.options, store, progress);
}

}  // namespace veridyn::aircraft
