#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn::muscle {

/// A formula of named variables as text, "-k_1*q^3 + step(qdot)", parsed once (muParser does it).
///
/// Numbers, + - * / ^ (from right to left, before a sign: -q^2 is -(q^2)), parentheses; sqrt exp log ln sin cos tan sec
/// csc cot asin acos atan atan2 sinh cosh tanh erf erfc step delta square cube recip min max abs floor ceil select, as
/// the library Lepton and with it OpenSim have them: log is natural, step(x) 1 from x = 0 on, delta(x) 1 at x = 0,
/// select(x, y, z) y unless x is 0. Definitions may follow: "a*q; a = b + 1; b = 2".
///
/// Copies are independent; one is for one thread.
class Expression {
 public:
  /// @throws InputError saying what is wrong and where in the text.
  Expression(std::string_view text, std::vector<std::string> variables);
  Expression(const Expression& other);
  Expression(Expression&&) noexcept;
  Expression& operator=(const Expression& other);
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::span<const std::string> variables() const { return variables_; }
  /// The value for variables in their order. Not finite where the formula is not.
  [[nodiscard]] double operator()(std::span<const double> values) const;

 private:
  struct Program;
  std::string text_;
  std::vector<std::string> variables_;
  std::unique_ptr<Program> program_;
};

}  // namespace veridyn::muscle
