#include "veridyn/numerics/multivariate_polynomial.hpp"

#include <utility>

#include "veridyn/core/assert.hpp"

namespace veridyn::numerics {

MultivariatePolynomial::MultivariatePolynomial(int arguments, int order, std::vector<double> coefficients)
    : arguments_(arguments), order_(order), coefficients_(std::move(coefficients)) {
  VERIDYN_ASSERT(arguments >= 0 && arguments <= kMostArguments && order >= 0 && order <= kMostOrder);
  VERIDYN_ASSERT(coefficients_.size() == terms(arguments, order));
}

std::size_t MultivariatePolynomial::terms(int arguments, int order) {
  std::size_t count = 1;
  for (int i = 1; i <= arguments; ++i)
    count = count * static_cast<std::size_t>(order + i) / static_cast<std::size_t>(i);
  return count;
}

std::vector<MultivariatePolynomial::Powers> MultivariatePolynomial::powers(int arguments, int order) {
  std::vector<Powers> found;
  Powers power{};
  const auto fill = [&](const auto& self, int argument, int left) -> void {
    if (argument == arguments) {
      found.push_back(power);
      return;
    }
    for (int i = 0; i <= left; ++i) {
      power[argument] = static_cast<unsigned char>(i);
      self(self, argument + 1, left - i);
    }
    power[argument] = 0;
  };
  fill(fill, 0, order);
  return found;
}

MultivariatePolynomial MultivariatePolynomial::scaled(double factor) const {
  MultivariatePolynomial product = *this;
  for (double& c : product.coefficients_) c *= factor;
  return product;
}

}  // namespace veridyn::numerics
