#include "veridyn/aircraft/identification/fit/body_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {

using estimation::ParameterStatus;

EnumArray<BodyConstant, double, kBodyConstants> body_sigma(const Subject& subject) {
  const BodySigma& s = subject.sigma;
  const bool J = subject.inertia.has_value();
  return {{s.mass, s.wing_area, s.span, s.chord, J ? s.Jx : 0.0, J ? s.Jy : 0.0, J ? s.Jz : 0.0, J ? s.Jxz : 0.0}};
}

Subject with_changed(const Subject& subject, BodyConstant constant, double change) {
  Subject changed = subject;
  Inertia none;
  Inertia& J = changed.inertia ? *changed.inertia : none;
  switch (constant) {
    case BodyConstant::kMass:
      changed.mass += change;
      break;
    case BodyConstant::kWingArea:
      changed.wing_area += change;
      break;
    case BodyConstant::kSpan:
      changed.span += change;
      break;
    case BodyConstant::kChord:
      changed.chord += change;
      break;
    case BodyConstant::kJx:
      J.Jx += change;
      break;
    case BodyConstant::kJy:
      J.Jy += change;
      break;
    case BodyConstant::kJz:
      J.Jz += change;
      break;
    case BodyConstant::kJxz:
      J.Jxz += change;
      break;
  }
  return changed;
}

Eigen::MatrixXd body_sensitivity(const Subject& subject, Eigen::Index parameters,
                                 const std::function<Eigen::VectorXd(const Subject&)>& estimate) {
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(parameters, kBodyConstants);
  const EnumArray<BodyConstant, double, kBodyConstants> sigma = body_sigma(subject);
  for (std::size_t k = 0; k < kBodyConstants; ++k) {
    if (!(sigma[k] > 0.0)) continue;
    // A tenth of sigma: the tangent, also where sigma is as large as the constant itself.
    constexpr double kStep = 0.1;
    const auto constant = static_cast<BodyConstant>(k);
    const Eigen::VectorXd high = estimate(with_changed(subject, constant, kStep * sigma[k]));
    const Eigen::VectorXd low = estimate(with_changed(subject, constant, -kStep * sigma[k]));
    if (high.size() != parameters || low.size() != parameters) continue;
    G.col(k) = (high - low) / (2.0 * kStep);
  }
  return G;
}

void widen(estimation::RegressionEstimate& estimate, const Eigen::MatrixXd& sensitivity, double significance) {
  if (sensitivity.isZero(0.0)) return;
  estimate.covariance += sensitivity * sensitivity.transpose();
  for (std::size_t i = 0; i < estimate.parameters.size(); ++i) {
    auto& p = estimate.parameters[i];
    const double shared = sensitivity.row(i).squaredNorm();
    if (!(shared > 0.0) || !(p.sigma > 0.0)) continue;
    // The noise part has its degrees of freedom, the shared part is taken as known: the interval's factor stays the
    // noise's, which is the larger of the two.
    const double factor = 0.5 * (p.high95 - p.low95) / p.sigma;
    p.sigma = std::hypot(p.sigma, std::sqrt(shared));
    p.low95 = p.value - factor * p.sigma;
    p.high95 = p.value + factor * p.sigma;
    p.t = p.value / p.sigma;
    p.p_value = numerics::student_t_two_sided_p(p.t, estimate.degrees_of_freedom);
    if (p.status == ParameterStatus::kIdentified && !(p.p_value < significance))
      p.status = ParameterStatus::kInsignificant;
  }
}

std::string dominant_constant(const estimation::RegressionEstimate& widened, const Eigen::MatrixXd& sensitivity,
                              const Subject& subject) {
  const EnumArray<BodyConstant, double, kBodyConstants> sigma = body_sigma(subject);
  const BodyConstants<double> body = body_constants<double>(subject);
  for (std::size_t k = 0; k < kBodyConstants; ++k) {
    for (std::size_t i = 0; i < widened.parameters.size(); ++i) {
      const auto& p = widened.parameters[i];
      const bool counts = p.status == ParameterStatus::kIdentified || p.status == ParameterStatus::kInsignificant;
      const double part = sensitivity(i, k);
      if (counts && part * part > 0.5 * p.sigma * p.sigma)
        return fmt::format("{} ({:.2g} %)", kBodyConstantNames[k], 100.0 * sigma[k] / std::abs(body.value[k]));
    }
  }
  return {};
}

}  // namespace veridyn::aircraft
