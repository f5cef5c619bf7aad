// The full pipeline: from a flight to a validated aerodynamic model, in one call.
//
// The study simulates its flight, so the truth is known; with `[data]` instead of `[flight]` it reads a log. The
// program `veridyn identify` does the same and writes the report.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "picture.hpp"
#include "veridyn/aircraft.hpp"

int main() try {
  using namespace veridyn;
  const Study study = Study::parse(R"(
    seed = 1
    [subject]
    builtin = "unatrap"
    [flight]
    duration = 300
    [reconstruct]
    sensors = "reference"
  )",
                                   "example 05");
  Progress silent;
  const aircraft::FlightStudy flight = aircraft::read_study(study, silent);
  const aircraft::FlightAnalysis analysis = aircraft::identify(flight, silent);

  std::vector<std::string> labels;
  std::vector<double> value, low, high, true_value;
  for (const aircraft::CoefficientResult& coefficient : analysis.coefficients) {
    std::printf("%-12s %s\n", std::string(estimation::to_string(coefficient.verdict)).c_str(),
                coefficient.reason.c_str());
    const aircraft::CoefficientModel* truth = flight.true_subject->model.find(coefficient.coefficient);
    if (!coefficient.chosen || truth == nullptr) continue;
    for (std::size_t i = 0; i < coefficient.model.size(); ++i) {
      const estimation::Parameter& p = coefficient.chosen->parameters[i];
      const double exact = truth->value_of(coefficient.model.terms[i].expression).value_or(kNaN);
      std::printf("    %-10s %9.4f  [%9.4f, %9.4f]  true %9.4f  %s\n", p.name.c_str(), p.value, p.low95, p.high95,
                  exact, std::string(estimation::to_string(p.status)).c_str());
      labels.push_back(p.name);
      value.push_back(p.value);
      low.push_back(p.low95);
      high.push_back(p.high95);
      true_value.push_back(exact);
    }
  }
  picture::write("05_identify.csv", {{"value", value}, {"low", low}, {"high", high}, {"true", true_value}}, labels);
  for (const aircraft::PredictedQuantity& q : analysis.validation.quantities) {
    std::printf("hold-out: %s MAE %.3g %s, Theil %.3f\n", q.name.c_str(), q.fit.mae, q.unit.c_str(), q.fit.theil);
  }
  return aircraft::identified_coefficients(analysis.coefficients).empty() ? 1 : 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
