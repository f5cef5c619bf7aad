#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/model/stall.hpp"
#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// The six aerodynamic coefficients: L = qbar S CL and so on, moments with span b (Cl, Cn) or chord c (Cm).
/// CL and CD along the wind axes, CY along body y, moments about body axes.
enum class Coefficient { kCL, kCD, kCY, kCl, kCm, kCn };
inline constexpr std::size_t kCoefficients = 6;  ///< values of Coefficient
/// As in studies and results.
inline constexpr EnumArray<Coefficient, std::string_view, kCoefficients> kCoefficientNames{
    {"CL", "CD", "CY", "Cl", "Cm", "Cn"}};
/// "CL".
[[nodiscard]] inline std::string_view name_of(Coefficient c) { return kCoefficientNames[c]; }
/// "lift".
[[nodiscard]] inline std::string_view meaning_of(Coefficient c) {
  constexpr EnumArray<Coefficient, std::string_view, kCoefficients> kMeanings{
      {"lift", "drag", "side force", "rolling moment", "pitching moment", "yawing moment"}};
  return kMeanings[c];
}
/// The coefficient called `name`, or none.
[[nodiscard]] std::optional<Coefficient> find_coefficient(std::string_view name);

/// What an aerodynamic coefficient may depend on.
enum class AeroVariable { kAlpha, kBeta, kPn, kQn, kRn, kDe, kDa, kDr, kCT, kVa };
inline constexpr std::size_t kAeroVariables = 10;  ///< values of AeroVariable
/// Names in terms.
inline constexpr EnumArray<AeroVariable, std::string_view, kAeroVariables> kAeroVariableNames{
    {"alpha", "beta", "p_n", "q_n", "r_n", "de", "da", "dr", "CT", "Va"}};

/// Values of the variables at one moment: angles and deflections [rad], p_n = b p / (2 Va), q_n = c q / (2 Va),
/// r_n = b r / (2 Va) [-], thrust coefficient CT = T / (qbar S) [-], airspeed [m/s].
template <typename Scalar>
struct AeroVariables {
  Scalar alpha{0.0}, beta{0.0};
  Scalar p_n{0.0}, q_n{0.0}, r_n{0.0};
  Scalar de{0.0}, da{0.0}, dr{0.0};
  Scalar CT{0.0};
  Scalar Va{0.0};

  [[nodiscard]] const Scalar& operator[](AeroVariable v) const {
    switch (v) {
      case AeroVariable::kAlpha:
        return alpha;
      case AeroVariable::kBeta:
        return beta;
      case AeroVariable::kPn:
        return p_n;
      case AeroVariable::kQn:
        return q_n;
      case AeroVariable::kRn:
        return r_n;
      case AeroVariable::kDe:
        return de;
      case AeroVariable::kDa:
        return da;
      case AeroVariable::kDr:
        return dr;
      case AeroVariable::kCT:
        return CT;
      case AeroVariable::kVa:
        break;
    }
    return Va;
  }
};

/// One factor of a term: a variable to a power, its absolute value to a power, or the truncated power
/// (v - knot)_+^power of a spline.
struct Factor {
  enum class Kind { kPower, kAbsolute, kSpline };
  Kind kind = Kind::kPower;
  AeroVariable variable = AeroVariable::kAlpha;
  int power = 1;      ///< >= 1; 0 only in a spline, where it is a step
  double knot = 0.0;  ///< of a spline [unit of the variable]

  template <typename Scalar>
  [[nodiscard]] Scalar evaluate(const AeroVariables<Scalar>& v) const;
  friend bool operator==(const Factor&, const Factor&) = default;
};

/// One regressor of a coefficient: a product of factors; none is the constant 1.
struct Term {
  std::string
      expression;  ///< canonical text: "1", "alpha", "alpha^2", "alpha*q_n", "abs(de)", "spline(alpha, 5 deg, 2)"
  std::vector<Factor> factors;  ///< in the order of AeroVariable; one power per variable

  template <typename Scalar>
  [[nodiscard]] Scalar evaluate(const AeroVariables<Scalar>& v) const {
    Scalar product(1.0);
    for (const Factor& f : factors) product *= f.evaluate(v);
    return product;
  }
  /// Whether this is the constant regressor, which has no error.
  [[nodiscard]] bool constant() const { return factors.empty(); }
  /// Whether the variable occurs in it.
  [[nodiscard]] bool uses(AeroVariable v) const;
  /// Unit of its parameter in words of the literature: "1" or "1/rad", "1/rad^2", "1/(m/s)" (normalised rates and CT
  /// are dimensionless, yet "1/rad" is customary for rate derivatives; here they count as dimensionless: "1").
  [[nodiscard]] std::string parameter_unit() const;

  friend bool operator==(const Term& a, const Term& b) { return a.factors == b.factors; }
};

