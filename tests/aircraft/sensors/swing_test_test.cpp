#include "veridyn/aircraft/sensors/swing_test.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <map>

#include "tests/support/folders.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

Recording quaternions(double amplitude, double w, double wobble = 0.0) {
  std::vector<double> t, x, y, z, s;
  for (int i = 0; i < 1000; ++i) {
    const double time = 0.04 * i, angle = amplitude * std::cos(w * time);
    // About an axis that is none of the sensor's, on top of a constant attitude.
    const Eigen::Quaterniond q = Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, -1).normalized())) *
                                 Eigen::AngleAxisd(angle, Eigen::Vector3d(0.6, 0.8, 0.0)) *
                                 Eigen::AngleAxisd(wobble * std::sin(3.0 * time), Eigen::Vector3d(0, 0, 1));
    const double sign = i % 2 == 0 ? 1.0 : -1.0;  // q and -q are the same attitude
    t.push_back(time);
    x.push_back(sign * q.x());
    y.push_back(sign * q.y());
    z.push_back(sign * q.z());
    s.push_back(sign * q.w());
  }
  Recording r;
  r.source = "made";
  const TimeBase time = make_time_base(t);
  r.add(make_channel("qx", "1", time, x));
  r.add(make_channel("qy", "1", time, y));
  r.add(make_channel("qz", "1", time, z));
  r.add(make_channel("qw", "1", time, s));
  return r;
}

TEST(SwingAngle, IsTheTurnAboutTheMainAxisWhateverTheSensorsFrame) {
  const SwingAngle swing = swing_angle(quaternions(0.3, 2.0), "");
  EXPECT_GT(swing.principal_share, 1.0 - 1e-9);
  const double sign = swing.angle[0] > 0.0 ? 1.0 : -1.0;
  const double mean = sign * swing.angle[0] - 0.3;  // the mean attitude is that of the record, not of rest
  for (std::size_t i = 0; i < 1000; ++i) {
    ASSERT_NEAR(sign * swing.angle[i], 0.3 * std::cos(0.08 * static_cast<double>(i)) + mean, 1e-9);
  }
  EXPECT_LT(swing_angle(quaternions(0.3, 2.0, 0.2), "").principal_share, 0.85);
}

TEST(SwingTest, IsTheTextbooksPendulumAndBifilarSuspension) {
  // A slender rod of length l swinging about its end: w^2 = 3 g/(2 l), I = m l^2/12 about its middle.
  SwingTest test;
  test.mass = 2.0;
  SwingAxis pendulum;
  pendulum.suspension = Suspension::kPendulum;
  pendulum.length = 0.5;
  EXPECT_NEAR(swing_terms(test, pendulum, std::sqrt(1.5 * test.gravity), 1.0).inertia(), 2.0 / 12.0, 1e-12);
  // The same rod on two lines at its ends, h long: w^2 = m g d^2/(4 I h) = 3 g/h.
  SwingAxis bifilar;
  bifilar.filar_distance = 1.0;
  bifilar.length = 0.7;
  EXPECT_NEAR(swing_terms(test, bifilar, std::sqrt(3.0 * test.gravity / 0.7), 1.0).inertia(), 2.0 / 12.0, 1e-12);
}

// Frequencies, geometry and results as computed elsewhere (README of the recordings, with numpy).
SwingTest skywalker() {
  SwingTest test;
  test.mass = 2.470;
  test.cradle_mass = 1.042;
  test.axes = {
      {.axis = 'x', .suspension = Suspension::kBifilar, .filar_distance = 0.49, .length = 1.145, .cradle_length = 1.44},
      {.axis = 'y', .suspension = Suspension::kPendulum, .length = 1.86, .cradle_length = 1.79, .offset = 0.0275},
      {.axis = 'z', .suspension = Suspension::kBifilar, .filar_distance = 0.49, .length = 1.91, .cradle_length = 1.44}};
  return test;
}

TEST(SwingTest, GivesThePublishedInertiaFromThePublishedFrequencies) {
  const SwingTest test = skywalker();
  const auto I = [&](std::size_t axis, double w, double wc) {
    return swing_terms(test, test.axes[axis], w, wc).inertia();
  };
  // 0.0005 and 0.0001 are half the last digit that the mean frequencies determine.
  EXPECT_NEAR(I(0, (3.402 + 3.370 + 3.378) / 3, (2.914 + 2.907) / 2), 0.1075, 0.0002);
  EXPECT_NEAR(I(2, (1.828 + 1.834 + 1.835) / 3, (2.568 + 2.570) / 2), 0.258, 0.0005);
  // Iy hangs on the last digit of its frequencies: half a unit of it, 0.0005 rad/s, is 0.006 kg m^2.
  EXPECT_NEAR(I(1, (2.256 + 2.253) / 2, (2.304 + 2.303) / 2), 0.358, 0.006);
  EXPECT_NEAR(I(1, 1.005 * 2.2545, 2.3035) - I(1, 2.2545, 2.3035), -0.12, 0.006);
}

fs::path real_study() { return test::source_folder() / "examples/studies/real/skywalker_swing.toml"; }

