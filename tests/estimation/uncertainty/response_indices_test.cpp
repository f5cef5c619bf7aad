#include "veridyn/estimation/uncertainty/response_indices.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/batches/block_store.hpp"

namespace veridyn::estimation {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ResponseThreads : public Progress {
 public:
  explicit ResponseThreads(int threads) : threads_(threads) {}
  [[nodiscard]] int threads() const override { return threads_; }

 private:
  int threads_;
};

/// Three inputs; a linear result, a product, one that nothing moves, one that fails in a corner.
ResponseProblem three_inputs() {
  return {.inputs = {{.name = "a", .nominal = 1.0, .low = 0.0, .high = 2.0},
                     {.name = "b", .nominal = 10.0, .low = 9.0, .high = 11.0},
                     {.name = "idle", .nominal = 0.0, .low = -1.0, .high = 1.0}},
          .responses = {{.name = "sum"}, {.name = "product"}, {.name = "fixed", .nominal = 5.0, .negligible = 1e-9}},
          .run =
              [](const Eigen::VectorXd& x, std::span<double> y) {
                y[0] = 3.0 * x(0) + 4.0 * x(1);
                y[1] = (x(0) - 1.0) * (x(1) - 10.0);
                y[2] = 5.0 + 1e-13 * x(0);
                return true;
              },
          .fingerprint = 3};
}

IndexOptions of_samples(std::size_t samples = 1024) { return {.variance = {.samples = samples}}; }

// Uniform inputs: variance (high - low)^2/12 of each; 3^2 : 4^2 of the sum, nothing but interaction of the product.
TEST(ResponseIndices, AreThoseOfAClosedForm) {
  numerics::BlockStore store;
  Progress progress;
  const ResponseIndices r = response_indices(three_inputs(), of_samples(), store, progress);
  ASSERT_TRUE(r.completed);
  EXPECT_EQ(r.runs, 5u * 1024u);
  EXPECT_EQ(r.failed, 0u);
  EXPECT_THAT(r.constant, ElementsAre("fixed"));
  ASSERT_EQ(r.results.size(), 2u);
  const auto& sum = r.results[0].variance;
  EXPECT_NEAR(sum.inputs[0].first, 9.0 / 25.0, 0.01);
  EXPECT_NEAR(sum.inputs[1].first, 16.0 / 25.0, 0.01);
  EXPECT_NEAR(sum.inputs[0].total, 9.0 / 25.0, 0.01);
  // The mean of 16 shifted parts of 64 points, A and B, of which each is off by an even distribution over a 64th of the
  // inputs' ranges, 6 and 8: 10/(64 sqrt(12) sqrt(32)) = 0.008, of which four are allowed.
  EXPECT_NEAR(sum.mean, 43.0, 0.032);
  EXPECT_NEAR(sum.variance, 25.0 / 3.0, 0.05);
  EXPECT_EQ(sum.inputs[2].first, 0.0);
  EXPECT_EQ(sum.inputs[2].total, 0.0);
  const auto& product = r.results[1].variance;
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_LE(product.inputs[i].first_low, 0.0);
    EXPECT_GE(product.inputs[i].first_high, 0.0);
    EXPECT_NEAR(product.inputs[i].total, 1.0, 0.05);
  }
  EXPECT_EQ(r.strongest(0), 1u);
}

TEST(ResponseIndices, AreTheSameBitsOnAnyNumberOfThreads) {
  numerics::BlockStore one_store, four_store;
  ResponseThreads one(1), four(4);
  const ResponseIndices a = response_indices(three_inputs(), of_samples(64), one_store, one);
  const ResponseIndices b = response_indices(three_inputs(), of_samples(64), four_store, four);
  for (std::size_t k = 0; k < a.results.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(a.results[k].variance.inputs[i].first, b.results[k].variance.inputs[i].first);
      EXPECT_EQ(a.results[k].variance.inputs[i].total_high, b.results[k].variance.inputs[i].total_high);
    }
  }
}

TEST(ResponseIndices, CountRunsThatFailAndGoOn) {
  ResponseProblem p = three_inputs();
  const auto all = p.run;
  p.run = [all](const Eigen::VectorXd& x, std::span<double> y) { return x(0) < 1.9 && all(x, y); };
  numerics::BlockStore store;
  Progress progress;
  const ResponseIndices r = response_indices(p, of_samples(256), store, progress);
  EXPECT_GT(r.failed, 0u);
  EXPECT_LT(r.failed, r.runs / 10);
  EXPECT_EQ(r.results[0].failed, r.failed);
  EXPECT_GT(r.results[0].variance.dropped, 0u);
  EXPECT_NEAR(r.results[0].variance.inputs[1].total, 0.67, 0.1);
  EXPECT_THAT(r.warnings.front(), HasSubstr("runs could not finish"));
  p.run = [](const Eigen::VectorXd&, std::span<double>) { return false; };
  const ResponseIndices none = response_indices(p, of_samples(16), store, progress);
  EXPECT_EQ(none.failed, none.runs);
  for (const ResultIndices& one : none.results) EXPECT_TRUE(one.variance.inputs.empty());
}

