#include "veridyn/aircraft/model/aero_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/core/units.hpp"

namespace veridyn::aircraft {

namespace {

constexpr int kHighestPower = 9;
constexpr int kHighestDegree = 5;

std::string_view variable_name(AeroVariable v) { return kAeroVariableNames[v]; }

bool is_angle(AeroVariable v) {
  return v == AeroVariable::kAlpha || v == AeroVariable::kBeta || v == AeroVariable::kDe || v == AeroVariable::kDa ||
         v == AeroVariable::kDr;
}

/// Splits at `separator`, but not within parentheses.
std::vector<std::string_view> split(std::string_view s, char separator) {
  std::vector<std::string_view> parts;
  std::size_t begin = 0;
  int depth = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (s[i] == '(') ++depth;
    if (s[i] == ')') --depth;
    if (s[i] == separator && depth == 0) {
      parts.push_back(trimmed(s.substr(begin, i - begin)));
      begin = i + 1;
    }
  }
  parts.push_back(trimmed(s.substr(begin)));
  return parts;
}

/// Shortest text that reads back to the same number.
std::string number_text(double x) { return fmt::format("{}", x); }

/// View of the text of a term and of the place that messages name.
class TermParser {
 public:
  TermParser(std::string_view text, std::string_view place) : text_(text), place_(place) {}

  std::vector<Factor> parse() const {
    std::vector<Factor> factors;
    if (trimmed(text_).empty()) fail("an empty term; the constant is written \"1\"");
    for (const std::string_view part : split(text_, '*')) {
      if (part == "1") continue;
      merge(factors, parse_factor(part));
    }
    std::sort(factors.begin(), factors.end(), [](const Factor& a, const Factor& b) {
      return std::tuple(a.variable, a.kind, a.knot, a.power) < std::tuple(b.variable, b.kind, b.knot, b.power);
    });
    for (const Factor& f : factors) {
      if (f.power > kHighestPower) fail(fmt::format("power {} is above {}", f.power, kHighestPower));
    }
    return factors;
  }

 private:
  [[noreturn]] void fail(std::string_view what) const {
    throw InputError(place_, fmt::format("term '{}': {}", trimmed(text_), what));
  }

  /// alpha * alpha is alpha^2; products of splines stay as they are.
  static void merge(std::vector<Factor>& factors, const Factor& f) {
    for (Factor& g : factors) {
      if (f.kind != Factor::Kind::kSpline && g.kind == f.kind && g.variable == f.variable) {
        g.power += f.power;
        return;
      }
    }
    factors.push_back(f);
  }

  AeroVariable parse_variable(std::string_view word) const {
    for (const AeroVariable v : enumerators<AeroVariable, kAeroVariables>())
      if (kAeroVariableNames[v] == word) return v;
    const std::vector<std::string> known(kAeroVariableNames.begin(), kAeroVariableNames.end());
    if (word.empty()) fail("a factor is missing");
    fail(fmt::format("unknown variable '{}'{}", word, suggestion(word, known)));
  }