TEST(SwingTest, DeterminesXAndZOfTheRealSkywalkerAndNotY) {
  const fs::path data = test::shared_folder() / "data/flight/skywalker_stanford/pendulum";
  if (!fs::exists(data)) GTEST_SKIP() << "needs the recordings in " << data;
  const Study study = Study::load(real_study());
  SwingTest test = SwingTest::keys().read(study.root().table("swing_test"));
  test.draws = 20000;
  for (SwingAxis& axis : test.axes) {
    for (auto* files : {&axis.files, &axis.cradle_files}) {
      for (fs::path& file : *files) file = data / file.filename();
    }
  }
  Progress silent;
  const SwingTestResult result = analyse_swing_test(test, silent);
  // Undamped frequencies of another program's fit. Which part of a record is fitted differs, and the frequency falls
  // with the amplitude (about 1 % from 24 deg to none): 0.7 % about x, 0.3 % otherwise.
  const std::map<std::string, double> published{
      {"aircraft_xaxis_1.csv", 3.402}, {"aircraft_xaxis_2.csv", 3.370}, {"aircraft_xaxis_3.csv", 3.378},
      {"aircraft_yaxis_1.csv", 2.256}, {"aircraft_yaxis_2.csv", 2.253}, {"aircraft_zaxis_1.csv", 1.828},
      {"aircraft_zaxis_2.csv", 1.834}, {"aircraft_zaxis_3.csv", 1.835}, {"cradle_xaxis_1.csv", 2.914},
      {"cradle_xaxis_2.csv", 2.907},   {"cradle_yaxis_1.csv", 2.304},   {"cradle_yaxis_2.csv", 2.303},
      {"cradle_zaxis_1.csv", 2.568},   {"cradle_zaxis_2.csv", 2.570}};
  for (const AxisInertia& i : result.axes) {
    for (const SwingRun& run : i.runs) {
      ASSERT_TRUE(run.fit.usable()) << run.file;
      const double w = published.at(run.file);
      EXPECT_NEAR(run.fit.undamped_frequency(), w, (i.test.axis == 'x' ? 0.007 : 0.003) * w) << run.file;
    }
  }
  const AxisInertia &x = *result.find('x'), &y = *result.find('y'), &z = *result.find('z');
  EXPECT_EQ(x.verdict, InertiaVerdict::kDetermined);
  EXPECT_EQ(z.verdict, InertiaVerdict::kDetermined);
  EXPECT_NEAR(x.value, 0.1075, x.sigma());
  EXPECT_NEAR(z.value, 0.258, z.sigma());
  EXPECT_NEAR(y.value, 0.358, y.sigma());
  // Published deviations, of geometry and masses alone: 0.001, 0.050, 0.002.
  const auto by_hand = [](const AxisInertia& i) { return std::hypot(i.by_mass, i.by_filar_distance, i.by_length); };
  EXPECT_NEAR(by_hand(x), 0.001, 0.0005);
  EXPECT_NEAR(by_hand(y), 0.050, 0.0015);
  EXPECT_NEAR(by_hand(z), 0.002, 0.0005);
  EXPECT_EQ(y.verdict, InertiaVerdict::kNotDetermined);
  EXPECT_THAT(y.reason, HasSubstr("Iy is not determined by this test"));
  EXPECT_EQ(result.estimate.verdict, "determined: Jx, Jz; not determined: Jy");
}

TEST(SwingTest, FindsTheInertiaOfTheExampleWithItsMadeRecordings) {
  const Study study = Study::load(test::source_folder() / "examples/studies/swing_test/study.toml");
  SwingTest test = SwingTest::keys().read(study.root().table("swing_test"));
  Progress silent;
  const SwingTestResult result = analyse_swing_test(test, silent);
  const std::map<char, double> truth{{'x', 0.12}, {'y', 0.16}, {'z', 0.26}};
  for (const AxisInertia& i : result.axes) {
    EXPECT_EQ(i.verdict, InertiaVerdict::kDetermined) << i.reason;
    EXPECT_NEAR(i.value, truth.at(i.test.axis), 2.0 * i.sigma());
    // Monte Carlo against the linear law, whose inputs are all below a percent.
    EXPECT_NEAR(i.sigma(), std::hypot(std::hypot(i.by_mass, i.by_filar_distance, i.by_length), i.by_frequency),
                0.03 * i.sigma());
    // Two seconds of stillness in the hand are not part of the swing; it begins at an excursion of its first cycle.
    for (const SwingRun& run : i.runs) {
      const double cycle = 2.0 * M_PI / run.fit.damped_frequency;
      EXPECT_GE(run.swing.time[run.begin], 1.9);
      EXPECT_LE(run.swing.time[run.begin], 2.1 + cycle);
    }
  }
  EXPECT_GT(result.covariance(0, 2), 0.0);
  // What it writes a subject can read.
  const Study written =
      Study::parse(inertia_toml(test, result) + "wing_area = 1\nspan = 1\nchord = 1\n", "subject.toml");
  const Subject subject = read_subject(written.root().table("subject"));
  EXPECT_NEAR(subject.inertia->Jz, result.find('z')->value, 1e-6);
  EXPECT_NEAR(subject.sigma.Jy, result.find('y')->sigma(), 1e-5);
}

TEST(SwingTest, RefusesWhatItCannotUse) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      const Study study = Study::parse(text, "s.toml");
      static_cast<void>(SwingTest::keys().read(study.root().table("swing_test")));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(message("[swing_test]\nmass = 2\n"), HasSubstr("has none of the tables x, y, z"));
  EXPECT_THAT(message("[swing_test]\nmass = -2\n"), HasSubstr("must be > 0"));
  EXPECT_THAT(message("[swing_test]\nmass = 2\n[swing_test.x]\nfilar_distance = 1\nlength = 1\nfiles = []\n"),
              HasSubstr("files: is empty"));
  EXPECT_THAT(message("[swing_test]\nmass = 2\n[swing_test.x]\nfilar_distance = 1\nlength = 1\nfiles = [\"a\"]\n"
                      "cradle_files = [\"b\"]\n"),
              HasSubstr("cradle_mass is 0"));
  Recording empty;
  empty.source = "e.csv";
  EXPECT_THROW(static_cast<void>(swing_angle(empty, "")), InputError);
}

}  // namespace
}  // namespace veridyn::aircraft
