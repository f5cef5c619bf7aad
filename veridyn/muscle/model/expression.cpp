#include "veridyn/muscle/model/expression.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

double step_up(double x) { return x >= 0.0 ? 1.0 : 0.0; }
double at_zero(double x) { return x == 0.0 ? 1.0 : 0.0; }
double squared(double x) { return x * x; }
double cubed(double x) { return x * x * x; }
double reciprocal(double x) { return 1.0 / x; }
double secant(double x) { return 1.0 / std::cos(x); }
double cosecant(double x) { return 1.0 / std::sin(x); }
double cotangent(double x) { return 1.0 / std::tan(x); }
double lesser(double x, double y) { return std::min(x, y); }
double larger(double x, double y) { return std::max(x, y); }
double selected(double x, double y, double z) { return x != 0.0 ? y : z; }

using One = double (*)(double);

void define_functions(mu::Parser& parser) {
  parser.ClearFun();
  parser.ClearConst();
  const std::pair<const char*, One> functions[] = {
      {"sqrt", std::sqrt}, {"exp", std::exp},   {"log", std::log},     {"ln", std::log},    {"sin", std::sin},
      {"cos", std::cos},   {"tan", std::tan},   {"sec", secant},       {"csc", cosecant},   {"cot", cotangent},
      {"asin", std::asin}, {"acos", std::acos}, {"atan", std::atan},   {"sinh", std::sinh}, {"cosh", std::cosh},
      {"tanh", std::tanh}, {"erf", std::erf},   {"erfc", std::erfc},   {"step", step_up},   {"delta", at_zero},
      {"square", squared}, {"cube", cubed},     {"recip", reciprocal}, {"abs", std::fabs},  {"floor", std::floor},
      {"ceil", std::ceil}};
  for (const auto& [name, function] : functions) parser.DefineFun(name, function);
  parser.DefineFun("atan2", static_cast<double (*)(double, double)>(std::atan2));
  parser.DefineFun("min", lesser);
  parser.DefineFun("max", larger);
  parser.DefineFun("select", selected);
}

/// Without blanks, as OpenSim reads formulas, cut at semicolons.
std::vector<std::string> parts_of(std::string_view text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ';') {
      parts.emplace_back();
    } else if (std::isspace(static_cast<unsigned char>(c)) == 0) {
      parts.back() += c;
    }
  }
  while (parts.size() > 1 && parts.back().empty()) parts.pop_back();
  return parts;
}

}  // namespace

struct Expression::Program {
  std::vector<double> values;       ///< of the variables
  std::vector<double> definitions;  ///< of what the text defines
  std::vector<mu::Parser> parsers;  ///< of the definitions, each after those that it uses, then of the formula
};

Expression::Expression(std::string_view text, std::vector<std::string> variables)
    : text_(text), variables_(std::move(variables)), program_(std::make_unique<Program>()) {
  const std::vector<std::string> parts = parts_of(text);
  program_->values.resize(variables_.size());
  program_->definitions.resize(parts.size() - 1);
  std::vector<std::string> names;
  // A definition may use those that come after it.
  for (std::size_t k = parts.size(); k-- > 0;) {
    std::string formula = parts[k], name;
    if (k > 0) {
      const std::size_t equals = formula.find('=');
      if (equals == std::string::npos)
        throw InputError(fmt::format("'{}'", text_), fmt::format("'{}' defines nothing: name = value", formula));
      name = formula.substr(0, equals);
      formula.erase(0, equals + 1);
    }
    try {
      mu::Parser parser;
      define_functions(parser);
      for (std::size_t v = 0; v < variables_.size(); ++v) parser.DefineVar(variables_[v], &program_->values[v]);
      for (std::size_t d = 0; d < names.size(); ++d) parser.DefineVar(names[d], &program_->definitions[d]);
      if (k > 0) mu::Parser().DefineVar(name, &program_->definitions[names.size()]);  // refuses what is no name
      parser.SetExpr(formula);
      static_cast<void>(parser.Eval());
      if (parser.GetNumResults() != 1)
        throw InputError(fmt::format("'{}'", text_), "is a list of formulas; one is expected");
      program_->parsers.push_back(std::move(parser));
    } catch (const mu::Parser::exception_type& error) {
      std::string what = error.GetMsg();
      std::replace(what.begin(), what.end(), '"', '\'');
      throw InputError(fmt::format("'{}'", text_), what);
    }
    if (k > 0) names.push_back(std::move(name));
  }
}

Expression::Expression(const Expression& other) : Expression(other.text_, other.variables_) {}
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(const Expression& other) {
  if (this != &other) *this = Expression(other);
  return *this;
}
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

double Expression::operator()(std::span<const double> values) const {
  Program& p = *program_;
  std::copy_n(values.begin(), p.values.size(), p.values.begin());
  for (std::size_t d = 0; d + 1 < p.parsers.size(); ++d) p.definitions[d] = p.parsers[d].Eval();
  return p.parsers.back().Eval();
}

}  // namespace veridyn::muscle
