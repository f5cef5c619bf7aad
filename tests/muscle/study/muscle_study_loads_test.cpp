// Forces of the surroundings in a study: read, refused, and of use to all methods.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/muscle/muscle_studies.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/osim/external_loads_file.hpp"
#include "veridyn/muscle/study/muscle_run.hpp"

namespace veridyn::muscle {
namespace {

using test::read_muscle_study;
using test::study_error;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A step of the built-in legs, simulated with contact once: what a laboratory would have recorded.
const std::string kStep =
    "[subject]\nmodel = \"legs\"\n[motion]\nduration = 0.4\nrate = 2000\naccuracy = 1e-10\n"
    "joint_reactions = \"ground\"\n[motion.excitation]\n"
    "default = 0.05\ngluteus_r = 0.2\nvasti_r = 0.35\nsoleus_r = 0.24\nhamstrings_r = 0.04\ntibialis_r = 0.02\n"
    "gluteus_l = 0.03\niliopsoas_l = 0.3\nvasti_l = 0.03\nhamstrings_l = 0.1\ntibialis_l = 0.2\nsoleus_l = 0.03\n";

const std::string kLegs = "[subject]\nmodel = \"legs\"\nwithout_contact = true\n[motion]\nfile = \"states.sto\"\n";
const std::string kLoads = "external_loads = \"contact_loads.xml\"\n";

class StudyLoads : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_.emplace();
    const MuscleStudy study = read_muscle_study(kStep);
    Progress progress;
    const MuscleResult result = run_study(study, progress);
    ASSERT_TRUE(result.usable());
    io::write_storage(state_storage(study, result), folder() / "states.sto");
    io::write_storage(*control_storage(study, result), folder() / "controls.sto");
    const ContactRecord contacts = *contact_record(study, result);
    io::write_storage(contacts.storage, folder() / "contact_forces.sto");
    write_file(folder() / "contact_loads.xml", to_external_loads_text(contacts.sources, "contact_forces.sto"));
    moved_ = result.trajectory;
    reactions_ = result.reactions;
    forces_ = contacts.storage;
    for (const Body& body : study.system->model().bodies) weight_ += body.mass * kGravity;
  }
  static void TearDownTestSuite() { scratch_.reset(); }

  static std::filesystem::path folder() { return scratch_->path(); }
  static MuscleResult run(const std::string& text) {
    const MuscleStudy study = read_muscle_study(text, folder());
    Progress progress;
    return run_study(study, progress);
  }
  /// The recorded forces changed, as an own data file.
  static void write_changed(const std::string& name, double force, double point) {
    io::Storage changed = forces_;
    for (std::size_t i = 0; i < changed.values.size(); ++i)
      changed.values[i] *= changed.labels[i % changed.columns()].find("force_v") != std::string::npos ? force : point;
    io::write_storage(changed, folder() / name);
  }

  static inline std::optional<veridyn::test::TemporaryFolder> scratch_;
  static inline MuscleTrajectory moved_;
  static inline std::optional<JointReactions> reactions_;
  static inline io::Storage forces_;
  static inline double weight_ = 0.0;
};

TEST_F(StudyLoads, TheStepIsOne) {
  // The right foot stands all the time; the left one leaves the ground and comes down again.
  const auto pressed = [&](const char* side, double time) {
    const auto row = static_cast<std::size_t>(std::lround(time * 2000.0));
    double force = 0.0;
    for (const char* part : {"heel", "toe"}) {
      const std::string name = fmt::format("contact_{}_{}_force_vy", part, side);
      const auto column = std::find(forces_.labels.begin(), forces_.labels.end(), name) - forces_.labels.begin();
      force += forces_.value(row, at(column));
    }
    return force;
  };
  for (const double time : {0.05, 0.15, 0.25, 0.35}) EXPECT_GT(pressed("r", time), 0.6 * weight_);
  EXPECT_GT(pressed("l", 0.0), 0.2 * weight_);
  for (const double time : {0.15, 0.2, 0.25}) EXPECT_LT(pressed("l", time), 1e-3 * weight_);
  EXPECT_GT(pressed("l", 0.39), 0.05 * weight_);
}

TEST_F(StudyLoads, InverseDynamicsClosesToAMillionthOfTheForces) {
  const MuscleResult r = run(kLegs + kLoads + "method = \"inverse dynamics\"\nrate = 2000\n");
  EXPECT_THAT(r.warnings, IsEmpty());
  ASSERT_EQ(r.trajectory.time.size(), 801u);
  // Nothing drives the pelvis but the ground: force and moment there vanish. Second derivatives of the spline through
  // the angles are less good within a few samples of its ends.
  double pelvis = 0.0, greatest = 0.0;
  for (Eigen::Index i = 20; i < 781; ++i)
    pelvis = std::max(pelvis, r.generalized_force.row(i).head(3).cwiseAbs().maxCoeff());
  for (const double f : forces_.values) greatest = std::max(greatest, std::abs(f));
  EXPECT_LT(pelvis, 1e-6 * greatest);
  EXPECT_NEAR(r.external_fit->factor, 1.0, 1e-4);  // of all rows, the ends too
  // Without the loads the pelvis lacks the weight.
  EXPECT_GT(r.external_fit->without, 0.5 * weight_);
}

