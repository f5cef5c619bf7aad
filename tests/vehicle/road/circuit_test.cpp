#include "veridyn/vehicle/road/circuit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle {
namespace {

TEST(Circuit, FindsItsMiddleLine) {
  const Circuit circuit;
  EXPECT_NEAR(circuit.length(), 24.0 + 6.0 * kPi, 1e-12);
  for (double s = 0.05; s < circuit.length(); s += 0.37) {
    const Eigen::Vector2d place = circuit.middle(s);
    const Circuit::Located on = circuit.locate(place);
    EXPECT_NEAR(on.distance, s, 1e-9);
    EXPECT_NEAR(on.offset, 0.0, 1e-9);
    EXPECT_LT((on.along - (circuit.middle(s + 1e-6) - place) / 1e-6).norm(), 1e-5) << s;
    const Eigen::Vector2d left(-on.along.y(), on.along.x());
    EXPECT_NEAR(circuit.locate(place + 0.3 * left).offset, 0.3, 1e-9) << s;
  }
}

TEST(Circuit, HasTheSlopesOfItsHeights) {
  const Circuit circuit;
  double steepest = 0.0;
  for (double x = -4.5; x < 17.0; x += 0.171) {
    for (double y = -1.4; y < 7.5; y += 0.193) {
      const Eigen::Vector2d at(x, y);
      const Eigen::Vector2d slope = circuit.at(at).slope;
      steepest = std::max(steepest, slope.norm());
      constexpr double h = 1e-5;
      const auto height = [&](double dx, double dy) { return circuit.at(at + Eigen::Vector2d(dx, dy)).height; };
      EXPECT_NEAR(slope.x(), (height(h, 0) - height(-h, 0)) / (2 * h), 1e-6) << x << ' ' << y;
      EXPECT_NEAR(slope.y(), (height(0, h) - height(0, -h)) / (2 * h), 1e-6) << x << ' ' << y;
    }
  }
  EXPECT_GT(steepest, 0.5);
}

TEST(Circuit, HasRampsAndBanksOfTheirAngles) {
  const Circuit circuit;
  for (const CircuitOptions::Ramp& ramp : circuit.options().ramps) {
    const double on_it = ramp.at + ramp.blend + 0.5 * ramp.even();
    EXPECT_NEAR(std::atan(circuit.at(circuit.middle(on_it)).slope.norm()), ramp.angle, 1e-12);
    EXPECT_NEAR(circuit.at(circuit.middle(ramp.at + 0.5 * ramp.length())).height, ramp.height, 1e-12);
    EXPECT_NEAR(circuit.at(circuit.middle(ramp.at + ramp.length())).height, 0.0, 1e-12);
  }
  const double quarter = 1.5 * kPi;
  const std::vector<double> begins = {12.0, 12.0 + quarter, 24.0 + 2.0 * quarter, 24.0 + 3.0 * quarter};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d middle = circuit.middle(begins[i] + 0.5 * quarter);
    const Circuit::Located on = circuit.locate(middle);
    const Circuit::Point point = circuit.at(middle);
    EXPECT_NEAR(std::atan(point.slope.norm()), circuit.options().banks[i], 1e-12);
    // The outer edge, on the right of a curve to the left, is up.
    EXPECT_LE(point.slope.dot(Eigen::Vector2d(-on.along.y(), on.along.x())), 0.0);
  }
}

TEST(Circuit, HasBumpsAndRoughnessWhereItSays) {
  const Circuit circuit;
  EXPECT_NEAR(circuit.relief({7.6, 0.1}), 0.005, 1e-12);
  EXPECT_EQ(circuit.relief({7.75, 0.1}), 0.0);
  const auto rms = [&](double from, double to) {
    double sum = 0.0;
    int count = 0;
    for (double s = from; s < to; s += 0.01, ++count) sum += std::pow(circuit.relief(circuit.middle(s)), 2);
    return std::sqrt(sum / count);
  };
  EXPECT_EQ(rms(2.0, 7.0), 0.0);
  EXPECT_GT(rms(29.0, 31.5), 2.0 * rms(13.0, 20.0));
  EXPECT_GT(rms(13.0, 20.0), 0.0);
}

TEST(Circuit, ReadsFromAStudyAndRefusesWhatCannotBe) {
  const auto read = [](const std::string& text) {
    const Study study = Study::parse(text, "c.toml");
    return read_circuit(study.root(), 3);
  };
  EXPECT_EQ(read("")->options().ramps.size(), 2U);
  EXPECT_TRUE(read("flat = true")->options().ramps.empty());
  const auto one = read("straight = '20 m'\n[[ramp]]\nat = 2\nangle = '10 deg'\nheight = '0.5 m'\n");
  ASSERT_EQ(one->options().ramps.size(), 1U);
  EXPECT_NEAR(one->options().ramps[0].angle, 10.0 * kDegree, 1e-12);
  EXPECT_EQ(one->options().bumps.size(), 3U);
  EXPECT_NE(why([&] { static_cast<void>(read("radius = 1")); }).find("more than 1.5 widths"), std::string::npos);
  EXPECT_NE(why([&] { static_cast<void>(read("banks = [0, 0]")); }).find("four quarters"), std::string::npos);
  EXPECT_NE(
      why([&] { static_cast<void>(read("[[ramp]]\nat = 9\nangle = '7 deg'\nheight = 0.2\n")); }).find("same straight"),
      std::string::npos);
  EXPECT_NE(why([&] {
              static_cast<void>(read("[[ramp]]\nat = 1\nangle = '30 deg'\nheight = 0.1\n"));
            }).find("blend times the slope"),
            std::string::npos);
  EXPECT_NE(why([&] { static_cast<void>(read("[[ramp]]\nat = 1\nangle = '80 deg'\nheight = 0.1\n")); }).find("45 deg"),
            std::string::npos);
}

}  // namespace
}  // namespace veridyn::vehicle
