#include "tests/support/integrate_adaptive.hpp"

#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <vector>

#include "veridyn/core/index.hpp"

namespace veridyn::numerics {

namespace odeint = boost::numeric::odeint;

IntegrationResult integrate_adaptive(const OdeFunction& function, const Eigen::VectorXd& start, double begin,
                                     double end, const IntegrationOptions& options,
                                     const std::function<void(double, const Eigen::VectorXd&)>& observe) {
  using State = std::vector<double>;
  IntegrationResult result;
  result.state = start;
  result.time = begin;
  if (observe) observe(begin, start);
  if (begin == end) return result;

  Eigen::VectorXd x_eigen(start.size());
  Eigen::VectorXd rate_eigen(start.size());
  const auto system = [&](const State& x, State& rate, double t) {
    x_eigen = Eigen::Map<const Eigen::VectorXd>(x.data(), signed_index(x.size()));
    function(t, x_eigen, rate_eigen);
    Eigen::Map<Eigen::VectorXd>(rate.data(), signed_index(rate.size())) = rate_eigen;
  };
  auto stepper = odeint::make_controlled(options.absolute_tolerance, options.relative_tolerance,
                                         odeint::runge_kutta_dopri5<State>());
  State x(start.data(), start.data() + start.size());
  const double length = end - begin;
  double t = begin;
  double h = options.first_step > 0.0 ? std::copysign(options.first_step, length) : 1e-3 * length;
  const auto finite = [](const State& s) {
    for (const double v : s)
      if (!std::isfinite(v)) return false;
    return true;
  };
  while ((end - t) * length > 0.0) {
    if (result.steps >= options.max_steps) {
      result.end = IntegrationEnd::kStepLimit;
      break;
    }
    bool last = false;
    if ((t + h - end) * length >= 0.0) {
      h = end - t;
      last = true;
    }
    const State before = x;
    const double t_before = t;
    const double h_tried = h;
    const auto outcome = stepper.try_step(system, x, t, h);
    ++result.steps;
    if (!finite(x) || !std::isfinite(h)) {
      // A step that leaves the domain is tried shorter before giving up.
      x = before;
      t = t_before;
      h = 0.1 * h_tried;
      stepper.reset();
      if (std::abs(h) < 1e-14 * std::abs(length)) {
        result.end = IntegrationEnd::kNotFinite;
        break;
      }
      continue;
    }
    if (outcome == odeint::success) {
      if (last) t = end;
      if (observe) observe(t, Eigen::Map<const Eigen::VectorXd>(x.data(), start.size()));
    } else if (std::abs(h) < 1e-14 * std::abs(length)) {
      result.end = IntegrationEnd::kStepSize;
      break;
    }
  }
  result.state = Eigen::Map<const Eigen::VectorXd>(x.data(), start.size());
  result.time = t;
  return result;
}

}  // namespace veridyn::numerics
