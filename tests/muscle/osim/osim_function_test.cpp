#include "veridyn/muscle/osim/osim_function.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle::osim {
namespace {

using ::testing::HasSubstr;

numerics::PiecewisePolynomial function_of(const std::string& xml) {
  const Document document("<OpenSimDocument Version=\"30000\"><Model><Axis><function>" + xml +
                              "</function></Axis></Model></OpenSimDocument>",
                          "f.osim");
  const Element function = find_function(Element(document, document.model().child("Axis")), "function");
  EXPECT_TRUE(function);
  return read_function(function);
}

TEST(OsimFunction, EveryKindHasItsValueAndSlope) {
  struct Case {
    const char* xml;
    double value, slope;  ///< at 1.5
  };
  for (const Case& c :
       {Case{"<Constant><value>0.3</value></Constant>", 0.3, 0.0},
        Case{"<LinearFunction><coefficients>2 -1</coefficients></LinearFunction>", 2.0, 2.0},
        Case{"<PolynomialFunction><coefficients>1 0 4</coefficients></PolynomialFunction>", 6.25, 3.0},
        Case{"<PiecewiseLinearFunction><x>0 1 2</x><y>0 1 5</y></PiecewiseLinearFunction>", 3.0, 4.0},
        Case{"<SimmSpline><x>0 1 2 3</x><y>0 1 8 27</y></SimmSpline>", 3.375, 6.75},
        Case{"<GCVSpline><half_order>2</half_order><x>0 1 2</x><y>0 3 6</y></GCVSpline>", 4.5, 3.0},
        Case{"<MultiplierFunction><function><LinearFunction><coefficients>2 -1</coefficients></LinearFunction>"
             "</function><scale>10</scale></MultiplierFunction>",
             20.0, 20.0}}) {
    SCOPED_TRACE(c.xml);
    const auto f = function_of(c.xml).evaluate(1.5);
    EXPECT_NEAR(f.value, c.value, 1e-13);
    EXPECT_NEAR(f.slope, c.slope, 1e-12);
  }
}

TEST(OsimFunction, ErrorsNameWhatIsWrong) {
  const auto error_of = [](const std::string& xml) -> std::string {
    try {
      (void)function_of(xml);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of("<SimmSpline><x>0 1</x><y>0 1 2</y></SimmSpline>"), HasSubstr("2 and 3 numbers"));
  EXPECT_THAT(error_of("<SimmSpline><x>0 0 1</x><y>0 1 2</y></SimmSpline>"), HasSubstr("0 after 0 does not ascend"));
  EXPECT_THAT(error_of("<GCVSpline><half_order>3</half_order><x>0 1</x><y>0 1</y></GCVSpline>"),
              HasSubstr("half_order 2"));
  EXPECT_THAT(error_of("<StepFunction/>"), HasSubstr("not understood"));
}

}  // namespace
}  // namespace veridyn::muscle::osim
