#include "veridyn/muscle/muscle_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/muscle/muscle_run.hpp"

namespace veridyn::muscle {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

MuscleStudy read(const std::string& text, const std::filesystem::path& folder = {}) {
  const Study study = Study::parse(text, "s.toml", folder);
  Progress progress;
  return read_study(study, progress);
}

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(read(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::vector<double> excitations_at(const MuscleStudy& study, double time) {
  std::vector<double> u(study.drive.excitation.size());
  study.drive.excitation.evaluate(time, u.data());
  return u;
}

const std::string kArm = "[subject]\nmodel = \"arm\"\n";
const std::string kFollow = kArm + "[motion]\nmethod = \"computed muscle control\"\nduration = 0.3\n";

TEST(MuscleStudy, IsOneWhoseSubjectNamesAModel) {
  EXPECT_TRUE(is_muscle_study(Study::parse(kArm, "s.toml").root()));
  EXPECT_FALSE(is_muscle_study(Study::parse("[subject]\nbuiltin = \"thor\"\n", "s.toml").root()));
  // The model of an aircraft is a table.
  EXPECT_FALSE(is_muscle_study(Study::parse("[subject.model]\nCL = [\"1\"]\n", "s.toml").root()));
  EXPECT_FALSE(is_muscle_study(Study::parse("seed = 1\n", "s.toml").root()));
}

TEST(MuscleStudy, ReadsAForwardStudy) {
  const MuscleStudy study = read(kArm +
                                 "[[subject.load]]\nbody = \"forearm\"\nmass = \"2 kg\"\nlocation = [0, -0.3, 0]\n"
                                 "[subject.parameters]\n\"biceps_long.optimal_fiber_length\" = \"15 cm\"\n"
                                 "brachialis.max_isometric_force = 900\n"
                                 "[motion]\nbegin = 0.5\nduration = 2\nrate = 100\naccuracy = 1e-7\n"
                                 "[motion.start]\nelbow_flexion = \"30 deg\"\n"
                                 "[motion.start_speed]\nelbow_flexion = \"10 deg/s\"\n"
                                 "[motion.excitation]\ndefault = 0.1\nbrachialis = 0.2\n"
                                 "[[motion.excitation_step]]\ntime = 1\ndefault = 0.3\nbrachialis = 0.4\n"
                                 "[[motion.excitation_step]]\ntime = \"1500 ms\"\ntriceps_long = 0.5\n");
  EXPECT_EQ(study.method, MuscleMethod::kForward);
  EXPECT_EQ(study.begin, 0.5);
  EXPECT_EQ(study.end, 2.5);
  EXPECT_EQ(study.rate_Hz, 100.0);
  EXPECT_EQ(study.accuracy, 1e-7);
  EXPECT_DOUBLE_EQ(study.start.q(1), 30.0 * kDegree);
  EXPECT_DOUBLE_EQ(study.start.qdot(1), 10.0 * kDegree);
  EXPECT_THAT(excitations_at(study, 0.9), ElementsAre(0.1, 0.1, 0.1, 0.1, 0.1, 0.2));
  EXPECT_THAT(excitations_at(study, 1.0), ElementsAre(0.3, 0.3, 0.3, 0.3, 0.3, 0.4));
  EXPECT_THAT(excitations_at(study, 1.5), ElementsAre(0.5, 0.3, 0.3, 0.3, 0.3, 0.4));
  // The load is in the system's masses, not in what is written back; parameters are in both.
  const int forearm = study.written.body("forearm");
  EXPECT_DOUBLE_EQ(study.written.bodies[static_cast<std::size_t>(forearm)].mass, 1.5);
  EXPECT_DOUBLE_EQ(study.system->model().bodies[static_cast<std::size_t>(forearm)].mass, 3.5);
  for (const Model* model : {&study.written, &study.system->model()}) {
    const auto value = [&](const char* muscle) -> const MusculotendonParameters<double>& {
      return model->muscles[static_cast<std::size_t>(model->muscle(muscle))].parameters.musculotendon;
    };
    EXPECT_DOUBLE_EQ(value("biceps_long").optimal_fiber_length, 0.15);
    EXPECT_DOUBLE_EQ(value("brachialis").max_isometric_force, 900.0);
  }
  ASSERT_EQ(study.changes.size(), 2u);
  EXPECT_EQ(study.changes[0].muscle, "biceps_long");
}

TEST(MuscleStudy, RampsAreTheFunctionsTheySay) {
  const MuscleStudy study =
      read(kFollow +
           "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"90 deg\"\nto = \"20 deg\"\nstart = 0.03\n"
           "duration = 0.1\nshape = \"half sine\"\n"
           "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"110 deg\"\nstart = 0.2\nduration = 0.05\n"
           "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"100 deg\"\nduration = 0.05\nshape = \"linear\"\n");
  const auto at = [&](double t) { return study.motion.coordinate[1]->evaluate(t); };
  const double q1 = 90.0 * kDegree, q2 = 20.0 * kDegree, rate = std::numbers::pi / 0.1;
  EXPECT_DOUBLE_EQ(at(0.0).value, q1);
  EXPECT_EQ(at(0.02).slope, 0.0);
  for (const double t : {0.03, 0.05, 0.0817, 0.12}) {
    // The closed form; quintics through its values, slopes and curvatures 64 to a ramp leave (pi/64)^6/46080 of the
    // rise, 3e-13 rad, and of a second derivative 4e4 times rate^2 pieces^2 less exactly.
    const double angle = rate * (t - 0.03) - std::numbers::pi / 2.0;
    EXPECT_NEAR(at(t).value, (q2 - q1) / 2.0 * std::sin(angle) + (q1 + q2) / 2.0, 1e-12);
    EXPECT_NEAR(at(t).slope, (q2 - q1) / 2.0 * rate * std::cos(angle), 1e-8);
    EXPECT_NEAR(at(t).curvature, -(q2 - q1) / 2.0 * rate * rate * std::sin(angle), 1e-3);
  }
  EXPECT_DOUBLE_EQ(at(0.15).value, q2);
  EXPECT_EQ(at(0.15).curvature, 0.0);
  // Half-way through a minimum-jerk ramp: half the rise, 15/8 of the mean speed, no acceleration.
  EXPECT_NEAR(at(0.225).value, 65.0 * kDegree, 1e-13);
  EXPECT_NEAR(at(0.225).slope, 1.875 * 90.0 * kDegree / 0.05, 1e-10);
  EXPECT_NEAR(at(0.225).curvature, 0.0, 1e-8);
  EXPECT_NEAR(at(0.26).value, 108.0 * kDegree, 1e-13);
  EXPECT_NEAR(at(0.26).slope, -10.0 * kDegree / 0.05, 1e-12);
  EXPECT_NEAR(at(0.31).value, 100.0 * kDegree, 1e-13);
  // The other coordinate rests at its default.
  EXPECT_EQ(study.motion.coordinate[0]->evaluate(0.2).value, 0.0);
  EXPECT_THAT(study.wished, ElementsAre("elbow_flexion"));
}

TEST(MuscleStudy, ErrorsNameFileLineKeyAndTheNearestValidName) {
  const std::string ramp = "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"90 deg\"\nduration = 0.2\n";
  struct Case {
    std::string text, place, what;
  };
  const std::vector<Case> cases = {
      {"[subject]\nmodel = \"amr\"\n[motion]\n", "s.toml:2: subject.model", "did you mean 'arm'?"},
      {kArm, "motion", "is missing"},
      {kArm + "lcked = []\n[motion]\n", "s.toml:3: subject.lcked", "did you mean 'locked'?"},
      {kArm + "locked = [\"elbow\"]\n[motion]\n", "s.toml:3: subject.locked", "no coordinate 'elbow'"},
      {kArm + "locked = [\"elbow_flexion\", \"shoulder_flexion\"]\n[motion]\n", "s.toml:3: subject.locked",
       "no coordinate that could move"},
      {kArm + "paths = \"fit\"\n[motion]\n", "s.toml:3: subject.paths", "exact, fitted, opensim"},
      {kArm + "[subject.parameters]\n\"bicep_long.optimal_fiber_length\" = 0.1\n[motion]\n",
       "s.toml:4: subject.parameters.bicep_long.optimal_fiber_length", "did you mean 'biceps_long'?"},
      {kArm + "[subject.parameters]\n\"biceps_long.optimal_fibre_length\" = 0.1\n[motion]\n", "s.toml:4",
       "did you mean 'optimal_fiber_length'?"},
      {kArm + "[subject.parameters]\n\"biceps_long.optimal_fiber_length\" = 0\n[motion]\n", "s.toml:4", "must be > 0"},
      {kArm + "[subject.parameters]\n\"biceps_long.optimal_fiber_length\" = \"1 N\"\n[motion]\n", "s.toml:4",
       "expected a length [m]"},
      {kArm + "[[subject.load]]\nbody = \"hand\"\nmass = 1\n[motion]\n", "s.toml:4: subject.load[0].body",
       "no body of model 'arm'"},
      {kArm + "[[subject.load]]\nbody = \"forearm\"\nmass = nan\n[motion]\n", "s.toml:5", "finite"},
      {kArm + "[[subject.load]]\nbody = \"forearm\"\nmass = 1\nlocation = [1, 2]\n[motion]\n", "s.toml:6",
       "has 2 numbers"},
      {kArm + "[motion]\nmethod = \"cmc\"\n", "s.toml:4: motion.method", "computed muscle control"},
      {kArm + "[motion]\nduration = 0\n", "s.toml:4: motion.duration", "must be > 0"},
      {kArm + "[motion]\naccuracy = 1\n", "s.toml:4: motion.accuracy", "1e-13 to 0.1"},
      {kArm + "[motion.start]\nelbow = 1\n", "s.toml:4: motion.start.elbow", "no coordinate 'elbow'"},
      {kArm + "[motion.start]\nelbow_flexion = \"140 deg\"\n", "s.toml:4: motion.start.elbow_flexion",
       "is outside its range"},
      {kArm + "[motion.excitation]\nbrachialis = nan\n", "s.toml:4: motion.excitation.brachialis", "finite"},
      {kArm + "[motion.excitation]\nbrachialis = 1.2\n", "s.toml:4: motion.excitation.brachialis",
       "must be from 0 to 1"},
      {kArm + "[motion.excitation]\nbrachalis = 0.2\n", "s.toml:4: motion.excitation.brachalis",
       "did you mean 'brachialis'?"},
      {kArm + "[motion]\n[[motion.excitation_step]]\ntime = 0.2\nbrachialis = 0.1\n[[motion.excitation_step]]\n"
              "time = 0.1\n",
       "s.toml:8", "not after 0.2 s"},
      {kArm + "[motion]\nexcitation_file = \"nowhere.sto\"\n", "nowhere.sto", "no such file"},
      {kArm + "[motion]\nfile = \"x.mot\"\n", "s.toml:4: motion.file", "no use for"},
      {kFollow, "s.toml:3: motion", "needs a motion"},
      {kFollow + "interpolation = \"hold\"\n" + ramp, "s.toml:6: motion.interpolation", "has no meaning"},
      {kFollow + "[[motion.ramp]]\ncoordinate = \"elbow\"\nto = 1\nduration = 1\n",
       "s.toml:7: motion.ramp[0].coordinate", "no coordinate 'elbow'"},
      {kFollow + ramp + "shape = \"sine\"\n", "s.toml:10", "half sine"},
      {kFollow + ramp + "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"80 deg\"\nto = 1\nduration = 1\n",
       "s.toml:12", "jumps"},
      {kFollow + ramp + "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nstart = 0.1\nto = 1\nduration = 1\n",
       "s.toml:12", "before the end of the ramp before"},
      {kFollow + ramp + "[motion.control]\nwindow = 1\n", "s.toml:11: motion.control.window", "longer than the motion"},
      {kFollow + ramp + "[motion.control]\nmin_control = 1\n", "s.toml:11", "from 0 to below 1"},
      {kFollow + ramp + "[motion.static_optimization]\nexponent = 1\n", "s.toml:11", "above 1"},
      {"[subject]\nmodel = \"arm\"\nlocked = [\"elbow_flexion\"]\n[motion]\nmethod = \"computed muscle control\"\n" +
           ramp,
       "s.toml:7", "is locked and cannot follow"},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.text);
    EXPECT_THAT(error_of(c.text), AllOf(HasSubstr(c.place), HasSubstr(c.what)));
  }
}

TEST(MuscleStudy, InverseDynamicsOfRestIsWhatHoldsTheWeight) {
  const MuscleStudy study =
      read(kArm +
           "[[subject.load]]\nbody = \"forearm\"\nmass = 1\nlocation = [0, -0.3, 0]\n[motion]\n"
           "method = \"inverse dynamics\"\nduration = 0.1\n[[motion.ramp]]\n"
           "coordinate = \"elbow_flexion\"\nfrom = \"90 deg\"\nto = \"90 deg\"\nduration = 0.1\n");
  Progress progress;
  const MuscleResult result = run_study(study, progress);
  ASSERT_EQ(result.trajectory.time.size(), 21u);
  // The forearm is level: 1.5 kg at 0.17 m and 1 kg at 0.3 m from the elbow.
  EXPECT_NEAR(result.generalized_force(7, 1), (1.5 * 0.17 + 0.3) * 9.80665, 1e-12);
}

TEST(MuscleStudy, StaticOptimizationBalancesTheMotion) {
  const MuscleStudy study =
      read(kArm +
           "locked = [\"shoulder_flexion\"]\n[motion]\nmethod = \"static optimization\"\nduration = 0.5\n"
           "rate = 40\n[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"20 deg\"\nto = \"100 deg\"\n"
           "duration = 0.5\n");
  Progress progress;
  const MuscleResult result = run_study(study, progress);
  const MuscleTrajectory& t = result.trajectory;
  ASSERT_EQ(t.time.size(), 21u);
  EXPECT_TRUE(result.warnings.empty());
  // Moment arms by differences of the path lengths over the rows, forces times them: the moment that was required.
  const Eigen::Index i = 10;
  double moment = t.reserve(i, 1);
  for (Eigen::Index m = 0; m < t.tendon_force.cols(); ++m) {
    const double arm = -(t.path_length(i + 1, m) - t.path_length(i - 1, m)) / (t.q(i + 1, 1) - t.q(i - 1, 1));
    moment += t.tendon_force(i, m) * arm;
  }
  // Central differences over 0.1 rad of arms of 3 cm: a part in a few hundred.
  EXPECT_NEAR(moment, result.generalized_force(i, 1), 0.02 * std::abs(result.generalized_force(i, 1)));
  EXPECT_GE(t.activation.minCoeff(), 0.01 - 1e-9);
}

TEST(MuscleStudy, SaysWhenASimulationLeavesARange) {
  const MuscleStudy study = read(kArm +
                                 "locked = [\"shoulder_flexion\"]\n[motion]\nduration = 0.2\n[motion.start]\n"
                                 "elbow_flexion = \"120 deg\"\n[motion.start_speed]\nelbow_flexion = \"1000 deg/s\"\n");
  Progress progress;
  const MuscleResult result = run_study(study, progress);
  EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("'elbow_flexion' leaves its range 0 .. 130 deg at 0.0")));
}

class MuscleStudyFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("veridyn_muscle_study_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(MuscleStudyFiles, AForwardStudyReplaysWhatComputedMuscleControlFound) {
  const std::string load = "[[subject.load]]\nbody = \"forearm\"\nmass = 1\nlocation = [0, -0.3, 0]\n";
  const MuscleStudy wish = read(kArm + load +
                                "[motion]\nmethod = \"computed muscle control\"\nbegin = 0.1\nduration = 0.2\n"
                                "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"30 deg\"\nto = \"50 deg\"\n"
                                "duration = 0.2\n");
  Progress progress;
  const MuscleResult found = run_study(wish, progress);
  ASSERT_TRUE(found.usable());
  EXPECT_LT(found.tracking_error(1), 0.5 * kDegree);
  io::write_storage(state_storage(wish, found), folder_ / "states.sto");
  io::write_storage(control_storage(wish, found).value(), folder_ / "controls.sto");
  const std::string forward = kArm + load +
                              "[motion]\nbegin = 0.1\nduration = 0.2\nstart_file = \"states.sto\"\n"
                              "excitation_file = \"controls.sto\"\ninterpolation = ";
  const MuscleResult held = run_study(read(forward + "\"hold\"\n", folder_), progress);
  ASSERT_EQ(held.trajectory.q.rows(), found.trajectory.q.rows());
  EXPECT_LT((held.trajectory.q - found.trajectory.q).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((held.trajectory.tendon_force - found.trajectory.tendon_force).cwiseAbs().maxCoeff(), 1e-5);
  // From the middle on: fibres are not in equilibrium there, so their lengths must come from the file too. The first
  // step is another, so that the integration's accuracy is what is left (1e-2 when fibres start in equilibrium).
  std::string later = forward + "\"hold\"\n";
  const std::string whole = "begin = 0.1\nduration = 0.2\n";
  later.replace(later.find(whole), whole.size(), "begin = 0.2\nduration = 0.1\n");
  const MuscleResult half = run_study(read(later, folder_), progress);
  EXPECT_LT((half.trajectory.q - found.trajectory.q.bottomRows(21)).cwiseAbs().maxCoeff(), 1e-5);
  // Both ends of every window are written, so that a program that interpolates has the same controls: what differs is
  // how the integrator comes over the jumps, less and less with its accuracy.
  const std::string finely = "accuracy = 1e-9\n";
  const MuscleResult exact = run_study(read(forward + "\"hold\"\n" + finely, folder_), progress);
  const MuscleResult interpolated = run_study(read(forward + "\"linear\"\n" + finely, folder_), progress);
  EXPECT_LT((interpolated.trajectory.q - exact.trajectory.q).cwiseAbs().maxCoeff(), 1e-6);
  // The states are part of it: from rest it is another motion.
  std::string rest = forward + "\"hold\"\n[motion.start]\nelbow_flexion = \"30 deg\"\n";
  const std::string start = "start_file = \"states.sto\"\n";
  rest.replace(rest.find(start), start.size(), "");
  const MuscleResult other = run_study(read(rest, folder_), progress);
  EXPECT_GT((other.trajectory.q - found.trajectory.q).cwiseAbs().maxCoeff(), 1e-4);
}

TEST_F(MuscleStudyFiles, TablesReadBackAsTheMotionTheyAre) {
  const MuscleStudy study = read(kArm + "[motion]\nduration = 0.1\n[motion.start]\nelbow_flexion = 0.5\n");
  Progress progress;
  const MuscleResult result = run_study(study, progress);
  io::write_storage(state_storage(study, result), folder_ / "states.sto");
  const SignalTable table = read_signals(folder_ / "states.sto");
  EXPECT_THAT(table.names,
              testing::IsSupersetOf({"/jointset/elbow/elbow_flexion/value", "/jointset/shoulder/shoulder_flexion/speed",
                                     "/forceset/brachialis/activation", "/forceset/brachialis/fiber_length"}));
  const MuscleStudy inverse = read(kArm + "[motion]\nmethod = \"inverse dynamics\"\nfile = \"states.sto\"\n", folder_);
  EXPECT_EQ(inverse.begin, 0.0);
  EXPECT_DOUBLE_EQ(inverse.end, 0.1);
  EXPECT_NEAR(inverse.motion.coordinate[1]->evaluate(0.05).value, result.trajectory.q(10, 1), 1e-12);
  EXPECT_THAT(motion_table(study, result).names(),
              ElementsAre("shoulder_flexion", "shoulder_flexion_speed", "elbow_flexion", "elbow_flexion_speed"));
  EXPECT_EQ(muscle_table(study, result).names().size(), 5u * 6u);
}

}  // namespace
}  // namespace veridyn::muscle