TEST_F(StudyLoads, StaticOptimizationLeavesThePelvisToTheGround) {
  const MuscleResult r =
      run(kLegs + kLoads + "method = \"static optimization\"\nrate = 200\njoint_reactions = \"ground\"\n");
  EXPECT_THAT(r.warnings, IsEmpty());
  const Eigen::Index rows = r.trajectory.reserve.rows() - 2;
  for (Eigen::Index c = 0; c < 9; ++c)
    EXPECT_LT(r.trajectory.reserve.col(c).segment(1, rows - 1).cwiseAbs().maxCoeff(), 0.01 * weight_) << c;
  EXPECT_TRUE(r.overloaded.empty());
  // The joints transmit, along the ways that they leave free, what reserves give; nothing at the pelvis.
  for (Eigen::Index i = 2; i < rows; ++i) {
    EXPECT_NEAR(r.reactions->force(i, 1), r.trajectory.reserve(i, 2), 1e-6 * weight_);
    EXPECT_NEAR(r.reactions->moment(i, 5), r.trajectory.reserve(i, 3), 1e-6 * weight_);
  }
}

TEST_F(StudyLoads, ReservesThatCarryTheModelAreNamed) {
  // Without the ground's force, and with it twice.
  EXPECT_THAT(run(kLegs + "method = \"static optimization\"\n").warnings,
              ElementsAre(AllOf(HasSubstr("the reserve of 'pelvis_ty' carries up to"),
                                HasSubstr("external loads are missing or do not fit"))));
  EXPECT_THAT(run("[subject]\nmodel = \"legs\"\nwithout_contact = false\n[motion]\nfile = \"states.sto\"\n" + kLoads +
                  "method = \"static optimization\"\n")
                  .warnings,
              ElementsAre(HasSubstr("the reserve of 'pelvis_ty' carries up to")));
}

TEST_F(StudyLoads, ReactionsOfTheSimulationAreThoseOfTheRecording) {
  // Net reactions without muscles differ by these alone: the force that the ground gives goes through the ankle.
  const MuscleResult r =
      run(kLegs + kLoads + "method = \"inverse dynamics\"\nrate = 2000\njoint_reactions = \"ground\"\n");
  for (Eigen::Index i = 20; i < 781; i += 40) {
    EXPECT_NEAR(reactions_->force(i, 0), 0.0, 1e-6 * weight_);
    EXPECT_NEAR(reactions_->force(i, 1), 0.0, 1e-6 * weight_);
    EXPECT_NEAR(r.reactions->force(i, 1), 0.0, 1e-5 * weight_);
    // Muscles press the right ankle together: its force exceeds the net one.
    EXPECT_GT(reactions_->force.row(i).segment(9, 3).norm(), r.reactions->force.row(i).segment(9, 3).norm());
  }
}

TEST_F(StudyLoads, ASimulationWithTheLoadsRepeatsTheOneWithContact) {
  const MuscleResult r = run(
      "[subject]\nmodel = \"legs\"\nwithout_contact = true\n[motion]\nduration = 0.4\nrate = 2000\naccuracy = 1e-9\n"
      "start_file = \"states.sto\"\nexcitation_file = \"controls.sto\"\ninterpolation = \"hold\"\n" +
      kLoads);
  ASSERT_TRUE(r.usable()) << r.trajectory.message();
  // Contact holds the feet, loads do not: what a spline through forces misses (their rise at the start) grows.
  EXPECT_LT((r.trajectory.q - moved_.q).topRows(201).cwiseAbs().maxCoeff(), 1e-3);
}

TEST_F(StudyLoads, ComputedMuscleControlFollowsTheStep) {
  const MuscleResult r = run(kLegs + kLoads +
                             "method = \"computed muscle control\"\nbegin = 0.05\nduration = 0.2\n"
                             "[motion.reserves]\npelvis_tx = 50\npelvis_ty = 50\npelvis_tilt = 20\n");
  ASSERT_TRUE(r.usable()) << r.trajectory.message();
  for (std::size_t c = 0; c < 9; ++c) EXPECT_LT(r.tracking_error(c), 0.02) << c;
  EXPECT_LT(r.trajectory.reserve.leftCols(3).cwiseAbs().maxCoeff(), 0.1 * weight_);
}

