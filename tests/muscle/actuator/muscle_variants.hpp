#pragma once

#include <string>
#include <vector>

#include "tests/muscle/arm26_muscles.hpp"

namespace veridyn::muscle::test {

/// A muscle of arm26 with other curves or settings.
struct Variant {
  std::string name;
  MuscleCurves curves;
  double damping = 0.0;
  bool rigid = false;
  bool no_activation_dynamics = false;
};

/// Every kind of curve, with and without damping, tendon and activation dynamics.
inline std::vector<Variant> variants() {
  std::vector<Variant> all;
  for (const bool rigid : {false, true}) {
    const std::string r = rigid ? ", rigid tendon" : "";
    all.push_back({"Thelen" + r, arm26_thelen(), 0.0, rigid});
    all.push_back({"Thelen before 2012" + r, DeprecatedThelenCurves{}, 0.0, rigid});
    all.push_back({"Millard, damped" + r, MillardCurves{}, 0.1, rigid});
    all.push_back({"Millard, undamped" + r, MillardCurves{}, 0.0, rigid});
    all.push_back({"De Groote" + r, DeGrooteFregly2016Curves{.activation_smoothing = 10.0}, 0.0, rigid});
    all.push_back({"De Groote, damped" + r, DeGrooteFregly2016Curves{}, 0.05, rigid});
    all.push_back({"Schutte" + r, SchutteCurves{}, 0.0, rigid});
  }
  all.push_back({"Thelen, activation is excitation", arm26_thelen(), 0.0, false, true});
  return all;
}

inline MuscleParameters parameters_of(const Variant& v, const std::string& name = "TRIlong") {
  MuscleParameters p = arm26_muscle(name, v.curves);
  p.fiber_damping = v.damping;
  p.rigid_tendon = v.rigid;
  p.ignore_activation_dynamics = v.no_activation_dynamics;
  return p;
}

}  // namespace veridyn::muscle::test
