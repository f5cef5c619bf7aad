#include "veridyn/estimation/result/estimate.hpp"

#include <gtest/gtest.h>

namespace veridyn::estimation {
namespace {

TEST(Estimate, FindsAParameterByItsWholeName) {
  Estimate estimate;
  for (const char* name : {"Cm_alpha", "Cm_de", "Cm"}) {
    Parameter p;
    p.name = name;
    p.value = static_cast<double>(estimate.parameters.size());
    estimate.parameters.push_back(p);
  }
  ASSERT_NE(estimate.find("Cm_de"), nullptr);
  EXPECT_EQ(estimate.find("Cm_de"), &estimate.parameters[1]);
  EXPECT_EQ(estimate.find("Cm")->value, 2.0) << "not the first that begins so";
  EXPECT_EQ(estimate.find("Cm_q"), nullptr);
  EXPECT_EQ(estimate.find(""), nullptr);
  EXPECT_EQ(Estimate{}.find("Cm"), nullptr);
}

TEST(Estimate, SaysFirstThatItsSearchWasInterrupted) {
  Estimate estimate;
  EXPECT_EQ(sentence_of(estimate), sentence_of(estimate.judgement));
  estimate.interrupted = true;
  EXPECT_EQ(sentence_of(estimate),
            "Interrupted: this is the best estimate found by then. " + sentence_of(estimate.judgement));
}

}  // namespace
}  // namespace veridyn::estimation