/// Reads a term. Grammar: factors joined by "*"; a factor is "1", a variable (see kAeroVariableNames), a factor with
/// "^n" (n a whole number >= 1), "abs(variable)", or "spline(variable, knot, degree)" = (variable - knot)_+^degree with
/// the knot in rad or with a unit ("5 deg") and degree 0..5. Factors may come in any order; repeated variables
/// are merged, so "q_n*alpha" equals "alpha*q_n" and "alpha*alpha" equals "alpha^2".
/// @param place stands in messages, such as "study.toml:14: subject.model.CL"
/// @throws InputError naming the unknown word with the nearest variable.
[[nodiscard]] Term parse_term(std::string_view text, std::string_view place);

/// Name of the parameter of a term, unique within a model: the coefficient, "_", and
/// - "0" for the constant: `CL_0`;
/// - the variables joined by "_" in the order of AeroVariable, without the "_n" of normalised rates, a power behind its
///   variable: `CL_alpha`, `CL_alpha2`, `CL_q`, `CL_alpha_q`, `CY_dr`, `CD_CT`;
/// - "abs" before a variable taken absolute: `CD_abs_de`, `CD_abs_alpha2`;
/// - "spline", variable, knot (angles in deg) and degree: `CL_spline_alpha_5deg_2`.
[[nodiscard]] std::string parameter_name(Coefficient coefficient, const Term& term);

/// One coefficient as a sum of parameters times terms.
struct CoefficientModel {
  Coefficient coefficient = Coefficient::kCL;
  std::vector<Term> terms;
  std::vector<double> values;  ///< one per term; NaN where unknown

  [[nodiscard]] std::size_t size() const { return terms.size(); }
  [[nodiscard]] std::vector<std::string> parameter_names() const;
  /// Whether every value is known.
  [[nodiscard]] bool known() const;
  /// Value of the parameter of the term written `expression` (canonical), or none.
  [[nodiscard]] std::optional<double> value_of(std::string_view expression) const;

  /// Values of the terms: the row of the regression.
  template <typename Scalar>
  [[nodiscard]] Eigen::Matrix<Scalar, Eigen::Dynamic, 1> regressors(const AeroVariables<Scalar>& v) const;
  /// The sum, without stall blend.
  template <typename Scalar>
  [[nodiscard]] Scalar linear(const AeroVariables<Scalar>& v) const;
  /// The same with other parameters, one per term, of any scalar: for derivatives with respect to them.
  template <typename Scalar, typename Parameter>
  [[nodiscard]] auto linear(const AeroVariables<Scalar>& v, std::span<const Parameter> parameters) const;

  friend bool operator==(const CoefficientModel& a, const CoefficientModel& b);
};

/// Values of the six coefficients.
template <typename Scalar>
struct AeroCoefficients {
  Scalar CL{0.0}, CD{0.0}, CY{0.0}, Cl{0.0}, Cm{0.0}, Cn{0.0};
};

/// The aerodynamic model of an aircraft: terms and parameters of each coefficient, and what happens beyond stall.
///
/// A coefficient that is absent is not modelled: it evaluates to zero.
struct AeroModel {
  EnumArray<Coefficient, std::optional<CoefficientModel>, kCoefficients> coefficients;
  std::optional<StallBlend> stall;

  [[nodiscard]] const CoefficientModel* find(Coefficient c) const;
  [[nodiscard]] CoefficientModel* find(Coefficient c);
  /// The coefficient's model; must be there.
  [[nodiscard]] const CoefficientModel& at(Coefficient c) const;
  [[nodiscard]] CoefficientModel& at(Coefficient c);
  void set(CoefficientModel model);
  /// Names of the parameters that have no value, in order.
  [[nodiscard]] std::vector<std::string> unknown_parameters() const;

  /// The coefficients with the stall blend. Does not throw or allocate.
  template <typename Scalar>
  [[nodiscard]] AeroCoefficients<Scalar> evaluate(const AeroVariables<Scalar>& v) const;

  friend bool operator==(const AeroModel& a, const AeroModel& b);
};

/// A coefficient from texts and values: `coefficient_model(kCm, {{"1", 0.02}, {"alpha", -0.7}})`.
[[nodiscard]] CoefficientModel coefficient_model(Coefficient c,
                                                 std::span<const std::pair<std::string_view, double>> terms);

/// Study table `[subject.model]`: each coefficient that it has replaces that of the object as a whole.
[[nodiscard]] const KeyTable<AeroModel>& aero_model_keys();

/// The model as TOML under the heading `[subject.model]`.
[[nodiscard]] std::string write_aero_model_toml(const AeroModel& model, std::string_view heading = "subject.model");

// ---------------------------------------------------------------------------------------------------------------------

