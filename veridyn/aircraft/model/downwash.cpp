#include "veridyn/aircraft/model/downwash.hpp"

#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

const KeyTable<Downwash>& Downwash::keys() {
  using D = Downwash;
  static const auto table =
      KeyTable<D>("downwash",
                  "The wing's downwash reaches the tail late: terms of the rate of alpha, of simulations. "
                  "Identification has no such term and finds what it makes of the others, which is what it is "
                  "compared with.")
          .number("tail_arm", &D::tail_arm, "m", kPositive,
                  "from wing to tail; downwash lags by this over the airspeed")
          .required()
          .number("CL_alphadot", &D::CL_alphadot, "1", kAnyNumber, "lift per c/(2 Va) times the rate of alpha")
          .number("Cm_alphadot", &D::Cm_alphadot, "1", kAnyNumber, "pitching moment likewise");
  return table;
}

AeroModel quasi_steady_model(const Subject& s, double density, double airspeed) {
  AeroModel model = s.model;
  const CoefficientModel* lift = s.model.find(Coefficient::kCL);
  if (!s.downwash.any() || lift == nullptr) return model;
  const double mu = density * s.wing_area * s.pitch_length() / (4.0 * s.mass);
  const double f = 1.0 / (1.0 + mu * s.downwash.CL_alphadot);
  // Of c alpha'/(2 Va) = sum of `shares` times terms.
  const auto share = [&](const Term& term) {
    double sum = -mu * lift->value_of(term.expression).value_or(0.0);
    if (term.constant()) sum += kGravity * s.pitch_length() / (2.0 * airspeed * airspeed);
    if (term.expression == kAeroVariableNames[AeroVariable::kQn]) sum += 1.0;
    return f * sum;
  };
  for (const auto& [coefficient, derivative] :
       {std::pair{Coefficient::kCL, s.downwash.CL_alphadot}, std::pair{Coefficient::kCm, s.downwash.Cm_alphadot}}) {
    CoefficientModel* of = model.find(coefficient);
    if (of == nullptr) continue;
    for (std::size_t i = 0; i < of->size(); ++i) of->values[i] += derivative * share(of->terms[i]);
  }
  return model;
}

}  // namespace veridyn::aircraft
