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
    if (part.degree < 0) {
      add_pieces(part, q, total, gradient);
    } else if (part.coordinates <= 2) {
      add_rows(part, q, total, gradient);
    } else {
      add_terms(part, q, total, gradient);
    }
  }
  return inside;
}

/// Pieces of one coordinate.
template <typename Scalar>
inline void FittedPaths::add_pieces(const Part& part, const Scalar* q, Scalar& length, Scalar* gradient) const {
  const numerics::FunctionValue<Scalar> f = pieces_[part.first].evaluate(q[axes_[part.axes[0]].coordinate]);
  length += f.value;
  gradient[part.pair[0]] += f.slope;
}

/// A polynomial of one or two coordinates: Horner's rule in x for each row, in y over the rows.
template <typename Scalar>
inline void FittedPaths::add_rows(const Part& part, const Scalar* q, Scalar& length, Scalar* gradient) const {
  const bool two = part.coordinates == 2;
  const int degree = part.degree;
  const Axis& first_axis = axes_[part.axes[0]];
  const Axis& second_axis = axes_[part.axes[two ? 1 : 0]];
  const Scalar x = along(first_axis, q);
  const Scalar y = two ? along(second_axis, q) : Scalar(0.0);
  Scalar value(0.0), by_x(0.0), by_y(0.0);
  const double* row = rows_.data() + part.end;
  for (int j = two ? degree : 0; j >= 0; --j) {
    const int most = degree - j;
    row -= most + 1;
    Scalar v(row[most]), d(0.0);
    for (int i = most - 1; i >= 0; --i) {
      d = d * x + v;
      v = v * x + Scalar(row[i]);
    }
    by_y = by_y * y + value;
    value = value * y + v;
    by_x = by_x * y + d;
  }
  length += value;
  gradient[part.pair[0]] += by_x * Scalar(first_axis.scale);
  if (two) gradient[part.pair[1]] += by_y * Scalar(second_axis.scale);
}

/// A polynomial of three coordinates and more, term after term.
template <typename Scalar>
inline void FittedPaths::add_terms(const Part& part, const Scalar* q, Scalar& length, Scalar* gradient) const {
  Scalar power[kMostCoordinates][kMostDegree + 1];
  for (int a = 0; a < part.coordinates; ++a) {
    const Scalar u = along(axes_[part.axes[a]], q);
    power[a][0] = Scalar(1.0);
    for (int i = 1; i <= part.degree; ++i) power[a][i] = power[a][i - 1] * u;
  }
  Scalar value(0.0);
  Scalar slope[kMostCoordinates];
  for (int a = 0; a < part.coordinates; ++a) slope[a] = Scalar(0.0);
  for (std::size_t t = part.first; t < part.end; ++t) {
    const Term& term = terms_[t];
    // Products of all powers before and after each coordinate.
    Scalar before[kMostCoordinates + 1];
    before[0] = Scalar(term.factor);
    for (int a = 0; a < part.coordinates; ++a) before[a + 1] = before[a] * power[a][term.power[a]];
    value += before[part.coordinates];
    Scalar after(1.0);
    for (int a = part.coordinates - 1; a >= 0; --a) {
      if (term.power[a] > 0)
        slope[a] += before[a] * after * power[a][term.power[a] - 1] * Scalar(static_cast<double>(term.power[a]));
      after = after * power[a][term.power[a]];
    }
  }
  length += value;
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
