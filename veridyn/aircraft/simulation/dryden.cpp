#include "veridyn/aircraft/simulation/dryden.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

namespace {

/// Integral from 0 to theta of s^n e^(-2s) ds.
double decaying_moment(int n, double theta) {
  if (theta < 0.5) {
    // The closed form cancels; the series converges to double precision within 20 terms.
    double sum = 0.0;
    double term = std::pow(theta, n + 1);
    for (int k = 0; k < 24; ++k) {
      sum += term / (n + 1 + k);
      term *= -2.0 * theta / (k + 1);
    }
    return sum;
  }
  const double e = std::exp(-2.0 * theta);
  if (n == 0) return 0.5 * (1.0 - e);
  if (n == 1) return 0.25 * (1.0 - e * (1.0 + 2.0 * theta));
  return 0.25 * (1.0 - e * (1.0 + 2.0 * theta * (1.0 + theta)));
}

}  // namespace

namespace {

const std::vector<std::pair<std::string, DrydenSettings>> kSettings = {
    {"none", {}},
    {"low_light", {200, 200, 50, 1.06, 1.06, 0.7}},
    {"low_moderate", {200, 200, 50, 2.12, 2.12, 1.4}},
    {"medium_light", {533, 533, 533, 1.5, 1.5, 1.5}},
    {"medium_moderate", {533, 533, 533, 3.0, 3.0, 3.0}}};

const KeyTable<DrydenSettings>& dryden_keys() {
  using S = DrydenSettings;
  static const auto table = KeyTable<S>("turbulence")
                                .number("Lu", &S::Lu, "m", kPositive, "scale length along x")
                                .required()
                                .number("Lv", &S::Lv, "m", kPositive, "along y")
                                .otherwise("`Lu`")
                                .number("Lw", &S::Lw, "m", kPositive, "along z")
                                .required()
                                .number("sigma_u", &S::sigma_u, "m/s", kNotNegative, "standard deviation along x")
                                .required()
                                .number("sigma_v", &S::sigma_v, "m/s", kNotNegative, "along y")
                                .otherwise("`sigma_u`")
                                .number("sigma_w", &S::sigma_w, "m/s", kNotNegative, "along z")
                                .required()
                                .check([](const StudyTable& t, S& s) {
                                  if (!t.has("Lv")) s.Lv = s.Lu;
                                  if (!t.has("sigma_v")) s.sigma_v = s.sigma_u;
                                });
  return table;
}

}  // namespace

StudyKey turbulence_key(std::vector<std::string> others, std::string says) {
  for (const auto& [name, settings] : kSettings) others.push_back(name);
  const std::string first = others.front();
  return {"turbulence", "", quoted_list(others, "`") + ", `{ Lu, Lv, Lw, sigma_u, sigma_v, sigma_w }`",
          quoted_list({first}), std::move(says)};
}

DrydenSettings dryden_settings(std::string_view name, std::string_view place) {
  std::vector<std::string> names;
  for (const auto& [known, settings] : kSettings) {
    if (known == name) return settings;
    names.push_back(known);
  }
  throw InputError(place, fmt::format("unknown turbulence '{}'{}", name, suggestion(name, names)));
}

DrydenSettings read_dryden(const StudyTable& table, std::string_view key) {
  if (!table.has(key)) return {};
  if (!table.is_table(key)) return dryden_settings(table.text(key), table.place(key));
  return dryden_keys().read(table.table(key));
}

DrydenStep::DrydenStep(double theta) : decay(std::exp(-theta)), coupling(theta * decay) {
  const double q11 = decaying_moment(0, theta);
  const double q12 = decaying_moment(1, theta);
  const double q22 = decaying_moment(2, theta);
  noise11 = std::sqrt(q11);
  noise21 = q11 > 0.0 ? q12 / noise11 : 0.0;
  noise22 = std::sqrt(std::max(0.0, q22 - noise21 * noise21));
}

DrydenGusts::DrydenGusts(const DrydenSettings& settings, numerics::RandomStream random)
    : settings_(settings), random_(random) {
  u_ = random_.normal();
  for (Pair* pair : {&v_, &w_}) {
    // Cholesky factor of [1/2 1/4; 1/4 1/4].
    const double a = random_.normal(), b = random_.normal();
    pair->z1 = std::sqrt(0.5) * a;
    pair->z2 = std::sqrt(0.125) * (a + b);
  }
}

void DrydenGusts::advance(Pair& pair, double theta) {
  const DrydenStep step(theta);
  const double a = random_.normal(), b = random_.normal();
  pair.z2 = step.decay * pair.z2 + step.coupling * pair.z1 + step.noise21 * a + step.noise22 * b;
  pair.z1 = step.decay * pair.z1 + step.noise11 * a;
}

void DrydenGusts::advance(double step, double Va) {
  if (settings_.calm()) return;
  const double distance = step * std::max(Va, 0.0);
  const double theta = distance / settings_.Lu;
  u_ = std::exp(-theta) * u_ + std::sqrt(-std::expm1(-2.0 * theta)) * random_.normal();
  advance(v_, distance / settings_.Lv);
  advance(w_, distance / settings_.Lw);
}

std::array<double, 3> DrydenGusts::gust() const {
  const double mix = 1.0 / std::sqrt(3.0) - 1.0;
  const double scale = std::sqrt(3.0);
  return {settings_.sigma_u * u_, settings_.sigma_v * scale * (v_.z1 + mix * v_.z2),
          settings_.sigma_w * scale * (w_.z1 + mix * w_.z2)};
}

}  // namespace veridyn::aircraft
