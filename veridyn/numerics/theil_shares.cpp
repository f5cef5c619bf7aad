#include "veridyn/numerics/theil_shares.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::numerics {

TheilShares theil_shares(std::span<const double> measured, std::span<const double> model) {
  if (measured.size() != model.size())
    throw InputError("theil_shares", fmt::format("measured has {} samples, model {}; they must have the same number",
                                                 measured.size(), model.size()));
  const auto both = [&](std::size_t k) { return std::isfinite(measured[k]) && std::isfinite(model[k]); };
  double count = 0.0, mean_z = 0.0, mean_y = 0.0;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (!both(k)) continue;
    count += 1.0;
    mean_z += measured[k];
    mean_y += model[k];
  }
  mean_z /= count;
  mean_y /= count;
  double zz = 0.0, yy = 0.0, of_difference = 0.0;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (!both(k)) continue;
    const double z = measured[k] - mean_z, y = model[k] - mean_y;
    zz += z * z;
    yy += y * y;
    of_difference += (y - z) * (y - z);
  }
  const double bias = std::pow(mean_y - mean_z, 2.0);
  const double variance = std::pow(std::sqrt(yy / count) - std::sqrt(zz / count), 2.0);
  const double error = bias + of_difference / count;
  if (!(error > 0.0)) return {kNaN, kNaN, kNaN};
  // 2 (1 - r) s_y s_z without the difference of large products.
  return {bias / error, variance / error, (of_difference / count - variance) / error};
}

}  // namespace veridyn::numerics
