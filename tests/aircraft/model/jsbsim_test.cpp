#include "veridyn/aircraft/model/jsbsim.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/aircraft/model/jsbsim_aircraft.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/ode.hpp"

namespace veridyn::aircraft {
namespace {

using testing::JsbsimAircraft;

/// A subject with everything that the exporter can meet.
Subject everything(StallForm form, PropulsionKind propulsion) {
  Subject s = builtin_subject("aerosonde");
  s.force_point = {-0.02, 0.01, 0.03};
  s.model.stall = StallBlend{.M = 40.0, .alpha0 = 0.3, .form = form};
  CoefficientModel CD = s.model.at(Coefficient::kCD);
  for (const auto& [text, number] : {std::pair{"abs(de)", 0.03},
                                     {"spline(alpha, 5 deg, 2)", 0.7},
                                     {"CT", 0.1},
                                     {"spline(alpha, 3 deg, 0)", 0.01},
                                     {"alpha*q_n", 0.2},
                                     {"Va", 1e-4}}) {
    CD.terms.push_back(parse_term(text, "test"));
    CD.values.push_back(number);
  }
  s.model.set(CD);
  Propulsion p;
  p.kind = propulsion;
  p.position = {0.3, 0.02, -0.05};
  p.polynomial = {{1, 0, 30.0}, {1, 1, -0.5}, {0, 2, -0.01}};
  p.S_prop = 0.2, p.k_motor = 50.0, p.k_tp = 1e-6, p.k_omega = 500.0;
  p.diameter = 0.4, p.omega_max = 800.0, p.CT = {0.1, -0.02, -0.08}, p.CP = {0.04, 0.01, -0.03}, p.J_max = 1.0;
  s.propulsion = p;
  return s;
}

TEST(Jsbsim, LoadsOfTheFileAreThoseOfTheSubjectAtRandomStates) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const StallForm form : {StallForm::kFull, StallForm::kSource, StallForm::kSeparation}) {
    for (const PropulsionKind kind :
         {PropulsionKind::kNone, PropulsionKind::kPolynomial, PropulsionKind::kMomentum, PropulsionKind::kPropeller}) {
      Subject s = everything(form, kind);
      if (form == StallForm::kSource) s.lengths = {.roll = 1.3 * s.span, .pitch = 0.8 * s.chord, .yaw = 0.4 * s.span};
      JsbsimAircraft file(write_jsbsim(s));
      const MassProperties mass = file.mass();
      EXPECT_EQ(mass.mass, s.mass);
      EXPECT_EQ(mass.inertia, s.inertia->matrix());
      for (int i = 0; i < 200; ++i) {
        const Eigen::Vector3d v(20.0 + 8.0 * unit(random), 4.0 * unit(random), 12.0 * unit(random));
        const Eigen::Vector3d omega(unit(random), unit(random), unit(random));
        Controls<double> controls{0.3 * unit(random), 0.3 * unit(random), 0.3 * unit(random), 0.5 + 0.5 * unit(random),
                                  0.0};
        const double share = 0.5 + 0.5 * unit(random);
        controls.rotor_speed =
            share * (kind == PropulsionKind::kPropeller ? s.propulsion.omega_max : s.propulsion.k_omega);
        const AeroLoads<double> ours = aero_loads<double>(s, v, omega, controls, 1.1);
        const JsbsimAircraft::Loads theirs = file.loads(v, omega, controls, 1.1, share);
        EXPECT_LT((theirs.force - ours.force).norm(), 1e-11 * (1.0 + ours.force.norm()));
        EXPECT_LT((theirs.moment - ours.moment).norm(), 1e-11 * (1.0 + ours.moment.norm()));
      }
    }
  }
}

TEST(Jsbsim, BothModelsFlyTheSameTenSeconds) {
  for (const std::string& name : builtin_subject_names()) {
    const Subject s = builtin_subject(name);
    if (!s.inertia || !s.model.unknown_parameters().empty()) continue;
    JsbsimAircraft file(write_jsbsim(s));
    const MassProperties ours(s.mass, s.inertia->matrix()), theirs = file.mass();
    const auto controls = [&](double t) {
      Controls<double> c{0.03 * std::sin(2.0 * t), 0.02 * std::sin(3.0 * t), 0.03 * std::cos(1.5 * t),
                         0.5 + 0.3 * std::sin(0.7 * t), 0.0};
      c.rotor_speed = s.propulsion.steady_rotor_speed(c.throttle);
      return c;
    };
    const auto rate_of_file = [&](double t, const RigidBodyState<double>& x) {
      const Eigen::Vector3d v_r = R_body_from_ned(x) * x.segment<3>(3);
      const Controls<double> c = controls(t);
      const JsbsimAircraft::Loads l = file.loads(v_r, x.tail<3>(), c, 1.2, c.throttle);
      return rigid_body_rate<double>(x, theirs, l.force, l.moment, 9.80665);
    };
    const auto rate_of_subject = [&](double t, const RigidBodyState<double>& x) {
      return aircraft_rate<double>(s, ours, x, controls(t), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 1.2,
                                   9.80665);
    };
    const auto fly = [](const auto& rate) {
      RigidBodyState<double> x = RigidBodyState<double>::Zero();
      x(2) = -200.0, x(3) = 20.0, x(5) = 0.5, x(9) = 1.0;
      const double h = 0.01;
      for (int i = 0; i < 1000; ++i) {
        x = numerics::runge_kutta_4_step(rate, h * i, x, h);
        normalise_attitude(x);
      }
      return x;
    };
    const RigidBodyState<double> a = fly(rate_of_subject), b = fly(rate_of_file);
    EXPECT_GT((a.head<3>() - Eigen::Vector3d(0, 0, -200)).norm(), 10.0) << name << " must have flown";
    EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-7) << name;
  }
}

TEST(Jsbsim, WhatCannotFlyIsRefusedByName) {
  Subject s = builtin_subject("aerosonde");
  s.model.at(Coefficient::kCm).values[0] = kNaN;
  try {
    (void)write_jsbsim(s);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("Cm_0"), std::string::npos) << error.what();
  }
  s = builtin_subject("aerosonde");
  s.inertia.reset();
  EXPECT_THROW((void)write_jsbsim(s), InputError);
}

}  // namespace
}  // namespace veridyn::aircraft
