#pragma once

#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

struct Subject;

/// The downwash of the wing, which reaches the tail late: where the wing has the angle of attack alpha, the tail has
/// the downwash of alpha_w, which follows by alpha_w' = (alpha - alpha_w) Va/l. What that changes of lift and pitching
/// moment is in proportion to the lag,
///
///     CL += CL_alphadot (c/2l) (alpha - alpha_w),   Cm += Cm_alphadot (c/2l) (alpha - alpha_w)
///
/// which for slow changes are the terms CL_alphadot alpha' c/(2 Va) and Cm_alphadot alpha' c/(2 Va) of the literature
/// (Etkin & Reid 1996, 5.5); c is the length of q_n. Study table `[subject.downwash]`, of simulations.
struct Downwash {
  double CL_alphadot = 0.0, Cm_alphadot = 0.0;
  double tail_arm = 0.0;  ///< l, from wing to tail [m]; 0: no downwash

  [[nodiscard]] bool any() const { return tail_arm > 0.0; }
  [[nodiscard]] static const KeyTable<Downwash>& keys();
  friend bool operator==(const Downwash&, const Downwash&) = default;
};

/// The model without alpha-dot that moves like the subject in calm air as far as motions are slow against l/Va: what
/// an identification without that term finds. With alpha' c/(2 Va) = q_n - mu CL + const., mu = rho S c/(4 m) and
/// f = 1/(1 + mu CL_alphadot):
///
///     CL_q -> f (CL_q + CL_alphadot),   Cm_q -> Cm_q + Cm_alphadot f (1 - mu CL_q)
///     CL_x -> f CL_x,                   Cm_x -> Cm_x - Cm_alphadot f mu CL_x     for other terms x, as alpha and de
///
/// The constants are those of level flight at `airspeed` [m/s] but for the lift of thrust. Terms that only CL has are
/// not given to Cm.
/// @param density [kg/m^3]
[[nodiscard]] AeroModel quasi_steady_model(const Subject& subject, double density, double airspeed);

}  // namespace veridyn::aircraft