template <typename Scalar>
Scalar Factor::evaluate(const AeroVariables<Scalar>& v) const {
  Scalar x = v[variable];
  if (kind == Kind::kAbsolute) {
    if (x < Scalar(0.0)) x = -x;
  } else if (kind == Kind::kSpline) {
    x -= Scalar(knot);
    if (!(x > Scalar(0.0))) return Scalar(0.0);
  }
  Scalar result(1.0);
  for (int i = 0; i < power; ++i) result *= x;
  return result;
}

template <typename Scalar>
Eigen::Matrix<Scalar, Eigen::Dynamic, 1> CoefficientModel::regressors(const AeroVariables<Scalar>& v) const {
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> row(terms.size());
  for (std::size_t i = 0; i < terms.size(); ++i) row(i) = terms[i].evaluate(v);
  return row;
}

template <typename Scalar>
Scalar CoefficientModel::linear(const AeroVariables<Scalar>& v) const {
  Scalar sum(0.0);
  for (std::size_t i = 0; i < terms.size(); ++i) sum += Scalar(values[i]) * terms[i].evaluate(v);
  return sum;
}

template <typename Scalar, typename Parameter>
auto CoefficientModel::linear(const AeroVariables<Scalar>& v, std::span<const Parameter> parameters) const {
  VERIDYN_ASSERT(parameters.size() == terms.size());
  using Result = decltype(Scalar(0.0) * Parameter(0.0));
  Result sum(0.0);
  for (std::size_t i = 0; i < terms.size(); ++i) sum += parameters[i] * terms[i].evaluate(v);
  return sum;
}

namespace internal {

/// The part of a coefficient in `c0 + c_alpha alpha`, with the given parameters, one per term.
template <typename Scalar, typename Parameter>
Scalar affine_in_alpha(const CoefficientModel& m, const Scalar& alpha, std::span<const Parameter> parameters) {
  Scalar sum(0.0);
  for (std::size_t i = 0; i < m.terms.size(); ++i) {
    const std::vector<Factor>& f = m.terms[i].factors;
    if (f.empty()) sum += Scalar(parameters[i]);
    if (f.size() == 1 && f[0] == Factor{}) sum += Scalar(parameters[i]) * alpha;
  }
  return sum;
}

/// What a stall blend needs of lift and drag.
template <typename Scalar>
struct StalledCoefficients {
  bool lift = false, drag = false;  ///< whether they are modelled
  Scalar affine_lift{0.0}, affine_drag{0.0};
};

/// Blends CL and CD, which come as if the flow were attached.
template <typename Scalar>
void blend_stall(const StallBlend& stall, const Scalar& alpha, const StalledCoefficients<Scalar>& of, Scalar& CL,
                 Scalar& CD) {
  using std::sqrt;
  const Scalar s = separated_share(alpha, stall.M, stall.alpha0);
  const bool full = stall.form == StallForm::kFull;
  if (of.lift && stall.form == StallForm::kSeparation) {
    // The square root has no derivative at zero, which underflow could reach.
    const Scalar share = attached_share(alpha, stall.M, stall.alpha0);
    const Scalar attached = share > Scalar(1e-300) ? Scalar(sqrt(share)) : Scalar(0.0);
    const Scalar k = Scalar(0.25) * (Scalar(1.0) + attached) * (Scalar(1.0) + attached);
    CL += (k - Scalar(1.0)) * of.affine_lift;
    return;
  }
  if (of.lift) {
    const Scalar blended = full ? CL : of.affine_lift;
    CL += s * (flat_plate_lift(alpha) - blended);
  }
  if (of.drag && stall.drag) {
    const Scalar blended = full ? CD : of.affine_drag;
    CD += s * (flat_plate_drag(alpha) - blended);
  }
}

}  // namespace internal

template <typename Scalar>
AeroCoefficients<Scalar> AeroModel::evaluate(const AeroVariables<Scalar>& v) const {
  const auto value = [&](Coefficient c) {
    const auto& m = coefficients[c];
    return m ? m->linear(v) : Scalar(0.0);
  };
  AeroCoefficients<Scalar> out;
  out.CL = value(Coefficient::kCL);
  out.CD = value(Coefficient::kCD);
  out.CY = value(Coefficient::kCY);
  out.Cl = value(Coefficient::kCl);
  out.Cm = value(Coefficient::kCm);
  out.Cn = value(Coefficient::kCn);
  if (!stall) return out;
  const auto affine = [&](const std::optional<CoefficientModel>& m) {
    return m ? internal::affine_in_alpha(*m, v.alpha, std::span<const double>(m->values)) : Scalar(0.0);
  };
  const auto& lift = coefficients[Coefficient::kCL];
  const auto& drag = coefficients[Coefficient::kCD];
  const internal::StalledCoefficients<Scalar> of{
      .lift = lift.has_value(), .drag = drag.has_value(), .affine_lift = affine(lift), .affine_drag = affine(drag)};
  internal::blend_stall(*stall, v.alpha, of, out.CL, out.CD);
  return out;
}

}  // namespace veridyn::aircraft
