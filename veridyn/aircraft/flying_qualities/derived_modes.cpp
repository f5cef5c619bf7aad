#include "veridyn/aircraft/flying_qualities/derived_modes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "veridyn/aircraft/identification/fit/body_error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::DerivedQuantity;

constexpr std::size_t kDraws = 1000;
// What airspeed does at one alpha; both chosen. By JSBSim's linearisation of six of its aircraft the frequency of the
// phugoid is 0 to 18 % off without (slipstream of the smallest, compressibility of the largest), and the damping of its
// jets less than at constant thrust.
constexpr double kLeastThrustPower = -1.0, kMostThrustPower = 2.0;
constexpr double kLiftSigma = 0.2;

/// A parameter of the model that has a value, where it stands in the estimate and in the model.
struct ModelParameter {
  Coefficient coefficient;
  std::size_t term;
  Eigen::Index row;
};

/// Whether small motions without a deflection depend on a term.
bool moves_modes(const Term& term) {
  return std::ranges::any_of(term.factors, [](const Factor& factor) {
    return factor.variable != AeroVariable::kDe && factor.variable != AeroVariable::kDa &&
           factor.variable != AeroVariable::kDr;
  });
}

/// The identified subject with its parameters' errors, of which draws are taken.
class UncertainSubject {
 public:
  UncertainSubject(const Subject& identified, std::span<const CoefficientResult> results,
                   const estimation::Estimate& estimate)
      : subject_(identified), body_sigma_(body_sigma(identified)) {
    for (const Coefficient c : enumerators<Coefficient, kCoefficients>()) take(c, estimate);
    const Eigen::Index n = signed_index(parameters_.size());
    by_body_ = Eigen::MatrixXd::Zero(n, kBodyConstants);
    Eigen::MatrixXd covariance(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const ModelParameter& p = parameters_[static_cast<std::size_t>(i)];
      for (Eigen::Index j = 0; j < n; ++j)
        covariance(i, j) = estimate.covariance(p.row, parameters_[static_cast<std::size_t>(j)].row);
      const auto result = std::ranges::find(results, p.coefficient, &CoefficientResult::coefficient);
      if (result != results.end() && signed_index(p.term) < result->body_sensitivity.rows())
        by_body_.row(i) = result->body_sensitivity.row(signed_index(p.term));
    }
    // What the constants of the body gave is drawn with them.
    numerics::SymmetricEigen rest = numerics::symmetric_eigen(covariance - by_body_ * by_body_.transpose());
    root_ = rest.vectors * rest.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
  }

  [[nodiscard]] const Subject& subject() const { return subject_; }

  [[nodiscard]] Subject drawn(numerics::RandomStream& random) const {
    const auto normals = [&](Eigen::Index n) {
      return Eigen::VectorXd::NullaryExpr(n, [&] { return random.normal(); }).eval();
    };
    const Eigen::VectorXd body = normals(signed_index(kBodyConstants));
    const Eigen::VectorXd change = root_ * normals(root_.cols()) + by_body_ * body;
    Subject changed = subject_;
    for (std::size_t k = 0; k < kBodyConstants; ++k) {
      if (!(body_sigma_[k] > 0.0)) continue;
      changed = with_changed(changed, static_cast<BodyConstant>(k), body_sigma_[k] * body(signed_index(k)));
    }
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      changed.model.at(parameters_[i].coefficient).values[parameters_[i].term] += change(signed_index(i));
    return changed;
  }

 private:
  /// A coefficient whose values are known, but for one that is not excited and moves a mode.
  void take(Coefficient c, const estimation::Estimate& estimate) {
    CoefficientModel* model = subject_.model.find(c);
    if (model == nullptr || !model->known()) return;
    const std::vector<std::string> names = model->parameter_names();
    std::vector<ModelParameter> taken;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto found = std::ranges::find(estimate.parameters, names[i], &estimation::Parameter::name);
      const Eigen::Index row = found - estimate.parameters.begin();
      if (found != estimate.parameters.end() && std::isfinite(estimate.covariance(row, row))) {
        taken.push_back({c, i, row});
      } else if (moves_modes(model->terms[i])) {
        model->values.assign(model->values.size(), kNaN);
        return;
      }
    }
    parameters_.insert(parameters_.end(), taken.begin(), taken.end());
  }

  Subject subject_;
  EnumArray<BodyConstant, double, kBodyConstants> body_sigma_;
  std::vector<ModelParameter> parameters_;
  Eigen::MatrixXd root_, by_body_;
};

