#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "veridyn/muscle/model/muscle_parameters.hpp"

namespace veridyn::muscle {

// Muscles of arm26 (Holzbaur et al. 2005, simplified by OpenSim), as its file gives them.
inline std::vector<MuscleParameters> arm26_muscles(const MuscleCurves& curves) {
  struct Row {
    const char* name;
    double F0, L0, LS, phi0;
  };
  std::vector<MuscleParameters> muscles;
  for (const Row& row :
       {Row{"TRIlong", 798.52, 0.1340, 0.1430, 0.20943951}, Row{"TRIlat", 624.30, 0.1138, 0.0980, 0.15707963},
        Row{"TRImed", 624.30, 0.1138, 0.0908, 0.15707963}, Row{"BIClong", 624.30, 0.1157, 0.2723, 0.0},
        Row{"BICshort", 435.56, 0.1321, 0.1923, 0.0}, Row{"BRA", 987.26, 0.0858, 0.0535, 0.0}}) {
    MuscleParameters p;
    p.name = row.name;
    p.musculotendon = {row.F0, row.L0, row.LS, row.phi0, 10.0, 0.010, 0.040};
    p.curves = curves;
    p.minimum_activation = 0.01;
    if (std::holds_alternative<MillardCurves>(curves)) p.fiber_damping = 0.1;
    muscles.push_back(p);
  }
  return muscles;
}

inline ThelenCurves arm26_thelen() {
  return {.tendon_strain = 0.033,
          .passive_strain = 0.6,
          .active_width = 0.5,
          .passive_exponent = 4.0,
          .Af = 0.3,
          .Flen = 1.8,
          .extrapolation_threshold = 0.95};
}

inline MuscleParameters arm26_muscle(const std::string& name, const MuscleCurves& curves) {
  const std::vector<MuscleParameters> all = arm26_muscles(curves);
  return *std::find_if(all.begin(), all.end(), [&](const MuscleParameters& p) { return p.name == name; });
}

}  // namespace veridyn::muscle
