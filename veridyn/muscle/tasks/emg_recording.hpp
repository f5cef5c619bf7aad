#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/model/signals.hpp"

namespace veridyn::muscle {

/// A motion recorded with EMG: angles, envelopes and what inverse dynamics found, each with its own times on one clock.
struct EmgRecording {
  Motion angles;
  Eigen::VectorXd rest;             ///< values of the coordinates that `angles` does not have [rad or m]
  std::vector<ControlSignals> emg;  ///< by signal: one envelope each, 0 to 1
  double begin = 0.0;               ///< angles and EMG begin [s]
  std::vector<double> time;         ///< of the values that are compared [s]
  estimation::RowMatrix measured;   ///< samples x outputs of the study; NaN: not measured [SI]
};

}  // namespace veridyn::muscle
