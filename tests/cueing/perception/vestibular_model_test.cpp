#include "veridyn/cueing/perception/vestibular_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/folders.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_systems/discretisation.hpp"

namespace veridyn::cueing {
namespace {

using numerics::TransferFunction;

/// Of a unit step, at time t.
double step_response(const TransferFunction& transfer, double t) {
  const numerics::StateSpace s = numerics::realise(transfer);
  const numerics::HeldSystem h = numerics::held(s, t, numerics::Hold::kZeroOrder);
  return (s.C * h.Gamma + s.D)(0, 0);
}

/// Of a unit impulse, without feedthrough.
double impulse_response(const TransferFunction& transfer, double t) {
  const numerics::StateSpace s = numerics::realise(transfer);
  return (s.C * numerics::held(s, t, numerics::Hold::kZeroOrder).Phi * s.B)(0, 0);
}

/// Sum of residues: step response of c s^m / prod(1 + T_i s), T_i all different.
double by_residues(double c, int m, const std::vector<double>& T, double t) {
  double sum = m == 0 ? c : 0.0;
  for (std::size_t i = 0; i < T.size(); ++i) {
    const double s = -1.0 / T[i];
    double term = c * std::pow(s, m) / (s * T[i]);
    for (std::size_t j = 0; j < T.size(); ++j)
      if (j != i) term /= 1.0 + T[j] * s;
    sum += term * std::exp(s * t);
  }
  return sum;
}

TEST(VestibularModel, StepResponsesAreSumsOfResidues) {
  const VestibularModel& m = vestibular_model("young_meiry");
  for (const double t : {0.0, 0.1, 1.0, 7.0, 30.0}) {
    EXPECT_NEAR(step_response(m.canals[0], t), by_residues(6.1 * 30.0, 2, {6.1, 0.1, 30.0}, t), 1e-12) << t;
    EXPECT_NEAR(step_response(m.canals[2], t), by_residues(10.2 * 30.0, 2, {10.2, 0.1, 30.0}, t), 1e-12) << t;
    EXPECT_NEAR(step_response(m.otoliths, t),
                by_residues(0.4, 0, {5.33, 0.66}, t) + by_residues(0.4 * 13.2, 1, {5.33, 0.66}, t), 1e-12)
        << t;
  }
}

TEST(VestibularModel, SteadyRotationIsNotFeltAndSteadyForceIs) {
  for (const VestibularModel& m : vestibular_models()) {
    for (const TransferFunction& canal : m.canals) EXPECT_EQ(canal.response(0.0).real(), 0.0) << m.name;
    EXPECT_GT(m.otoliths.response(0.0).real(), 0.0) << m.name;
    EXPECT_FALSE(m.source.empty());
  }
}

TEST(VestibularModel, FoundByNameOnly) {
  EXPECT_EQ(vestibular_model("hosman").name, "hosman");
  try {
    (void)vestibular_model("hosmann");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("did you mean 'hosman'?"));
  }
  EXPECT_THROW((void)torsion_pendulum(0.0), InputError);
}

TEST(MotionThresholds, AreThoseOfTheirSources) {
  EXPECT_NEAR(usual_thresholds().rate[2], 1.6 * kPi / 180.0, 1e-15);
  EXPECT_NEAR(reid_nahon_thresholds().rate[1], 3.6 * kPi / 180.0, 1e-15);
  EXPECT_EQ(usual_thresholds().force[2], 0.28);
}

class CueingReference : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path file = test::shared_folder() / "reference" / "cueing_reference.json";
    if (!std::filesystem::exists(file))
      GTEST_SKIP() << "no " << file << "; StepResponsesAreSumsOfResidues is without it";
    reference_ = nlohmann::json::parse(std::ifstream(file));
  }
  nlohmann::json reference_;
};

TEST_F(CueingReference, VestibularStepsAndResponses) {
  const VestibularModel &meiry = vestibular_model("young_meiry"), &telban = vestibular_model("telban_cardullo");
  const std::map<std::string, TransferFunction> models = {
      {"scc_roll_TL6.1_Ts0.1_Ta30", meiry.canals[0]},
      {"scc_pitch_TL5.3_Ts0.1_Ta30", meiry.canals[1]},
      {"scc_yaw_TL10.2_Ts0.1_Ta30", meiry.canals[2]},
      {"scc_telban_cardullo_5.73*80s^2/((1+80s)(1+5.73s))", telban.canals[0]},
      {"scc_telban_full_with_(1+0.06s)/(1+0.005s)", vestibular_model("telban_cardullo_lead").canals[0]},
      {"otolith_young_meiry_0.4(13.2s+1)/((5.33s+1)(0.66s+1))", meiry.otoliths},
      {"otolith_telban_cardullo_0.4(10s+1)/((5s+1)(0.016s+1))", telban.otoliths},
      {"otolith_hosman_(1+s)/((1+0.5s)(1+0.016s))", vestibular_model("hosman").otoliths}};
  ASSERT_EQ(reference_["vestibular"].size(), models.size());
  const auto frequencies = reference_["omct_frequencies_rad_s"].get<std::vector<double>>();
  for (const auto& [name, expected] : reference_["vestibular"].items()) {
    const TransferFunction& t = models.at(name);
    const auto times = expected["t"].get<std::vector<double>>();
    for (std::size_t i = 0; i < times.size(); ++i)
      EXPECT_NEAR(step_response(t, times[i]), expected["step"][i].get<double>(), 1e-9) << name << times[i];
    // Printed with nine and six digits.
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
      const std::complex<double> response = t.response(frequencies[i]);
      EXPECT_NEAR(std::abs(response), expected["mag"][i].get<double>(), 1e-9) << name;
      EXPECT_NEAR(std::arg(response) / kDegree, expected["phase_deg"][i].get<double>(), 1e-6) << name;
    }
  }
}

TEST_F(CueingReference, OrmsbysImpulses) {
  const VestibularModel& m = vestibular_model("ormsby");
  const nlohmann::json& ormsby = reference_["ormsby"];
  for (int i = 0; i < 10; ++i) {
    const double force = ormsby["impulse_oto_t0..9s_without_feedthrough"][i].get<double>();
    const double rate = ormsby["impulse_scc_t0..9ms_without_feedthrough"][i].get<double>();
    EXPECT_NEAR(impulse_response(m.otoliths, i), force, 1e-7) << i;
    EXPECT_NEAR(impulse_response(m.canals[0], 1e-3 * i) / rate, 1.0, 1e-7) << i;
  }
  EXPECT_NEAR(m.otoliths.response(0.0).real() * 0.4, ormsby["steady_state_f_0.4_0.5_0.6"][0].get<double>(), 1e-5);
}

}  // namespace
}  // namespace veridyn::cueing
