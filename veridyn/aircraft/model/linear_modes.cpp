#include "veridyn/aircraft/model/linear_modes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/numerics/linear_algebra/general_eigen.hpp"

namespace veridyn::aircraft {
namespace {

using Block = std::array<Eigen::Index, 4>;
constexpr Block kLongitudinal = {0, 2, 4, 7};  // u w q theta
constexpr Block kLateral = {1, 3, 5, 6};       // v p r phi

/// Eigenvalues of a block that are not the second of a pair, the furthest from zero first, with their left
/// eigenvectors in all eight states.
std::vector<LinearMode> modes_of(const LinearModel& model, const Block& block) {
  Eigen::MatrixXd transposed(4, 4);
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index j = 0; j < 4; ++j) transposed(j, i) = model.A(block[i], block[j]);
  const numerics::GeneralEigen eigen = numerics::general_eigen(transposed);
  std::vector<LinearMode> modes;
  for (Eigen::Index k = 0; k < 4; ++k) {
    if (eigen.values(k).imag() < 0.0) continue;
    LinearMode mode{.mode = {}, .s = eigen.values(k), .left = Eigen::VectorXcd::Zero(8)};
    for (Eigen::Index i = 0; i < 4; ++i) mode.left(block[i]) = eigen.vectors(i, k);
    modes.push_back(std::move(mode));
  }
  std::ranges::sort(modes, [](const LinearMode& a, const LinearMode& b) { return std::abs(a.s) > std::abs(b.s); });
  return modes;
}

}  // namespace

std::string_view words_of(Mode mode) {
  constexpr EnumArray<Mode, std::string_view, kModes> kWords{
      {"short period", "phugoid", "Dutch roll", "roll", "spiral"}};
  return kWords[mode];
}

std::vector<LinearMode> linear_modes(const LinearModel& model) {
  std::vector<LinearMode> modes;
  const auto named = [&](LinearMode mode, Mode name) {
    mode.mode = name;
    modes.push_back(std::move(mode));
  };
  // Eigenvalues in order of speed: the first two of four are the short period.
  std::vector<LinearMode> longitudinal = modes_of(model, kLongitudinal);
  int counted = 0;
  for (LinearMode& mode : longitudinal) {
    const bool fast = counted < 2;
    counted += mode.s.imag() > 0.0 ? 2 : 1;
    named(std::move(mode), fast ? Mode::kShortPeriod : Mode::kPhugoid);
  }
  std::vector<LinearMode> lateral = modes_of(model, kLateral);
  const auto pairs = std::ranges::count_if(lateral, [](const LinearMode& m) { return m.s.imag() > 0.0; });
  const std::array<Mode, 4> without_pair = {Mode::kRoll, Mode::kDutchRoll, Mode::kDutchRoll, Mode::kSpiral};
  bool oscillated = false, rolled = false;
  for (std::size_t k = 0; k < lateral.size(); ++k) {
    const bool pair = lateral[k].s.imag() > 0.0;
    Mode name = pairs == 0            ? without_pair[k]
                : pair && !oscillated ? Mode::kDutchRoll
                : !pair && !rolled    ? Mode::kRoll
                                      : Mode::kSpiral;
    oscillated = oscillated || pair;
    rolled = rolled || !pair;
    named(std::move(lateral[k]), name);
  }
  return modes;
}

}  // namespace veridyn::aircraft