  int parse_whole(std::string_view word, int lowest, int highest, std::string_view what) const {
    int n = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), n);
    if (error != std::errc() || end != word.data() + word.size() || n < lowest || n > highest) {
      fail(fmt::format("{} '{}' is not a whole number from {} to {}", what, word, lowest, highest));
    }
    return n;
  }

  double parse_knot(std::string_view word, AeroVariable v) const {
    double x = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    if (error != std::errc() || !std::isfinite(x)) fail(fmt::format("knot '{}' is not a number", word));
    const std::string_view rest =
        trimmed(std::string_view(end, static_cast<std::size_t>(word.data() + word.size() - end)));
    if (rest.empty()) return x;
    const std::string_view expected = is_angle(v) ? "rad" : v == AeroVariable::kVa ? "m/s" : "1";
    try {
      return parse_unit_like(rest, parse_unit(expected)).to_si(x);
    } catch (const InputError& e) {
      fail(fmt::format("knot '{}': {}", word, e.what()));
    }
  }

  /// The inside of "name(...)" when `part` is such a call.
  std::optional<std::string_view> call(std::string_view part, std::string_view name) const {
    if (!part.starts_with(name)) return std::nullopt;
    const std::string_view rest = trimmed(part.substr(name.size()));
    if (rest.empty() || rest.front() != '(') return std::nullopt;
    if (rest.back() != ')') fail(fmt::format("'{}' lacks its closing parenthesis", part));
    return rest.substr(1, rest.size() - 2);
  }

  Factor parse_factor(std::string_view part) const {
    Factor f;
    if (const auto inside = call(part, "spline")) {
      const std::vector<std::string_view> arguments = split(*inside, ',');
      if (arguments.size() != 3) fail("a spline is written spline(variable, knot, degree)");
      f.kind = Factor::Kind::kSpline;
      f.variable = parse_variable(arguments[0]);
      f.knot = parse_knot(arguments[1], f.variable);
      f.power = parse_whole(arguments[2], 0, kHighestDegree, "degree");
      return f;
    }
    const std::size_t hat = part.rfind('^');
    if (hat != std::string_view::npos) {
      f.power = parse_whole(trimmed(part.substr(hat + 1)), 1, kHighestPower, "power");
      part = trimmed(part.substr(0, hat));
    }
    if (const auto inside = call(part, "abs")) {
      f.kind = Factor::Kind::kAbsolute;
      f.variable = parse_variable(trimmed(*inside));
      return f;
    }
    f.variable = parse_variable(part);
    return f;
  }

  std::string_view text_;
  std::string_view place_;
};

/// Knot in degrees where that is exact enough to read back, otherwise plain.
std::string knot_text(const Factor& f) {
  if (!is_angle(f.variable)) return number_text(f.knot);
  const std::string degrees = fmt::format("{:.10g}", f.knot / kDegree);
  if (std::stod(degrees) * kDegree == f.knot) return degrees + " deg";
  return number_text(f.knot);
}

std::string canonical_text(const std::vector<Factor>& factors) {
  if (factors.empty()) return "1";
  std::string text;
  for (const Factor& f : factors) {
    if (!text.empty()) text += "*";
    const std::string_view v = variable_name(f.variable);
    switch (f.kind) {
      case Factor::Kind::kPower:
        text += v;
        break;
      case Factor::Kind::kAbsolute:
        text += fmt::format("abs({})", v);
        break;
      case Factor::Kind::kSpline:
        text += fmt::format("spline({}, {}, {})", v, knot_text(f), f.power);
        continue;
    }
    if (f.power != 1) text += fmt::format("^{}", f.power);
  }
  return text;
}

CoefficientModel read_coefficient(const StudyTable& table, Coefficient c) {
  const std::string key(name_of(c));
  CoefficientModel model;
  model.coefficient = c;
  const auto add = [&](std::string_view text, double value, const std::string& place) {
    Term term = parse_term(text, place);
    for (const Term& other : model.terms) {
      if (other == term) throw InputError(place, fmt::format("term '{}' is there twice", term.expression));
    }
    model.terms.push_back(std::move(term));
    model.values.push_back(value);
  };
  if (table.is_array(key)) {
    for (const std::string& text : table.texts(key)) add(text, kNaN, table.place(key));
  } else if (table.is_table(key)) {
    const StudyTable values = table.table(key);
    for (const std::string& text : values.keys()) {
      const bool unknown = values.is_text(text) && values.text(text) == "unknown";
      add(text, unknown ? kNaN : values.number(text, "1"), values.place(text));
    }
  } else {
    table.fail(key, "is neither a list of terms, [\"1\", \"alpha\"], nor a table of values, { alpha = 4.5 }");
  }
  if (model.terms.empty()) table.fail(key, "has no terms");
  return model;
}

