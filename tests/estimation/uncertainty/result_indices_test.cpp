#include "veridyn/estimation/uncertainty/result_indices.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

using ::testing::HasSubstr;

IndexOptions read_index_keys(const std::string& text) {
  return read_index_options(Study::parse("[sensitivity]\n" + text, "study.toml").root().table("sensitivity"), 7);
}

std::string index_refusal(const std::string& text) {
  try {
    static_cast<void>(read_index_keys(text));
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(ResultIndices, AreReadWithTheirOptions) {
  const IndexOptions o = read_index_keys(
      "method = \"morris\"\nindex_samples = 64\nreplicates = 8\nlevel = 0.9\n"
      "trajectories = 8\nlevels = 6\n");
  EXPECT_EQ(o.method, IndexMethod::kMorris);
  EXPECT_EQ(o.variance.samples, 64u);
  EXPECT_EQ(o.variance.replicates, 8u);
  EXPECT_EQ(o.variance.level, 0.9);
  EXPECT_EQ(o.variance.seed, 7u);
  EXPECT_EQ(o.morris_trajectories, 8u);
  EXPECT_EQ(o.morris_levels, 6u);
  EXPECT_EQ(read_index_keys("").method, IndexMethod::kVariance);
  EXPECT_THAT(index_refusal("index_samples = 0"),
              HasSubstr("study.toml:2: sensitivity.index_samples: = 0 must be from 2"));
  EXPECT_THAT(index_refusal("trajectories = 0"), HasSubstr("sensitivity.trajectories"));
  EXPECT_THAT(index_refusal("levels = 3"), HasSubstr("must be even"));
  EXPECT_THAT(index_refusal("level = 1"), HasSubstr("between 0 and 1"));
  EXPECT_THAT(index_refusal("method = \"sobol\""), HasSubstr("variance"));
}

TEST(ResultIndices, SayWhereThereAreNone) {
  const IndexOptions options{.variance = {.samples = 4}};
  const Eigen::MatrixXd design = index_design(1, options);
  std::vector<std::string> warnings;
  const ResultIndices r =
      result_indices("gain", Eigen::VectorXd::Constant(design.rows(), kNaN), design, options, warnings);
  EXPECT_TRUE(r.variance.inputs.empty());
  EXPECT_EQ(r.failed, 12u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0], "gain: no indices, 12 of 12 points could not be simulated");
  EXPECT_EQ(index_design(3, {.method = IndexMethod::kNone}).rows(), 0);
}

TEST(ResultIndices, WarnOfWideIntervalsOfWhatIsInfluential) {
  ResultIndices r{.result = "gain"};
  r.variance.inputs.resize(2);
  r.variance.inputs[0] = {
      .first = 0.9, .total = 0.9, .first_low = 0.7, .first_high = 1.0, .total_low = 0.89, .total_high = 0.91};
  r.variance.inputs[1] = {
      .first = 0.0, .total = 0.01, .first_low = -0.1, .first_high = 0.1, .total_low = 0.0, .total_high = 0.1};
  const std::vector<std::string> names{"C_f", "mass"};
  EXPECT_EQ(wide_interval_warning(r, names, 64),
            "gain: 3 of 4 indices have an interval wider than 10 % of the index, of influential inputs C_f; with 256 "
            "instead of 64 samples they are half as wide or less");
  const std::vector<ResultIndices> both{r, r};
  EXPECT_THAT(wide_interval_warning(both, 64),
              HasSubstr("6 of 8 indices have an interval wider than 10 % of the index, "
                        "2 of them of inputs that move their result by 5 % or more"));
  r.variance.inputs.clear();
  EXPECT_EQ(wide_interval_warning(r, names, 64), "");
}

}  // namespace
}  // namespace veridyn::estimation
