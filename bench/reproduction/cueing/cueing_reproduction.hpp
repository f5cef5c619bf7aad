#pragma once

#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::cueing {

/// A figure of the literature and ours.
struct ReproducedFigure {
  std::string quantity;    ///< "pitch reached at 20 deg"
  std::string origin;      ///< "printed" in the source, "derived" from what is printed there, or "computed" here
  double published = 0.0;  ///< in `unit`
  double ours = 0.0;
  double within = 0.0;
  std::string unit;  ///< as the study writes it
  [[nodiscard]] bool passed() const;
};

/// A curve that shows where figures come from.
struct ReproducedCurve {
  std::string name, unit;
  std::vector<double> values;
};

/// A row of `veridyn reproduce cueing`, described by one study (examples/reproduce/cueing):
///
///     title = "...", finding = "what was published, in words", how = "how it was done here"
///     curves = "ramp_pitch"                # which experiment is drawn; may be left out
///     [[figure]]
///     quantity = "pitch_reached"           # see reproducible_quantities
///     at = "20 deg"                        # what it depends on, where it does
///     value = "18.5 deg"
///     within = "0.5 deg"
///     origin = "printed"                   # "printed", "derived", "computed"
struct CueingReproduction {
  std::string title, finding, how;
  std::vector<ReproducedFigure> figures;
  std::vector<double> time;  ///< of the curves [s]
  std::vector<ReproducedCurve> curves;
  bool interrupted = false;
  [[nodiscard]] bool passed() const;
};

/// Reads the study and computes what it compares. @throws InputError naming file, line and key.
[[nodiscard]] CueingReproduction reproduce_cueing(const StudyTable& root, Progress& progress);

}  // namespace veridyn::cueing