const KeyTable<StallBlend>& stall_keys() {
  using S = StallBlend;
  static const auto table =
      KeyTable<S>("stall", "How a simulated model behaves beyond stall; without it the terms hold at every angle.")
          .number("M", &S::M, "1/rad", kPositive, "sharpness")
          .number("alpha0", &S::alpha0, "rad", kPositive,
                  "angle of attack where half of the flow is separated, below 90 deg")
          .other({"form", "", "`\"full\"`, `\"source\"`, `\"separation\"`, `\"none\"`", "\"full\"",
                  "`full`: blends into a flat plate with every term; `source`: only constant and alpha are blended; "
                  "`separation`: levels off as Kirchhoff's wing does; `none`: drops the blend of a built-in subject"},
                 [](const StudyTable& t, const std::string& key, S& s) {
                   const std::vector<std::string> forms = {"full", "source", "separation", "none"};
                   const std::string form = t.choice_or(key, forms, "");
                   if (form == "none") return;
                   s.form = form == "full"     ? StallForm::kFull
                            : form == "source" ? StallForm::kSource
                                               : StallForm::kSeparation;
                 })
          .flag("drag", &S::drag, "whether drag is blended too")
          .check([](const StudyTable& t, S& s) {
            if (s.alpha0 >= 0.5 * kPi) t.fail("alpha0", "is not below 90 deg");
          });
  return table;
}

void read_stall(const StudyTable& model, AeroModel& m) {
  if (!model.has("stall")) return;
  const StudyTable table = model.table("stall");
  StallBlend stall = m.stall.value_or(StallBlend{});
  stall_keys().read(table, stall);
  m.stall = stall;
  if (table.text_or("form", "") == "none") m.stall.reset();
}

/// NaN values (unknown) are equal to each other.
bool same_value(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

std::string_view name_of(StallForm form) {
  switch (form) {
    case StallForm::kFull:
      return "full";
    case StallForm::kSource:
      return "source";
    case StallForm::kSeparation:
      return "separation";
  }
  return {};
}

std::optional<Coefficient> find_coefficient(std::string_view name) {
  for (const Coefficient c : enumerators<Coefficient, kCoefficients>())
    if (kCoefficientNames[c] == name) return c;
  return std::nullopt;
}

bool Term::uses(AeroVariable v) const {
  return std::any_of(factors.begin(), factors.end(), [v](const Factor& f) { return f.variable == v; });
}

std::string Term::parameter_unit() const {
  int angle = 0;
  int speed = 0;
  for (const Factor& f : factors) {
    if (is_angle(f.variable)) angle += f.power;
    if (f.variable == AeroVariable::kVa) speed += f.power;
  }
  const auto power = [](std::string_view unit, int n) {
    return n == 1 ? std::string(unit) : fmt::format("{}^{}", unit, n);
  };
  if (angle == 0 && speed == 0) return "1";
  if (speed == 0) return "1/" + power("rad", angle);
  const std::string slowness = speed == 1 ? "s/m" : fmt::format("s^{0}/m^{0}", speed);
  return angle == 0 ? slowness : slowness + "/" + power("rad", angle);
}

Term parse_term(std::string_view text, std::string_view place) {
  Term term;
  term.factors = TermParser(text, place).parse();
  term.expression = canonical_text(term.factors);
  return term;
}

std::string parameter_name(Coefficient coefficient, const Term& term) {
  std::string name(name_of(coefficient));
  if (term.factors.empty()) return name + "_0";
  for (const Factor& f : term.factors) {
    std::string_view v = variable_name(f.variable);
    if (v.ends_with("_n")) v.remove_suffix(2);
    switch (f.kind) {
      case Factor::Kind::kPower:
        name += fmt::format("_{}", v);
        break;
      case Factor::Kind::kAbsolute:
        name += fmt::format("_abs_{}", v);
        break;
      case Factor::Kind::kSpline:
        name += is_angle(f.variable) ? fmt::format("_spline_{}_{:.6g}deg_{}", v, f.knot / kDegree, f.power)
                                     : fmt::format("_spline_{}_{:.6g}_{}", v, f.knot, f.power);
        continue;
    }
    if (f.power != 1) name += std::to_string(f.power);
  }
  return name;
}

std::vector<std::string> CoefficientModel::parameter_names() const {
  std::vector<std::string> names;
  for (const Term& t : terms) names.push_back(parameter_name(coefficient, t));
  return names;
}

bool CoefficientModel::known() const {
  return std::none_of(values.begin(), values.end(), [](double v) { return std::isnan(v); });
}

std::optional<double> CoefficientModel::value_of(std::string_view expression) const {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].expression == expression) return values[i];
  }
  return std::nullopt;
}

