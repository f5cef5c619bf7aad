#include "veridyn/muscle/simulation/system_linearization.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/support/folders.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

/// Against automatic differentiation of the whole evaluator, which shares no derivative with the linearisation.
void expect_those_of_jets(const MusculoskeletalSystem& system, double tolerance) {
  const StateLayout& layout = system.layout();
  const std::size_t n = layout.size, muscles = system.muscles().size();
  std::vector<double> u(muscles), x(n), a(muscles);
  for (std::size_t m = 0; m < muscles; ++m) {
    u[m] = 0.2 + 0.05 * static_cast<double>(m % 5);
    a[m] = 0.1 + 0.04 * static_cast<double>(m % 7);
  }
  SystemEvaluator<double> plain(system);
  const Eigen::VectorXd pose = system.model().default_pose();
  for (std::size_t i = 0; i < layout.free; ++i) {
    const Coordinate& c = system.model().coordinates[system.reduction().free()[i]];
    x[i] = std::min(pose(system.reduction().free()[i]) + 0.1, c.high);
    x[layout.free + i] = 0.5 - 0.3 * static_cast<double>(i % 3);
  }
  plain.hold(pose.data());
  plain.set_motion(x.data(), x.data() + layout.free);
  plain.start_muscles(a.data(), x.data());
  // Off equilibrium, so that fibres move.
  for (std::size_t m = 0; m < muscles; ++m) {
    if (layout.fiber_length[m] >= 0)
      x[layout.fiber_length[m]] -= 1e-3 * system.muscles().settings(m).musculotendon.tendon_slack_length;
  }
  std::vector<MusculotendonParameters<double>> parameters;
  for (std::size_t m = 0; m < muscles; ++m) parameters.push_back(system.muscles().settings(m).musculotendon);
  // The states, then every number of two muscles.
  std::vector<TangentForcing> forcings;
  std::vector<std::pair<std::size_t, std::size_t>> fields;
  for (const std::size_t m : {std::size_t{0}, muscles - 1}) {
    for (std::size_t f = 0; f < kEstimableFields; ++f) {
      if (f == 3 && parameters[m].pennation_angle_at_optimal == 0.0) continue;
      forcings.push_back({n + fields.size(), m, f, 1.0});
      fields.emplace_back(m, f);
    }
  }
  const std::size_t columns = n + fields.size();
  SystemLinearization linearization(system, parameters, forcings, columns);
  linearization.hold(pose.data());
  std::vector<double> rate(n), expected_rate(n), S(n * columns, 0.0), S_rate(n * columns, 0.0);
  for (std::size_t i = 0; i < n; ++i) S[i * columns + i] = 1.0;
  ASSERT_TRUE(linearization.derivative(x.data(), {u, {}}, rate.data()));
  linearization.tangent_rate(0.0, S.data(), S_rate.data());
  ASSERT_TRUE(plain.derivative(x.data(), {u, {}}, expected_rate.data()));
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(rate[i], expected_rate[i], 1e-8 * (1.0 + std::abs(expected_rate[i])));

  constexpr std::size_t kWidth = SimulationJet::DIMENSION;
  std::vector<SimulationJet> held, xj(n), rj(n);
  for (const double value : pose) held.emplace_back(value);
  for (std::size_t first = 0; first < columns; first += kWidth) {
    std::vector<MusculotendonParameters<SimulationJet>> jets;
    for (const auto& p : parameters) jets.push_back(p.cast<SimulationJet>());
    for (std::size_t i = 0; i < n; ++i) xj[i] = SimulationJet(x[i]);
    for (std::size_t j = 0; j < kWidth && first + j < columns; ++j) {
      const std::size_t k = first + j;
      SimulationJet& seed = k < n ? xj[k] : field_of(jets[fields[k - n].first], fields[k - n].second);
      seed.v(j) = 1.0;
    }
    SystemEvaluator<SimulationJet> jet(system, system.muscles().with<SimulationJet>(jets));
    jet.hold(held.data());
    ASSERT_TRUE(jet.derivative(xj.data(), {u, {}}, rj.data()));
    for (std::size_t j = 0; j < kWidth && first + j < columns; ++j) {
      double largest = 1.0;  // columns of nothing but rounding (a translation) have no size of their own
      for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(rj[i].v(j)));
      for (std::size_t i = 0; i < n; ++i) {
        const double got = S_rate[i * columns + first + j];
        // Rows of activations that no unknown moves are not carried along.
        const bool activation = i >= 2 * layout.free && i < n &&
                                std::find(layout.activation.begin(), layout.activation.end(), static_cast<int>(i)) !=
                                    layout.activation.end();
        if (activation && got == 0.0) continue;
        if (first + j < n && first + j >= 2 * layout.free &&
            std::find(layout.activation.begin(), layout.activation.end(), static_cast<int>(first + j)) !=
                layout.activation.end())
          continue;
        EXPECT_NEAR(got, rj[i].v(j), tolerance * largest)
            << "state " << i << " (" << system.state_name(i) << ") by column " << first + j;
      }
    }
  }
}

