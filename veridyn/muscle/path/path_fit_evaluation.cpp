// Fitted paths at a pose.
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/path/path_fit.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"

namespace veridyn::muscle {

template <typename Scalar>
bool FittedPaths::evaluate(const MusclePaths& exact, const Kinematics<Scalar>& kinematics, const Scalar* q,
                           PathWorkspace<Scalar>& workspace, Scalar* length, Scalar* gradient) const {
  const bool inside = evaluate(q, length, gradient);
  if (exact_.empty()) return inside;
  exact.evaluate(kinematics, q, workspace, std::span<const std::uint8_t>(fitted_));
  for (const int m : exact_) length[m] = workspace.length[m];
  for (const auto& [from, to] : exact_pairs_) gradient[to] = workspace.gradient[from];
  return inside;
}

template <typename Scalar>
bool FittedPaths::evaluate(const Scalar* q, Scalar* length, Scalar* gradient) const {
  bool inside = true;
  for (std::size_t m = 0; m < constant_.size(); ++m) length[m] = Scalar(constant_[m]);
  for (std::size_t k = 0; k < pairs_.size(); ++k) gradient[k] = Scalar(0.0);
  for (const Axis& axis : axes_) {
    const double x = (value_of(q[axis.coordinate]) - axis.middle) * axis.scale;
    inside = inside && x >= -1.0 - 1e-9 && x <= 1.0 + 1e-9;
  }
  for (const Part& part : parts_) {
    Scalar& total = length[part.muscle];
    if (part.in_pieces()) {
      add_pieces(part, q, total, gradient);
    } else {
      add_polynomial(part, q, total, gradient);
    }
  }
  functions_.evaluate<true>(q, length, gradient);
  return inside && functions_.inside(q);
}

/// Pieces of one coordinate.
template <typename Scalar>
inline void FittedPaths::add_pieces(const Part& part, const Scalar* q, Scalar& length, Scalar* gradient) const {
  const numerics::FunctionValue<Scalar> f = pieces_[part.first].evaluate(q[axes_[part.axes[0]].coordinate]);
  length += f.value;
  gradient[part.pair[0]] += f.slope;
}

template <typename Scalar>
inline void FittedPaths::add_polynomial(const Part& part, const Scalar* q, Scalar& length, Scalar* gradient) const {
  Scalar x[kMostCoordinates], slope[kMostCoordinates];
  for (int a = 0; a < part.coordinates; ++a) x[a] = along(axes_[part.axes[a]], q);
  length += part.polynomial.evaluate(x, slope);
  for (int a = 0; a < part.coordinates; ++a) gradient[part.pair[a]] += slope[a] * Scalar(axes_[part.axes[a]].scale);
}

template bool FittedPaths::evaluate(const double*, double*, double*) const;
template bool FittedPaths::evaluate(const MusclePaths&, const Kinematics<double>&, const double*,
                                    PathWorkspace<double>&, double*, double*) const;
template bool FittedPaths::evaluate(const SimulationJet*, SimulationJet*, SimulationJet*) const;
template bool FittedPaths::evaluate(const MusclePaths&, const Kinematics<SimulationJet>&, const SimulationJet*,
                                    PathWorkspace<SimulationJet>&, SimulationJet*, SimulationJet*) const;
template bool FittedPaths::evaluate(const PathJet*, PathJet*, PathJet*) const;
template bool FittedPaths::evaluate(const MusclePaths&, const Kinematics<PathJet>&, const PathJet*,
                                    PathWorkspace<PathJet>&, PathJet*, PathJet*) const;

}  // namespace veridyn::muscle