bool operator==(const CoefficientModel& a, const CoefficientModel& b) {
  return a.coefficient == b.coefficient && a.terms == b.terms &&
         std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(), same_value);
}

const CoefficientModel* AeroModel::find(Coefficient c) const {
  const auto& m = coefficients[c];
  return m ? &*m : nullptr;
}

CoefficientModel* AeroModel::find(Coefficient c) {
  auto& m = coefficients[c];
  return m ? &*m : nullptr;
}

const CoefficientModel& AeroModel::at(Coefficient c) const {
  const CoefficientModel* m = find(c);
  VERIDYN_ASSERT(m != nullptr);
  return *m;
}

CoefficientModel& AeroModel::at(Coefficient c) {
  CoefficientModel* m = find(c);
  VERIDYN_ASSERT(m != nullptr);
  return *m;
}

void AeroModel::set(CoefficientModel model) {
  VERIDYN_ASSERT(model.terms.size() == model.values.size());
  auto& slot = coefficients[model.coefficient];
  slot = std::move(model);
}

std::vector<std::string> AeroModel::unknown_parameters() const {
  std::vector<std::string> names;
  for (const auto& m : coefficients) {
    if (!m) continue;
    for (std::size_t i = 0; i < m->size(); ++i) {
      if (std::isnan(m->values[i])) names.push_back(parameter_name(m->coefficient, m->terms[i]));
    }
  }
  return names;
}

bool operator==(const AeroModel& a, const AeroModel& b) {
  return a.coefficients == b.coefficients && a.stall == b.stall;
}

CoefficientModel coefficient_model(Coefficient c, std::span<const std::pair<std::string_view, double>> terms) {
  CoefficientModel model;
  model.coefficient = c;
  for (const auto& [text, value] : terms) {
    model.terms.push_back(parse_term(text, name_of(c)));
    model.values.push_back(value);
  }
  return model;
}

const KeyTable<AeroModel>& aero_model_keys() {
  static const auto table = [] {
    KeyTable<AeroModel> keys("model",
                             "The aerodynamic model. Each coefficient is a structure, `[\"1\", \"alpha\", "
                             "\"q_n\", \"de\"]`, or has "
                             "values too, `{ \"1\" = 0.29, alpha = 3.6, de = \"unknown\" }`, and replaces that of a "
                             "built-in subject as a whole.");
    for (const Coefficient c : enumerators<Coefficient, kCoefficients>())
      keys.other({std::string(name_of(c)), "", "terms, with values or without", "not modelled",
                  std::string(meaning_of(c)), true},
                 [c](const StudyTable& t, const std::string&, AeroModel& m) { m.set(read_coefficient(t, c)); });
    return keys.within("stall", stall_keys(), read_stall);
  }();
  return table;
}

std::string write_aero_model_toml(const AeroModel& model, std::string_view heading) {
  std::string out = fmt::format("[{}]\n", heading);
  for (const auto& m : model.coefficients) {
    if (!m) continue;
    out += fmt::format("{} = {{", name_of(m->coefficient));
    for (std::size_t i = 0; i < m->size(); ++i) {
      out += fmt::format("{} \"{}\" = {}", i == 0 ? "" : ",", m->terms[i].expression,
                         std::isnan(m->values[i]) ? "\"unknown\"" : number_text(m->values[i]));
    }
    out += " }\n";
  }
  if (model.stall) {
    out += fmt::format("\n[{}.stall]\nM = {}\nalpha0 = {}\nform = \"{}\"\ndrag = {}\n", heading, model.stall->M,
                       model.stall->alpha0, name_of(model.stall->form), model.stall->drag);
  }
  return out;
}

}  // namespace veridyn::aircraft
