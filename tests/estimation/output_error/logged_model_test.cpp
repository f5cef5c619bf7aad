#include "veridyn/estimation/output_error/logged_model.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <bit>

#include "tests/estimation/output_error/example_models.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/estimation/output_error/model_view.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"

namespace veridyn::estimation {
namespace {

using testing_support::FirstOrder;

/// Counts simulations, and stops answering after so many as a killed program would.
class CountingModel final : public ModelView {
 public:
  explicit CountingModel(const ParametricModel& model, long most = 1000000) : ModelView(model), most_(most) {}
  [[nodiscard]] bool respond(std::size_t s, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             ModelResponse& response) const override {
    if (++count > most_) throw std::runtime_error("killed");
    return viewed().respond(s, theta, active, response);
  }
  mutable std::atomic<long> count = 0;

 private:
  long most_;
};

class LoggedModelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (std::size_t s = 0; s < 2; ++s) {
      ModelResponse truth;
      ASSERT_TRUE(model_.respond(s, Eigen::Vector3d(1.4, 0.7, 0.2), {}, truth));
      for (Eigen::Index k = 0; k < truth.output.rows(); ++k)
        truth.output(k, 0) += 0.02 * std::sin(7.0 * static_cast<double>(k));
      measured_.push_back(truth.output);
    }
    options_.threads = 1;
  }

  [[nodiscard]] LoggedModel logged(const ParametricModel& model, numerics::ValueLog* log) const {
    return {model, "trained", [this](std::size_t s, const RowMatrix& y) { return (measured_[s] - y).norm(); }, log};
  }
  /// Bits of the estimate.
  static std::vector<std::uint64_t> bits(const OutputErrorEstimate& e) {
    std::vector<std::uint64_t> all;
    for (const double v : e.theta) all.push_back(std::bit_cast<std::uint64_t>(v));
    for (const double v : e.covariance.reshaped()) all.push_back(std::bit_cast<std::uint64_t>(v));
    return all;
  }

  static Eigen::VectorXd input(double frequency) {
    return Eigen::VectorXd::LinSpaced(60, 0.0, 6.0).unaryExpr([=](double t) { return std::sin(frequency * t); });
  }
  FirstOrder model_{{input(1.0), input(2.5)}, 0.1};
  std::vector<RowMatrix> measured_;
  OutputErrorOptions options_;
  test::TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_.path() / "log";
};

TEST_F(LoggedModelTest, AnswersAsTheModelDoes) {
  const auto plain = bits(output_error(model_, measured_, options_));
  EXPECT_EQ(bits(output_error(logged(model_, nullptr), measured_, options_)), plain);
  numerics::ValueLog log(folder_);
  EXPECT_EQ(bits(output_error(logged(model_, &log), measured_, options_)), plain);
}

TEST_F(LoggedModelTest, ASearchCutOffAnywhereGoesOnToTheSameBits) {
  const CountingModel whole(model_);
  std::vector<std::uint64_t> expected;
  {
    numerics::ValueLog log(folder_);
    expected = bits(output_error(logged(whole, &log), measured_, options_));
  }
  ASSERT_GT(whole.count, 8);
  for (long cut = 0; cut < whole.count; ++cut) {
    std::filesystem::remove_all(folder_);
    {
      numerics::ValueLog log(folder_);
      const CountingModel dies(model_, cut);
      EXPECT_THROW((void)output_error(logged(dies, &log), measured_, options_), std::runtime_error);
    }
    numerics::ValueLog log(folder_);
    const CountingModel rest(model_);
    const LoggedModel again = logged(rest, &log);
    ASSERT_EQ(bits(output_error(again, measured_, options_)), expected) << cut;
    EXPECT_EQ(rest.count + cut, whole.count) << cut;
  }
}

TEST_F(LoggedModelTest, KeepsModelsOfOneLogApartAndRunsThatDidNotFinish) {
  model_.refuses_growth = true;
  numerics::ValueLog log(folder_);
  const LoggedModel trained = logged(model_, &log);
  const LoggedModel unseen(
      model_, "unseen", [](std::size_t, const RowMatrix&) { return 0.0; }, &log);
  ModelResponse response;
  const Eigen::Vector3d theta(1.0, 0.5, 0.0), growing(-1.0, 0.5, 0.0);
  EXPECT_TRUE(trained.respond(0, theta, {}, response));
  EXPECT_FALSE(trained.respond(0, growing, {}, response));
  EXPECT_FALSE(trained.respond(0, growing, {}, response));
  EXPECT_EQ(trained.resumed(), 1U);
  EXPECT_TRUE(unseen.respond(0, theta, {}, response));
  EXPECT_EQ(unseen.resumed(), 0U);
}

TEST_F(LoggedModelTest, NotesWhatWasAskedOfIt) {
  const LoggedModel model = logged(model_, nullptr);
  ModelResponse response;
  const std::vector<Eigen::Index> active = {0};
  const Eigen::Vector3d theta(1.0, 0.5, 0.0);
  ASSERT_TRUE(model.respond(1, theta, {}, response));
  const double misfit = (measured_[1] - response.output).norm();
  ASSERT_TRUE(model.respond(0, theta, {}, response));
  ASSERT_TRUE(model.respond(0, theta, active, response));
  const std::vector<ModelEvaluation> all = model.evaluations();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_FALSE(all[0].derivatives);
  EXPECT_EQ(all[0].misfit[1], misfit);
  EXPECT_GT(all[0].seconds, 0.0);
  EXPECT_EQ(all[0].theta, Eigen::Vector2d(1.0, 0.5));
  EXPECT_TRUE(all[1].derivatives);
  EXPECT_NE(all[1].misfit[1], all[1].misfit[1]);
}

}  // namespace
}  // namespace veridyn::estimation
