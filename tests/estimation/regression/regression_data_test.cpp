#include "veridyn/estimation/regression/regression_data.hpp"

#include <limits>

#include "veridyn/core/error.hpp"

namespace {
using namespace veridyn::estimation;
using testing::HasSubstr;

RegressionData small_data() {
  RegressionData data;
  data.regressors = RowMatrix::Random(8, 2);
  data.regressand = Eigen::VectorXd::Random(8);
  data.parameter_names = {"a", "b"};
  data.regressand_name = "CY";
  return data;
}

std::string message_of(const RegressionData& data) {
  try {
    data.validate();
  } catch (const veridyn::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RegressionData, NamesRowAndParameterOfAValueThatIsNotFinite) {
  RegressionData data = small_data();
  EXPECT_EQ(message_of(data), "");
  data.regressors(3, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message_of(data), HasSubstr("regression of CY: row 3: regressor of b is nan"));
}

TEST(RegressionData, RefusesAnErrorCovarianceThatCannotBeOne) {
  RegressionData data = small_data();
  data.error_covariance = Eigen::MatrixXd::Identity(2, 2);
  EXPECT_THAT(message_of(data), HasSubstr("is 2 x 2; must be 3 x 3"));
  data.error_covariance = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_EQ(message_of(data), "");
  data.error_covariance(0, 1) = 0.2;
  EXPECT_THAT(message_of(data), HasSubstr("must be symmetric"));
  data.error_covariance(1, 0) = 0.2;
  EXPECT_EQ(message_of(data), "");
  data.error_covariance(0, 1) = data.error_covariance(1, 0) = 1.5;
  EXPECT_THAT(message_of(data), HasSubstr("indefinite"));
  data.error_covariance = Eigen::MatrixXd::Identity(3, 3);
  data.error_covariance(2, 2) = 0.0;
  EXPECT_THAT(message_of(data), HasSubstr("regressand's error is 0"));
}

TEST(RegressionData, RefusesSegmentsThatComeBackAndRepeatedNames) {
  RegressionData data = small_data();
  data.segment = {0, 0, 1, 1, 0, 0, 2, 2};
  EXPECT_THAT(message_of(data), HasSubstr("id 0 comes back at row 4"));
  data.segment.clear();
  data.parameter_names = {"a", "a"};
  EXPECT_THAT(message_of(data), HasSubstr("two parameters are named 'a'"));
}

TEST(RegressionData, SplitsASegmentWhereARowIsDropped) {
  RegressionData data = small_data();
  const RegressionData before = data;
  data.segment = {7, 7, 7, 7, 9, 9, 9, 9};
  data.regressand(2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(drop_rows_that_are_not_finite(data), 1);
  EXPECT_EQ(data.segment, (std::vector<int>{0, 0, 1, 2, 2, 2, 2}));
  EXPECT_EQ(data.regressors.row(2), before.regressors.row(3));
  EXPECT_EQ(data.regressand(6), before.regressand(7));
}

}  // namespace
