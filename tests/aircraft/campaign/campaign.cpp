#include "tests/aircraft/campaign/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/error.hpp"

namespace veridyn::aircraft::testing {
namespace {

using estimation::Grade;

class OneThread : public Progress {
 public:
  [[nodiscard]] int threads() const override { return 1; }
};

Grade parameters_grade(const Identified& flight, const std::string& group) {
  for (const CoefficientResult& result : flight.analysis.coefficients)
    if (result.name == group && result.chosen) return result.judgement.parameters.grade;
  return Grade::kNotJudged;
}

/// Whether the program says less of this flight than of the clean one.
bool is_found(const Identified& flight, const Identified& clean) {
  if (flight.refused || flight.analysis.estimate.judgement.data.grade > clean.analysis.estimate.judgement.data.grade)
    return true;
  return std::ranges::any_of(clean.analysis.coefficients, [&](const CoefficientResult& result) {
    return parameters_grade(flight, result.name) > parameters_grade(clean, result.name);
  });
}

test::Outcomes outcomes_of(const Identified& flight) {
  return {.refused = flight.refused,
          .message = flight.message,
          .evidence = flight.analysis.estimate.evidence,
          .confidence = flight.confidence};
}

}  // namespace

FlightStudy campaign_flight(const std::string& aircraft, std::uint64_t seed, double duration_s,
                            const std::string& turbulence, Assumed assumed) {
  OneThread silent;
  const std::string text = fmt::format(
      "seed = {}\n[subject]\nbuiltin = \"{}\"\n[flight]\nduration = {}\naltitude = 300\nwind = [4, -3, 0]\n"
      "turbulence = \"{}\"\n{}",
      seed, aircraft, duration_s, turbulence,
      assumed == Assumed::kNothing
          ? std::string()
          : fmt::format("[reconstruct]\nsensors = \"reference\"\nturbulence = \"{}\"\n", turbulence));
  return read_study(Study::parse(text, aircraft + ".toml"), silent);
}

Identified identified(const FlightStudy& study) {
  OneThread silent;
  Identified flight;
  try {
    flight.analysis = identify(study, silent);
  } catch (const InputError& e) {
    flight.refused = true;
    flight.message = e.what();
    return flight;
  }
  for (const estimation::ParameterGroup& group : flight.analysis.groups) {
    if (group.judgement.parameters.grade != Grade::kYes) continue;
    flight.confidence.add(group.parameters, flight.analysis.truth);
  }
  return flight;
}

Trial try_fault(const FlightStudy& study, const Identified& clean, const Fault& fault) {
  FlightStudy faulty = study;
  fault.apply(faulty);
  const Identified flight = identified(faulty);
  Trial trial = test::tried(outcomes_of(flight), outcomes_of(clean), is_found(flight, clean), fault.rows);
  trial.subject = study.subject.name;
  trial.fault = fault.name;
  if (flight.refused) return trial;
  trial.data = to_string(flight.analysis.estimate.judgement.data.grade);
  trial.parameters = to_string(flight.analysis.estimate.judgement.parameters.grade);
  return trial;
}

std::string confusion_table(const std::vector<Trial>& trials) {
  std::vector<std::string> names;
  for (const Fault& fault : faults()) names.push_back(fault.name);
  return test::confusion_table(trials, names);
}

}  // namespace veridyn::aircraft::testing