TEST_F(StudyLoads, LoadsByTableAreThoseOfTheXml) {
  std::string text = kLegs + "method = \"inverse dynamics\"\n";
  for (const char* side : {"r", "l"})
    for (const char* part : {"heel", "toe"})
      text += fmt::format(
          "[[motion.external_load]]\nbody = \"foot_{0}\"\nfile = \"contact_forces.sto\"\n"
          "force = \"contact_{1}_{0}_force_v\"\npoint = \"contact_{1}_{0}_force_p\"\n",
          side, part);
  const MuscleResult a = run(text), b = run(kLegs + kLoads + "method = \"inverse dynamics\"\n");
  EXPECT_LT((a.generalized_force - b.generalized_force).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(StudyLoads, SignsAndUnitsThatDoNotFitAreNamed) {
  const auto warnings = [&](double force, double point) {
    write_changed("changed.sto", force, point);
    return run(kLegs + kLoads + "external_loads_data = \"changed.sto\"\nmethod = \"inverse dynamics\"\n").warnings;
  };
  EXPECT_THAT(warnings(-1.0, 1.0), testing::Contains(AllOf(HasSubstr("do not fit the motion: 'pelvis_ty' lacks"),
                                                           HasSubstr("have they the opposite sign?"))));
  EXPECT_THAT(warnings(1e-3, 1.0), testing::Contains(HasSubstr("are they in kilonewtons?")));
  EXPECT_THAT(warnings(-1.0 / kGravity, 1.0),
              testing::Contains(HasSubstr("are they in kilograms and of the opposite sign?")));
  EXPECT_THAT(warnings(1.0, 1000.0), testing::Contains(HasSubstr("is its point in millimetres, or in another frame?")));
  EXPECT_THAT(warnings(0.8, 1.0), testing::Contains(HasSubstr("times 1.25 they would fit best")));
}

TEST_F(StudyLoads, WhatIsWrongIsSaidInALine) {
  const std::string id = kLegs + "method = \"inverse dynamics\"\n";
  const std::string load = "[[motion.external_load]]\nbody = \"foot_r\"\n";
  EXPECT_THAT(study_error(id + kLoads + "begin = 0\nduration = 0.3\nexternal_loads_data = \"states.sto\"\n", folder()),
              AllOf(HasSubstr("contact_loads.xml:5"), HasSubstr("states.sto has no columns that begin so")));
  io::Storage early = forces_;
  early.time.resize(200);
  early.values.resize(200 * early.columns());
  io::write_storage(early, folder() / "early.sto");
  EXPECT_THAT(study_error(id + kLoads + "external_loads_data = \"early.sto\"\n", folder()),
              AllOf(HasSubstr("motion.external_loads_data"), HasSubstr("0 .. 0.0995 s, the motion needs 0 .. 0.4 s")));
  EXPECT_THAT(study_error(id + load, folder()), HasSubstr("force: is missing, and so is a torque"));
  EXPECT_THAT(study_error(id + load + "force = \"f\"\n", folder()), HasSubstr("file: is missing"));
  EXPECT_THAT(study_error(id + load + "force = [1, 2]\n", folder()), HasSubstr("has 2 numbers, expected x, y, z"));
  EXPECT_THAT(study_error(id + load + "force = [0, 1, 0]\nfile = \"contact_forces.sto\"\n", folder()),
              HasSubstr("holds no column that is used"));
  EXPECT_THAT(study_error(id + "[[motion.external_load]]\nbody = \"foot\"\nforce = [0, 1, 0]\n", folder()),
              AllOf(HasSubstr("body 'foot' is no body of model 'legs'"), HasSubstr("did you mean")));
  EXPECT_THAT(study_error(id + "external_loads_data = \"contact_forces.sto\"\n", folder()),
              HasSubstr("has no meaning without external_loads"));
  EXPECT_THAT(study_error(id + "external_low_pass = \"20 Hz\"\n", folder()),
              HasSubstr("has no meaning without external loads"));
  EXPECT_THAT(study_error("[subject]\nmodel = \"legs\"\n[motion]\nfile = \"states.sto\"\n" + kLoads +
                              "method = \"static optimization\"\n",
                          folder()),
              AllOf(HasSubstr("subject.without_contact: is needed"), HasSubstr("both act on body 'foot_r'")));
  EXPECT_THAT(study_error(id + "[motion.reserves]\npelvis_ty = -1\n", folder()), HasSubstr("-1 must be >= 0"));
  EXPECT_THAT(study_error(id + "[motion.reserves]\npelvis_y = 1\n", folder()), HasSubstr("did you mean 'pelvis_ty'"));
}

TEST(StudyReserves, ActOnTheirCoordinatesAlone) {
  const MuscleStudy study = read_muscle_study(test::kFollow +
                                              "reserve_force = 3\n[motion.reserves]\nelbow_flexion = 0.5\n"
                                              "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"60 deg\"\n"
                                              "duration = 0.3\n");
  EXPECT_THAT(study.reserves, testing::ElementsAre(3.0, 0.5));
  EXPECT_THAT(study.control.reserve_forces, testing::ElementsAre(3.0, 0.5));
}

/// A model of OpenSim with feet of spheres: the same closure.
TEST(StudyLoadsOfOpenSim, AnalysisOfGait10Closes) {
  const std::filesystem::path file = veridyn::test::shared_folder() / "data/opensim/gait10dof18musc.osim";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the OpenSim models of ../shared/data are not here";
  Model model = OsimFile::load(file).model();
  for (const char* side : {"r", "l"}) {
    for (const double x : {0.02, 0.2}) {
      SphereContact contact;
      contact.name = fmt::format("{}{}", x < 0.1 ? "heel_" : "toe_", side);
      contact.sphere_body = model.body(fmt::format("calcn_{}", side));
      ASSERT_GT(contact.sphere_body, 0);
      contact.center = {x, 0.01, 0.0};
      contact.radius = 0.03;
      contact.plane.rotation = Eigen::AngleAxisd(-0.5 * kPi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      contact.half_stiffness = 0.5 * std::pow(3e6, 2.0 / 3.0);
      contact.dissipation = 2.0;
      contact.static_friction = contact.dynamic_friction = 0.8;
      contact.smooth = true;
      model.body_forces.contacts.push_back(contact);
    }
  }
  const MusculoskeletalSystem with_contact(model);
  const MusculoskeletalSystem system(model, {.without_contact = true});
  // Later a knee passes the angle at which a muscle's path loses a point: its force, and with it the acceleration,
  // jumps, which no spline through the angles has.
  constexpr double kEnd = 0.09;
  const StartState start = default_start(model);
  MuscleControls controls;
  controls.excitation = ControlSignals(std::vector<double>(model.muscles.size(), 0.05));
  Progress progress;
  const MuscleTrajectory t = simulate_forward(
      with_contact, start, controls, {.begin = 0.0, .end = kEnd, .rate_Hz = 2000.0, .accuracy = 1e-10}, progress);
  ASSERT_TRUE(t.usable()) << t.message();
  const ContactRecord contacts = record_contacts(with_contact, t.time, t.q, t.qdot);
  Motion motion{.begin = 0.0, .end = kEnd, .coordinate = {}, .missing = {}, .beyond_range = {}};
  for (Eigen::Index c = 0; c < t.q.cols(); ++c) {
    const std::vector<double> values(t.q.col(c).begin(), t.q.col(c).end());
    motion.coordinate.emplace_back(numerics::PiecewisePolynomial::quintic_spline(t.time, values));
  }
  SignalTable table{.source = "contacts", .names = contacts.storage.labels, .time = t.time, .values = {}};
  double greatest = 0.0;
  for (std::size_t c = 0; c < contacts.storage.columns(); ++c) {
    table.values.push_back(contacts.storage.column(c));
    for (const double v : table.values.back()) greatest = std::max(greatest, std::abs(v));
  }
  auto loads = std::make_shared<ExternalLoads>();
  add_external_loads(contacts.sources, &table, model, 0.0, *loads);
  motion.external = loads;
  const MotionAnalysis analysis = analyse_motion(system, motion, start.q, t.time);
  double pelvis = 0.0;
  for (Eigen::Index i = 20; i + 20 < analysis.moment.rows(); ++i)
    for (const char* name : {"pelvis_tilt", "pelvis_tx", "pelvis_ty"})
      pelvis = std::max(pelvis, std::abs(analysis.moment(i, model.coordinate(name))));
  EXPECT_GT(greatest, 100.0);
  EXPECT_LT(pelvis, 1e-6 * greatest);
  // The muscles that made the motion make it again, without reserves.
  std::vector<double> time;
  for (std::size_t i = 20; i + 20 < t.time.size(); i += 10) time.push_back(t.time[i]);
  StaticOptimizationOptions options;
  options.force = StaticForce::kWithPassive;
  options.reserve.assign(model.coordinates.size(), 1.0);
  const MotionAnalysis optimised = optimise_motion(system, motion, start.q, time, options, progress);
  EXPECT_THAT(optimised.infeasible, IsEmpty());
  double weight = 0.0;
  for (const Body& body : model.bodies) weight += body.mass * kGravity;
  EXPECT_LT(optimised.reserve.cwiseAbs().maxCoeff(), 1e-4 * weight);
}

}  // namespace
}  // namespace veridyn::muscle
