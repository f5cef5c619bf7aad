// Functions of several arguments, as files have them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"
#include "veridyn/muscle/osim/osim_function.hpp"

namespace veridyn::muscle::osim {
namespace {

using ::testing::HasSubstr;

numerics::MultivariatePolynomial several_of(const std::string& xml, std::size_t arguments) {
  const Document document("<OpenSimDocument Version=\"40500\"><Model><Axis><function>" + xml +
                              "</function></Axis></Model></OpenSimDocument>",
                          "f.osim");
  const Element function = find_function(Element(document, document.model().child("Axis")), "function");
  EXPECT_TRUE(function);
  return read_function_of_several(function, arguments);
}

std::string several_xml(const std::string& coefficients, const std::string& dimension, const std::string& order) {
  return "<MultivariatePolynomialFunction><coefficients>" + coefficients + "</coefficients><dimension>" + dimension +
         "</dimension><order>" + order + "</order></MultivariatePolynomialFunction>";
}

TEST(OsimFunctionOfSeveral, EveryKindHasItsValueAndGradient) {
  struct Case {
    std::string xml;
    double value, by_x, by_y;  ///< at (2, 3)
  };
  const double at[2] = {2.0, 3.0};
  for (const Case& c :
       {Case{several_xml("1 2 3 4 5 6", "2", "2"), 96.0, 43.0, 30.0},
        Case{"<LinearFunction><coefficients>10 100 7</coefficients></LinearFunction>", 327.0, 10.0, 100.0},
        Case{"<Constant><value>0.3</value></Constant>", 0.3, 0.0, 0.0},
        Case{"<MultiplierFunction><function>" + several_xml("0 1 2", "2", "1") +
                 "</function><scale>-10</scale></MultiplierFunction>",
             -70.0, -20.0, -10.0}}) {
    SCOPED_TRACE(c.xml);
    double gradient[2];
    EXPECT_EQ(several_of(c.xml, 2).evaluate(at, gradient), c.value);
    EXPECT_EQ(gradient[0], c.by_x);
    EXPECT_EQ(gradient[1], c.by_y);
  }
}

TEST(OsimFunctionOfSeveral, ErrorsNameWhatIsWrong) {
  const auto error_of = [](const std::string& xml) { return why([&] { static_cast<void>(several_of(xml, 2)); }); };
  EXPECT_THAT(error_of(several_xml("1 2 3 4 5", "2", "2")),
              HasSubstr("coefficients: 5 numbers; dimension 2 and order 2 have 6 terms"));
  EXPECT_THAT(error_of(several_xml("1 2 3 4", "3", "1")), HasSubstr("dimension: 3 where the function has 2 arguments"));
  EXPECT_THAT(error_of(several_xml("1", "2", "1.5")), HasSubstr("order: 1.5 must be a whole number, 0 to 15"));
  EXPECT_THAT(error_of(several_xml("1", "2", "1e300")), HasSubstr("must be a whole number"));
  EXPECT_THAT(error_of("<MultivariatePolynomialFunction><coefficients>1</coefficients><dimension>2</dimension>"
                       "</MultivariatePolynomialFunction>"),
              HasSubstr("order: missing"));
  EXPECT_THAT(error_of("<LinearFunction><coefficients>1 2</coefficients></LinearFunction>"),
              HasSubstr("2 numbers where 2 slopes and the intercept are expected"));
  EXPECT_THAT(error_of("<SimmSpline><x>0 1</x><y>0 1</y></SimmSpline>"), HasSubstr("a function of this kind has no 2"));
}

}  // namespace
}  // namespace veridyn::muscle::osim
