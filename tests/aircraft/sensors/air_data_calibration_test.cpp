#include "veridyn/aircraft/sensors/air_data_calibration.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Calibration : public ::testing::Test {
 protected:
  fs::path file(const std::string& name, const std::string& content) const {
    write_file(folder_ / name, content);
    return folder_ / name;
  }

  struct Vane {
    double noise = 0.1, reference_noise = 0.0, bend = 0.0, hysteresis = 0.0, range = 15.0;
    int sweeps = 4;
    std::uint64_t seed = 1;
  };
  /// Sweeps up and down of an alpha vane: raw = -0.5 deg + 1.2 alpha.
  CalibrationResult vane(const Vane& v, double sigma_reference = 0.0) const {
    numerics::RandomStream random(v.seed, "tunnel");
    std::string text = "alpha_ref[deg],alpha_raw[deg]\n";
    for (int sweep = 0; sweep < v.sweeps; ++sweep) {
      for (int i = -15; i <= 15; ++i) {
        const double a = v.range / 15.0 * (sweep % 2 == 0 ? i : -i);
        const double lag = sweep % 2 == 0 ? 0.5 * v.hysteresis : -0.5 * v.hysteresis;
        text += fmt::format("{},{}\n", a + v.reference_noise * random.normal(),
                            -0.5 + 1.2 * a + v.bend * a * a + lag + v.noise * random.normal());
      }
    }
    CalibrationStudy study;
    study.file = file("vane.csv", text);
    CalibrationInput in;
    in.channel = "alpha";
    in.raw = "alpha_raw";
    in.reference = "alpha_ref";
    in.sigma_reference = sigma_reference * M_PI / 180.0;
    in.sigma_raw = sigma_reference > 0.0 ? v.noise * M_PI / 180.0 : 0.0;
    study.sensors = {in};
    return calibrate(study);
  }

  test::TemporaryFolder temporary_;
  const fs::path& folder_ = temporary_.path();
};

TEST_F(Calibration, FindsScaleAndBiasWithIntervalsThatHold) {
  int covered = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const CalibrationResult r = vane({.seed = seed});
    const auto& p = r.estimate.parameters;
    if (p[0].low95 <= 1.2 && 1.2 <= p[0].high95) ++covered;
    if (p[1].low95 <= -0.5 * M_PI / 180 && -0.5 * M_PI / 180 <= p[1].high95) ++covered;
  }
  // 200 intervals of 95 %: 190 +- 3.1; 4 standard deviations. Coverage must fail both ways.
  EXPECT_GE(covered, 177);
  EXPECT_LT(covered, 200);
  const CalibrationResult r = vane({});
  EXPECT_TRUE(r.sensors[0].findings.empty()) << r.sensors[0].findings.front();
  EXPECT_EQ(r.estimate.verdict, "calibrated: alpha");
  // The residual is the noise, as an angle of the true quantity.
  EXPECT_NEAR(r.sensors[0].rms, 0.1 / 1.2 * M_PI / 180, 0.15 * r.sensors[0].rms);
}

TEST_F(Calibration, IsNotBiasedByErrorsOfTheReference) {
  // Reference noise of 4 deg over +-15 deg (rms 9): least squares loses a factor 1 + 16/80 of the slope.
  double ols = 0.0, gtls = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Vane v{.noise = 1.0, .reference_noise = 4.0, .seed = seed};
    ols += vane(v).sensors[0].calibration.scale / 10.0;
    gtls += vane(v, 4.0).sensors[0].calibration.scale / 10.0;
  }
  EXPECT_NEAR(ols, 1.2 / 1.2, 0.04);
  // Standard error of one slope is about 4.9/(9 sqrt(124)) = 0.05, of the mean of ten 0.016; three of them.
  EXPECT_NEAR(gtls, 1.2, 0.048);
}

