#include "veridyn/io/results/indices_csv.hpp"

#include <gtest/gtest.h>

namespace veridyn::io {
namespace {

TEST(IndicesCsv, HasARowForEachResultAndInput) {
  estimation::ResultIndices r{.result = "gain, steady"};
  r.variance.inputs = {
      {.first = 0.5, .total = 0.6, .first_low = 0.49, .first_high = 0.51, .total_low = 0.5, .total_high = 0.7}};
  const std::vector<std::string> inputs{"C_f"};
  EXPECT_EQ(indices_csv(std::span(&r, 1), inputs, estimation::IndexMethod::kVariance),
            "result,input,first,first_low,first_high,first_wide,total,total_low,total_high,total_wide\n"
            "\"gain, steady\",C_f,0.5,0.49,0.51,no,0.6,0.5,0.7,yes\n");
  estimation::ResultIndices m{.result = "gain"};
  m.morris = {{.mean = -1.0, .absolute = 2.0, .sd = 0.25}};
  EXPECT_EQ(indices_csv(std::span(&m, 1), inputs, estimation::IndexMethod::kMorris),
            "result,input,mu,mu_star,sigma\ngain,C_f,-1,2,0.25\n");
}

}  // namespace
}  // namespace veridyn::io