TEST(ResponseIndices, OfMorrisAreSlopesOverTheWholeRange) {
  numerics::BlockStore store;
  Progress progress;
  const ResponseIndices r =
      response_indices(three_inputs(), {.method = IndexMethod::kMorris, .morris_trajectories = 4}, store, progress);
  EXPECT_EQ(r.runs, 16u);
  EXPECT_NEAR(r.results[0].morris[0].absolute, 6.0, 1e-9);
  EXPECT_NEAR(r.results[0].morris[1].mean, 8.0, 1e-9);
  EXPECT_NEAR(r.results[0].morris[1].sd, 0.0, 1e-9);
  EXPECT_EQ(r.results[0].morris[2].absolute, 0.0);
  EXPECT_EQ(r.strongest(0), 1u);
}

const std::vector<IndexInput> kKnown{{.name = "mass", .unit = "kg", .nominal = 1000.0},
                                     {.name = "C_f", .unit = "N/rad", .nominal = 60000.0},
                                     {.name = "K_b", .unit = "N/m", .nominal = 0.0}};

std::vector<IndexInput> inputs_of(const std::string& text) {
  const std::vector<std::string> defaults{"mass", "C_f"};
  const Study study = Study::parse("[sensitivity]\n" + text, "study.toml");
  return index_inputs(GivenInputs::keys().read(study.root().table("sensitivity")), kKnown, defaults);
}

std::string input_refusal(const std::string& text) {
  try {
    static_cast<void>(inputs_of(text));
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(IndexInputs, AreReadWithShareOrBounds) {
  const std::vector<IndexInput> usual = inputs_of("");
  ASSERT_EQ(usual.size(), 2u);
  EXPECT_DOUBLE_EQ(usual[0].low, 900.0);
  EXPECT_DOUBLE_EQ(usual[1].high, 66000.0);
  const std::vector<IndexInput> own = inputs_of(
      "range = \"5 %\"\n[[sensitivity.input]]\nparameter = \"C_f\"\n[[sensitivity.input]]\nparameter = \"mass\"\n"
      "low = \"900 kg\"\nhigh = \"1500 kg\"\n[[sensitivity.input]]\nparameter = \"K_b\"\nlow = 0\nhigh = 5000\n");
  ASSERT_EQ(own.size(), 3u);
  EXPECT_DOUBLE_EQ(own[0].low, 57000.0);
  EXPECT_DOUBLE_EQ(own[1].high, 1500.0);
  EXPECT_DOUBLE_EQ(own[2].high, 5000.0);
  EXPECT_THAT(own[0].place, HasSubstr("study.toml:4"));
}

TEST(IndexInputs, AreRefusedInOneLine) {
  const std::string input = "[[sensitivity.input]]\n";
  EXPECT_THAT(input_refusal(input + "parameter = \"C_ff\""), HasSubstr("study.toml:3: sensitivity.input"));
  EXPECT_THAT(input_refusal(input + "parameter = \"C_ff\""), HasSubstr("did you mean 'C_f'?"));
  EXPECT_THAT(input_refusal(input + "parameter = \"mass\"\nlow = 3\nhigh = 2"), HasSubstr("must be below high"));
  EXPECT_THAT(input_refusal(input + "parameter = \"mass\"\nlow = 3"), HasSubstr("a range has two ends"));
  EXPECT_THAT(input_refusal(input + "parameter = \"mass\"\nlow = 3\nhigh = 4\nrange = 0.1"), HasSubstr("exclude"));
  EXPECT_THAT(input_refusal(input + "parameter = \"mass\"\nrange = 5"),
              HasSubstr("range: = 5 must be between 0 and 1"));
  EXPECT_THAT(input_refusal(input + "parameter = \"K_b\""), HasSubstr("K_b is 0"));
  EXPECT_THAT(input_refusal(input + "parameter = \"mass\"\n" + input + "parameter = \"mass\""), HasSubstr("twice"));
  EXPECT_THAT(input_refusal(input + "range = 0.1"), HasSubstr("parameter"));
  EXPECT_THAT(input_refusal("range = 0"), HasSubstr("sensitivity.range"));
}

}  // namespace
}  // namespace veridyn::estimation