TEST_F(Calibration, SaysWhatAStraightLineDoesNotShow) {
  const SensorFit bent = vane({.bend = 0.005}).sensors[0];
  ASSERT_FALSE(bent.findings.empty());
  EXPECT_THAT(bent.findings.front(), HasSubstr("a quadratic term is significant"));
  EXPECT_NEAR(bent.quadratic, 0.005 * 180.0 / M_PI, 0.05 * bent.quadratic);  // 1/deg to 1/rad
  const SensorFit sticky = vane({.hysteresis = 0.2}).sensors[0];
  EXPECT_NEAR(sticky.hysteresis, 0.2 / 1.2 * M_PI / 180, 4 * sticky.hysteresis_sigma);
  EXPECT_THAT(sticky.findings.front(), HasSubstr("hysteresis: rising reads"));
}

TEST_F(Calibration, KeepsTheScaleWhereThePointsDoNotDetermineIt) {
  const SensorFit narrow = vane({.range = 0.1}).sensors[0];
  EXPECT_EQ(narrow.calibration.scale, 1.0);
  EXPECT_THAT(narrow.findings.front(), HasSubstr("changes too little to tell a scale"));
}

TEST_F(Calibration, TakesDynamicPressureFromSpeedAndDensity) {
  const fs::path points = file("q.csv",
                               "V[m/s],p[hPa],T[degC],dp[Pa]\n10,1000,20,59.42\n20,1000,20,237.68\n15,1000,20,"
                               "133.70\n25,1000,20,371.38\n12,1000,20,85.57\n22,1000,20,287.6\n");
  const Study study = Study::parse("[calibration]\nfile = \"" + points.string() +
                                       "\"\n[calibration.dynamic_pressure]\nraw = \"dp\"\nreference_speed = \"V\"\n"
                                       "static_pressure = \"p\"\nair_temperature = \"T\"\n",
                                   "s.toml");
  const SensorFit fit = calibrate(CalibrationStudy::keys().read(study.root().table("calibration"))).sensors[0];
  // rho = 1e5/(287.05287 * 293.15) = 1.18836; at 20 m/s 237.67 Pa.
  EXPECT_NEAR(fit.reference[1], 237.672, 0.001);
  EXPECT_NEAR(fit.calibration.scale, 1.0, 1e-3);
}

TEST_F(Calibration, IsWrittenReadAndAppliedToARecording) {
  const SensorCalibration c = vane({}).sensors[0].calibration;
  const fs::path path = file("calibration.toml", calibration_toml({c}, "vane.csv"));
  const SensorCalibration read = read_calibration(path).at(0);
  EXPECT_EQ(read.scale, c.scale);
  EXPECT_EQ(read.bias, c.bias);
  EXPECT_EQ(read.covariance, c.covariance);
  MappedRecording mapped;
  const std::vector<double> truth{-0.1, 0.0, 0.1};
  std::vector<double> raw;
  for (const double a : truth) raw.push_back(c.bias + c.scale * a);
  mapped.recording.add(make_channel("alpha", "rad", make_time_base({0, 1, 2}), raw));
  mapped.origins.push_back({"alpha", "vane", 1.0, ""});
  apply_calibration({read}, mapped);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(mapped.recording.at("alpha").value[i], truth[i], 1e-15);
  EXPECT_THAT(mapped.origins[0].note, HasSubstr("calibrated"));
  ASSERT_EQ(mapped.calibration_sigma.size(), 1U);
  EXPECT_NEAR(mapped.calibration_sigma[0].second, 0.1 / 1.2 * M_PI / 180, 0.2 * mapped.calibration_sigma[0].second);
  EXPECT_TRUE(mapped.notes.empty());
  // Outside its range, and without the channel: said.
  mapped.recording.set(make_channel("alpha", "rad", make_time_base({0, 1, 2}), {1.0, 1.0, 0.0}));
  apply_calibration({read}, mapped);
  EXPECT_THAT(mapped.notes.back(), HasSubstr("67 % of the samples lie outside the range"));
  MappedRecording empty;
  apply_calibration({read}, empty);
  EXPECT_THAT(empty.notes.back(), HasSubstr("the log has no such channel"));
}

