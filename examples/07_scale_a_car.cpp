// A car at one fifth of its size: what it has to weigh, how stiff its tyres have to be, and whether the one that was
// built is similar.
#include <cstdio>
#include <string>
#include <vector>

#include "picture.hpp"
#include "veridyn/vehicle.hpp"

int main() {
  using namespace veridyn::vehicle;
  const BuiltinVehicle& car = builtin_vehicle("reference");
  const SimilaritySubject prototype{.parameters = car.parameters, .speed = car.speed};

  const ScaledVehicle twin = scale(prototype, {.length_ratio = 0.2});
  std::printf("the twin: %.1f kg, wheelbase %.2f m, %.1f m/s, tyres of %.0f and %.0f N/rad\n",
              twin.model.parameters.mass, twin.model.parameters.wheelbase(), twin.model.speed,
              twin.model.parameters.C_f, twin.model.parameters.C_r);

  const BuiltinVehicle& built = builtin_vehicle("reference_1to5");
  const SimilarityReport report =
      compare(prototype, SimilaritySubject{.parameters = built.parameters, .speed = built.speed});
  std::printf("the one that was built: %s\n", report.message().c_str());
  std::vector<std::string> labels;
  std::vector<double> mismatch;
  for (const GroupComparison& group : report.groups) {
    labels.push_back(group.parameter + ": " + group.formula);
    mismatch.push_back(group.mismatch_percent);
  }
  picture::write("07_scale_a_car.csv", {{"mismatch[%]", mismatch}}, labels);
  for (const GroupComparison& group : report.mismatches()) {
    std::printf("  %-4s %-16s %8.5f %8.5f  %+5.1f %%  %s\n", group.parameter.c_str(), group.formula.c_str(),
                group.prototype, group.model, group.mismatch_percent, group.affects.c_str());
  }
  std::printf("  %s\n", report.gravity_changes.front().c_str());
  return report.mismatches().size() == 3 ? 0 : 1;
}