TEST(SystemLinearization, IsThatOfAutomaticDifferentiation) {
  // Exact paths: geodesics are found to some 1e-8, and jets take dL/dq from the length, we from the moment arm.
  expect_those_of_jets(MusculoskeletalSystem(load_model("arm").model(), {.paths = PathSource::kExact}), 1e-7);
  expect_those_of_jets(MusculoskeletalSystem(load_model("arm").model(), {.paths = PathSource::kFitted}), 1e-9);
}

TEST(SystemLinearization, OfLockedCoordinatesLoadsAndRigidTendons) {
  Model model = load_model("arm").model();
  add_load(model, model.bodies.back().name, 2.0, Eigen::Vector3d(0.0, -0.2, 0.05));
  model.muscles[1].parameters.rigid_tendon = true;
  expect_those_of_jets(MusculoskeletalSystem(model, {.locked = {model.coordinates[0].name}}), 1e-7);
  expect_those_of_jets(MusculoskeletalSystem(model, {}), 1e-7);
}

TEST(SystemLinearization, OfForcesThatFollowFromTheMotion) {
  Model model = load_model("arm").model();
  const int forearm = static_cast<int>(model.bodies.size()) - 1;
  CoordinateSpring spring;
  spring.coordinate = 1;
  spring.stiffness = 3.0;
  spring.rest_length = 0.4;
  spring.viscosity = 0.5;
  model.coordinate_springs.push_back(spring);
  expect_those_of_jets(MusculoskeletalSystem(model), 1e-7);
  Bushing bushing;
  bushing.body_2 = forearm;
  bushing.frame_1.translation = {0.1, -0.2, 0.05};
  bushing.set_stiffness({2.0, 3.0, 4.0}, {30.0, 40.0, 50.0});
  bushing.rotational_damping = {0.2, 0.1, 0.3};
  bushing.translational_damping = {1.0, 2.0, 3.0};
  model.body_forces.bushings.push_back(bushing);
  PointSpring point;
  point.body_2 = forearm;
  point.point_2 = {0.0, -0.2, 0.1};
  point.stiffness = 20.0;
  point.rest_length = 0.1;
  model.body_forces.springs.push_back(point);
  SphereContact contact;
  contact.sphere_body = forearm;
  contact.center = {0.0, -0.2, 0.0};
  contact.radius = 0.1;
  contact.plane.rotation = body_fixed_xyz({0.0, 0.0, -1.2});
  contact.plane.translation = {0.0, -0.4, 0.0};
  contact.half_stiffness = 500.0;
  contact.dissipation = 0.5;
  contact.static_friction = 0.8;
  contact.dynamic_friction = 0.6;
  contact.smooth = true;
  model.body_forces.contacts.push_back(contact);
  PassivePath path;
  path.name = "cord";
  path.points = model.muscles[0].points;
  path.wraps = model.muscles[0].wraps;
  path.law = PathSpringLaw{0.1, 200.0, 0.3};
  model.passive_paths.push_back(path);
  path.law = LigamentLaw{0.1, 30.0, numerics::PiecewisePolynomial::linear(2.0, 0.1)};
  model.passive_paths.push_back(path);
  expect_those_of_jets(MusculoskeletalSystem(model), 1e-7);
}

TEST(SystemLinearization, OfRealModelsWithCouplersAndJointsOfSeveralAxes) {
  const auto folder = veridyn::test::shared_folder() / "data/opensim";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the OpenSim models of ../shared/data are not here";
  for (const char* file :
       {"arm26_millard.osim", "gait2392_thelen2003muscle.osim", "leg6dof9musc.osim", "gait10dof18musc.osim"}) {
    if (!std::filesystem::exists(folder / file)) continue;
    SCOPED_TRACE(file);
    expect_those_of_jets(MusculoskeletalSystem(read_osim(folder / file), {.without_unsupported = true}), 1e-7);
  }
}

}  // namespace
}  // namespace veridyn::muscle