// d corrected by scale and bias, against a Monte Carlo of both.
TEST_F(Calibration, PropagatesItsCovarianceToTheCorrectedReading) {
  SensorCalibration c{.channel = "alpha", .scale = 1.2, .bias = -0.01};
  c.covariance << 4e-4, -1e-5, -1e-5, 1e-6;
  numerics::RandomStream random(3, "c");
  double sum = 0.0, squares = 0.0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    const double u = random.normal(), v = random.normal();
    SensorCalibration d = c;
    d.scale += 0.02 * u;
    d.bias += -5e-4 * u + std::sqrt(1e-6 - 2.5e-7) * v;
    const double x = d.corrected(0.3);
    sum += x / kDraws;
    squares += x * x / kDraws;
  }
  EXPECT_NEAR(c.sigma(0.3, false), std::sqrt(squares - sum * sum), 0.02 * c.sigma(0.3, false));
}

TEST_F(Calibration, RefusesBadFilesInOneLine) {
  const auto message = [](const auto& action) -> std::string {
    try {
      action();
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const auto read = [&](const std::string& text) {
    const fs::path path = file("c.toml", text);
    return message([&] { static_cast<void>(read_calibration(path)); });
  };
  EXPECT_THAT(read("[alpa]\nscale = 1\nbias = 0\n"), HasSubstr("did you mean 'alpha'"));
  EXPECT_THAT(read("[alpha]\nscale = 0\nbias = 0\n"), HasSubstr("must not be 0"));
  EXPECT_THAT(read("[alpha]\nscale = 1\nbias = 0\ncovariance = [1, 2, 2, 1]\n"), HasSubstr("covariance matrix"));
  EXPECT_THAT(read(""), HasSubstr("holds no calibration"));
  const auto fit = [&](const std::string& csv, const std::string& keys) {
    const fs::path path = file("t.csv", csv);
    return message([&] {
      const Study study =
          Study::parse("[calibration]\nfile = \"" + path.string() + "\"\n[calibration.alpha]\n" + keys, "s");
      static_cast<void>(calibrate(CalibrationStudy::keys().read(study.root().table("calibration"))));
    });
  };
  const std::string keys = "raw = \"r\"\nreference = \"a\"\n";
  EXPECT_THAT(fit("a[deg],x[deg]\n1,2\n", keys), HasSubstr("has no column 'r'"));
  EXPECT_THAT(fit("a[m],r[deg]\n1,2\n2,3\n3,4\n4,5\n", keys), HasSubstr("column 'a' is in [m], expected [rad]"));
  EXPECT_THAT(fit("a[deg],r[deg]\n1,2\n2,3\n", keys), HasSubstr("holds 2 points of alpha, 4 are needed"));
  EXPECT_THAT(fit("a[deg],r[deg]\n1,2\n1,3\n1,4\n1,5\n", keys), HasSubstr("the reference of alpha never changes"));
  EXPECT_THAT(fit("a[deg],r[deg]\n1,2\n2,x\n", keys), HasSubstr("t.csv:3: column 'r': 'x' is not a number"));
  EXPECT_THAT(fit("a[deg],r[deg]\n1,2,3\n", keys), HasSubstr("t.csv:2: has 3 cells, the header 2"));
  EXPECT_THAT(fit("a[deg],a[deg]\n1,2\n", keys), HasSubstr("appears twice"));
  EXPECT_THAT(fit("", keys), HasSubstr("holds no rows"));
  EXPECT_THAT(fit("a[deg],r[deg]\n1,2\n2,3\n3,4\n4,5\n", keys + "sigma_reference = 0.1\n"),
              HasSubstr("needs sigma_raw"));
}

}  // namespace
}  // namespace veridyn::aircraft
