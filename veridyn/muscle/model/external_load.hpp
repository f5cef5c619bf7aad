#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/model/signals.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

/// Forces of the surroundings on bodies that were measured with a motion, such as those of force plates:
/// `dynamics/external_forces.hpp` computes with them.
namespace veridyn::muscle {

/// A force and a moment on a body, as functions of time [s].
///
/// Force and moment are in the axes of `force_frame`; the force acts at `point` of `point_frame`. Where both frames are
/// one, the functions are those of the force and of the whole moment about the frame's origin, and the point is zero:
/// unlike a point of application, which is nowhere while nothing touches, they can be interpolated and filtered.
struct ExternalLoad {
  std::string name;
  int body = 0;  ///< on which it acts
  int force_frame = 0, point_frame = 0;
  std::array<numerics::PiecewisePolynomial, 3> force, moment, point;  ///< [N], [N m], [m]
};

/// Where a load comes from, by the names of bodies and columns: what a study or OpenSim's ExternalForce says.
struct ExternalLoadSource {
  std::string name = {};
  std::string place = {};  ///< file and line, for messages
  std::string body = {};   ///< on which it acts
  std::string force_frame = "ground";
  std::string point_frame = "ground";
  /// What the names of three columns begin with; empty: none. A force without a point acts at the body's origin.
  std::string force = {}, point = {}, moment = {};
  /// In place of columns.
  Eigen::Vector3d constant_force = Eigen::Vector3d::Zero(), constant_moment = Eigen::Vector3d::Zero();
  Eigen::Vector3d constant_point = Eigen::Vector3d::Zero();
  bool has_constant_point = false;
};

/// All loads of a motion, and the time that their data cover.
struct ExternalLoads {
  std::vector<ExternalLoad> loads;
  double begin = -std::numeric_limits<double>::infinity();  ///< [s]
  double end = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool empty() const { return loads.empty(); }
};

/// Adds the loads of `sources`, whose columns are in `table` (null where all are constant), joined by natural cubic
/// splines as in OpenSim; with `low_pass_Hz` above 0 filtered before as `make_motion` filters.
/// @throws InputError naming the source's place: unknown bodies (with the nearest one), the ground as the body, columns
/// that are not there or not three, cells without a value, samples too few or too uneven for the low-pass.
void add_external_loads(std::span<const ExternalLoadSource> sources, const SignalTable* table, const Model& model,
                        double low_pass_Hz, ExternalLoads& loads);

}  // namespace veridyn::muscle