/// Value and interval of a number that some draws may not have.
struct Spread {
  double value = kNaN, low95 = kNaN, high95 = kNaN;
};

class DrawnModes {
 public:
  DrawnModes(const UncertainSubject& subject, const Trim& flown, std::uint64_t seed)
      : best_(flight_modes(subject.subject(), flown)) {
    numerics::RandomStream random(seed, "flying qualities");
    drawn_.reserve(kDraws);
    for (std::size_t i = 0; i < kDraws; ++i) {
      const Subject draw = subject.drawn(random);
      const double thrust = random.uniform(kLeastThrustPower, kMostThrustPower);
      drawn_.push_back(flight_modes(draw, flown, {.thrust = thrust, .lift = kLiftSigma * random.normal()}));
    }
  }

  [[nodiscard]] const FlightModes& best() const { return best_; }

  /// Of what is computed from the modes, each of these.
  [[nodiscard]] std::vector<double> all(const std::function<double(const FlightModes&)>& number) const {
    std::vector<double> values;
    for (const FlightModes& modes : drawn_)
      if (const double value = number(modes); !std::isnan(value)) values.push_back(value);
    std::ranges::sort(values);
    return values;
  }

  [[nodiscard]] Spread spread(const std::function<double(const FlightModes&)>& number) const {
    constexpr double kTail = 0.025;
    Spread out{.value = number(best_)};
    const std::vector<double> values = all(number);
    if (static_cast<double>(values.size()) < (1.0 - kTail) * static_cast<double>(kDraws)) return out;
    out.low95 = numerics::quantile_of_sorted(values, kTail);
    out.high95 = numerics::quantile_of_sorted(values, 1.0 - kTail);
    return out;
  }

 private:
  FlightModes best_;
  std::vector<FlightModes> drawn_;
};

/// A number of a mode, NaN where it does not exist.
auto of_mode(Mode mode, double (NaturalMode::*number)() const) {
  return [mode, number](const FlightModes& all) {
    const auto& found = all.modes[mode];
    return found ? ((*found).*number)() : kNaN;
  };
}

/// The time in which what decays at a rate is half, or what grows twice as much.
DerivedQuantity time_of(Mode mode, const Spread& decay) {
  const double sign = decay.value < 0.0 ? -1.0 : 1.0;
  const auto time = [&](double rate) {
    return std::isnan(rate) ? kNaN : sign * rate > 0.0 ? std::log(2.0) / (sign * rate) : kInfinity;
  };
  const bool grows = sign < 0.0;
  return {.group = {},
          .name = fmt::format("{}.time_to_{}", kModeNames[mode], grows ? "double" : "half"),
          .value = time(decay.value),
          .low95 = time(grows ? decay.low95 : decay.high95),
          .high95 = time(grows ? decay.high95 : decay.low95),
          .unit = "s"};
}

DerivedQuantity level_of_draws(Mode mode, const DrawnModes& drawn, const FlyingQualities& asked) {
  const auto level = [&](const FlightModes& all) {
    const auto& found = all.modes[mode];
    return found ? static_cast<double>(level_of(mode, *found, all.control_anticipation, asked)) : kNaN;
  };
  const Spread spread = drawn.spread(level);
  const std::vector<double> levels = drawn.all(level);
  std::vector<std::string> shares;
  for (int k = 1; k <= kNoLevel; ++k) {
    const double share = static_cast<double>(std::ranges::count(levels, static_cast<double>(k))) /
                         static_cast<double>(std::max<std::size_t>(1, levels.size()));
    if (share >= 0.005)
      shares.push_back(
          fmt::format("{} with probability {:.2f}", k == kNoLevel ? "none" : fmt::format("level {}", k), share));
  }
  return {.group = {},
          .name = fmt::format("{}.level", kModeNames[mode]),
          .value = spread.value,
          .low95 = spread.low95,
          .high95 = spread.high95,
          .note = fmt::format("MIL-F-8785C, class {}, category {}: {}", kAircraftClassNames[asked.aircraft_class],
                              kFlightPhaseNames[asked.phase], fmt::join(shares, ", "))};
}

/// The coefficients that a mode follows from.
std::vector<Coefficient> sources_of(Mode mode, const FlightModes& modes) {
  using enum Coefficient;
  switch (mode) {
    case Mode::kShortPeriod:
      if (!modes.longitudinal_whole) return {kCL, kCm};
      [[fallthrough]];
    case Mode::kPhugoid:
      return {kCL, kCD, kCm};
    case Mode::kDutchRoll:
      return modes.lateral_whole ? std::vector{kCY, kCl, kCn} : std::vector{kCY, kCn};
    case Mode::kRoll:
      return modes.lateral_whole ? std::vector{kCY, kCl, kCn} : std::vector{kCl};
    case Mode::kSpiral:
      break;
  }
  return {kCY, kCl, kCn};
}

