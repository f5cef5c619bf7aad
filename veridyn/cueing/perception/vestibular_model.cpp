#include "veridyn/cueing/perception/vestibular_model.hpp"

#include <fmt/format.h>

#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::cueing {
namespace {

using numerics::TransferFunction;

/// gain (T s + 1) for a numerator or denominator in s.
TransferFunction lead(double gain, double time_constant) { return {{gain * time_constant, gain}, {1.0}}; }
TransferFunction lag(double time_constant) { return {{1.0}, {time_constant, 1.0}}; }
/// T s / (T s + 1)
TransferFunction washed_out(double time_constant) { return {{time_constant, 0.0}, {time_constant, 1.0}}; }

std::array<TransferFunction, 3> on_all_axes(const TransferFunction& canal) { return {canal, canal, canal}; }

std::vector<VestibularModel> all_models() {
  const std::array<TransferFunction, 3> pendulums = {torsion_pendulum(6.1), torsion_pendulum(5.3),
                                                     torsion_pendulum(10.2)};
  const TransferFunction telban = washed_out(5.73) * washed_out(80.0);
  const TransferFunction telban_otoliths = lead(0.4, 10.0) * lag(5.0) * lag(0.016);
  const char* telban_source = "Telban & Cardullo 2005, NASA CR-2005-213747";
  // Firing rate of a nerve over rad/s: afferent dynamics of the cupula (18 s, 0.005 s), adaptation (30 s) and lead.
  const TransferFunction ormsby_canals =
      6300.0 * 0.005 * washed_out(18.0) * lag(0.005) * washed_out(30.0) * lead(1.0, 0.01);
  const TransferFunction ormsby_otoliths = {{90.0 / 9.81, 9.0 / 9.81}, {1.0, 0.2}};
  return {
      {"young_meiry", pendulums, lead(0.4, 13.2) * lag(5.33) * lag(0.66), "1", "1",
       "Young & Meiry 1968, Aerospace Med 39:606 (otoliths); Reid & Nahon 1985, UTIAS 296 (canals)"},
      {"telban_cardullo", on_all_axes(telban), telban_otoliths, "1", "1", telban_source},
      {"telban_cardullo_lead", on_all_axes(telban * lead(1.0, 0.06) * lag(0.005)), telban_otoliths, "1", "1",
       telban_source},
      {"hosman", pendulums, lead(1.0, 1.0) * lag(0.5) * lag(0.016), "1", "1",
       "Hosman 1996, thesis, Delft (otoliths); Reid & Nahon 1985 (canals)"},
      {"ormsby", on_all_axes(ormsby_canals), ormsby_otoliths, "1/s per rad/s", "1/s per m/s^2",
       "Ormsby 1974, thesis, MIT"},
  };
}

const std::vector<VestibularModel>& models() {
  static const std::vector<VestibularModel> all = all_models();
  return all;
}

}  // namespace

MotionThresholds usual_thresholds() {
  return {.rate = {2.0 * kDegree, 2.0 * kDegree, 1.6 * kDegree}, .force = {0.17, 0.17, 0.28}};
}

MotionThresholds reid_nahon_thresholds() {
  return {.rate = {3.0 * kDegree, 3.6 * kDegree, 2.6 * kDegree}, .force = usual_thresholds().force};
}

TransferFunction torsion_pendulum(double long_time_constant) {
  if (!(long_time_constant > 0.0))
    throw InputError("long_time_constant", fmt::format("is {} s; must be > 0", long_time_constant));
  constexpr double kEndolymph = 0.1, kAdaptation = 30.0;  // [s]
  return washed_out(long_time_constant) * lag(kEndolymph) * washed_out(kAdaptation);
}

const VestibularModel& vestibular_model(std::string_view name) {
  std::vector<std::string> names;
  for (const VestibularModel& m : models()) {
    if (m.name == name) return m;
    names.push_back(m.name);
  }
  throw InputError("perception", fmt::format("there is no model '{}'{}", name, suggestion(std::string(name), names)));
}

std::span<const VestibularModel> vestibular_models() { return models(); }

}  // namespace veridyn::cueing
