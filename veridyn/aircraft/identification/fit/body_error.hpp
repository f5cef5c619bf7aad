#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>

#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::aircraft {

/// Standard deviation of each constant, in the order of `kBodyConstantNames`; inertia counts where the subject has it.
[[nodiscard]] EnumArray<BodyConstant, double, kBodyConstants> body_sigma(const Subject& subject);

/// The subject with one constant changed; nothing is checked, since the change is for differences.
[[nodiscard]] Subject with_changed(const Subject& subject, BodyConstant constant, double change);

/// Change of the parameters per standard deviation of each of the aircraft's constants [n_p x kBodyConstants].
///
/// Errors of mass, geometry and inertia are the same in every row of a regression: they are no noise, do not average
/// out and show in no residual. A moment coefficient is nearly proportional to its moment of inertia, so that an error
/// of scale e of Jy changes all Cm derivatives by e; the coupling terms, and the constants that the normalised rates
/// hold, change them otherwise. Both follow from estimating again at J +- sigma: column k is half the difference. A
/// constant on which nothing depends costs nothing.
/// @param estimate parameters of the regression as the given subject would have it; empty where that fails
[[nodiscard]] Eigen::MatrixXd body_sensitivity(const Subject& subject, Eigen::Index parameters,
                                               const std::function<Eigen::VectorXd(const Subject&)>& estimate);

/// Adds G G' to the covariance of an estimate, its standard deviations, intervals and t-tests; a parameter that is then
/// no longer distinguishable from zero becomes insignificant. `covariance_white` stays that of the noise alone.
void widen(estimation::RegressionEstimate& estimate, const Eigen::MatrixXd& sensitivity, double significance);

/// "Jy (14 %)" when that constant makes up more than half of the variance of some parameter that was identified, else
/// empty.
[[nodiscard]] std::string dominant_constant(const estimation::RegressionEstimate& widened,
                                            const Eigen::MatrixXd& sensitivity, const Subject& subject);

}  // namespace veridyn::aircraft