/// What a mode rests on that the reader must know.
std::string note_of(Mode mode, const FlightModes& modes, std::span<const CoefficientResult> results,
                    bool engine_modelled) {
  std::vector<std::string> notes, predicting, with_care;
  for (const Coefficient c : sources_of(mode, modes)) {
    const auto result = std::ranges::find(results, c, &CoefficientResult::coefficient);
    if (result == results.end()) continue;
    if (result->verdict == estimation::GroupVerdict::kEffective) predicting.emplace_back(name_of(c));
    if (result->judgement.parameters.grade == estimation::Grade::kWithCare) with_care.emplace_back(name_of(c));
  }
  if (!predicting.empty()) notes.push_back(fmt::format("{} only predicts", fmt::join(predicting, ", ")));
  if (!with_care.empty()) notes.push_back(fmt::format("{} with care", fmt::join(with_care, ", ")));
  if (mode == Mode::kPhugoid && !engine_modelled) notes.emplace_back("thrust by airspeed not known");
  if (mode == Mode::kShortPeriod && !modes.longitudinal_whole) notes.emplace_back("of alpha and q alone");
  if (mode == Mode::kDutchRoll && !modes.lateral_whole) notes.emplace_back("of beta and r alone");
  if (mode == Mode::kRoll && !modes.lateral_whole) notes.emplace_back("of p alone");
  return fmt::format("{}", fmt::join(notes, "; "));
}

}  // namespace

std::vector<DerivedQuantity> derived_modes(const Subject& identified, std::span<const CoefficientResult> results,
                                           const estimation::Estimate& estimate, const Trim& flown,
                                           const FlyingQualities& asked, std::uint64_t seed) {
  if (!identified.inertia) return {};
  const UncertainSubject subject(identified, results, estimate);
  const DrawnModes drawn(subject, flown, seed);
  std::vector<DerivedQuantity> out;
  const auto add = [&](Mode mode, DerivedQuantity quantity) {
    quantity.group = words_of(mode);
    out.push_back(std::move(quantity));
  };
  const auto number = [&](Mode mode, std::string_view name, std::string unit, const Spread& spread,
                          std::string note = {}) {
    add(mode, {.group = {},
               .name = fmt::format("{}.{}", kModeNames[mode], name),
               .value = spread.value,
               .low95 = spread.low95,
               .high95 = spread.high95,
               .unit = std::move(unit),
               .note = std::move(note)});
  };
  for (const Mode mode : enumerators<Mode, kModes>()) {
    if (!drawn.best().modes[mode]) continue;
    const std::string caution =
        note_of(mode, drawn.best(), results, identified.propulsion.kind != PropulsionKind::kNone);
    const std::string says = fmt::format("at {:.1f} m/s and {:.3f} kg/m^3{}{}", flown.condition.airspeed,
                                         flown.condition.density, caution.empty() ? "" : "; ", caution);
    const Spread decay = drawn.spread(of_mode(mode, &NaturalMode::decay));
    if (has_two_roots(mode)) {
      number(mode, "frequency", "rad/s", drawn.spread(of_mode(mode, &NaturalMode::frequency)), says);
      number(mode, "damping", "1", drawn.spread(of_mode(mode, &NaturalMode::damping)));
      add(mode, time_of(mode, decay));
    } else {
      DerivedQuantity time = time_of(mode, decay);
      time.note = says;
      add(mode, std::move(time));
    }
    if (mode == Mode::kRoll && decay.value > 0.0 && decay.low95 > 0.0)
      number(mode, "time_constant", "s", {1.0 / decay.value, 1.0 / decay.high95, 1.0 / decay.low95});
    if (mode == Mode::kShortPeriod) {
      number(mode, "load_factor_per_alpha", "1/rad",
             drawn.spread([](const FlightModes& m) { return m.load_factor_per_alpha; }));
      number(mode, "control_anticipation", "1/s^2",
             drawn.spread([](const FlightModes& m) { return m.control_anticipation; }), "CAP: per g of load factor");
    }
    add(mode, level_of_draws(mode, drawn, asked));
  }
  return out;
}

}  // namespace veridyn::aircraft
