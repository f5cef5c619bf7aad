#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "veridyn/camera/fusion/inertial_model.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::camera::testing {

/// The truth at a time.
struct TrueMotion {
  double time = 0.0;
  Eigen::Vector3d position, velocity, acceleration;  ///< track axes, z up
  double heading = 0.0, pitch = 0.0, roll = 0.0;
  Eigen::Vector2d along_the_car;  ///< acceleration forward, left, horizontal
};

struct InertialSample {
  double time = 0.0;
  Eigen::Vector3d rate, force;
};

struct CameraSample {
  double arrival = 0.0, stamp = 0.0;
  Eigen::Vector3d pose;
  Eigen::Matrix3d covariance;
};

struct SimulatedRun {
  std::vector<TrueMotion> truth;  ///< at the inertial samples
  std::vector<InertialSample> inertial;
  std::vector<CameraSample> frames;  ///< by arrival
};

struct RunOptions {
  std::uint64_t seed = 1;
  double duration_s = 60.0;
  double offset = 0.0;     ///< of the camera's stamps [s]
  bool hills = false;      ///< ramps and banks of up to 5 deg, else flat
  bool occlusions = true;  ///< of a second
  double latest_s = 0.08;  ///< frames arrive up to this late
};

/// Heading, pitch and roll.
struct CarAttitude {
  double heading = 0.0, pitch = 0.0, roll = 0.0;
};

/// Where a car is on a wavy circuit, which may be hilly.
struct WavyCircuit {
  static constexpr double kStep = 1e-3;  ///< of central differences, of the springs, too [s]
  double phase = 0.0, swing = 1.0;
  bool hills = false;

  [[nodiscard]] double height(double x, double y) const {
    return hills ? 0.05 * std::sin(1.7 * x + 0.4) + 0.04 * std::sin(1.9 * y) : 0.0;
  }
  [[nodiscard]] Eigen::Vector3d place(double t) const {
    const double s = 0.6 * t + 0.22 * std::sin(1.1 * t + phase) * swing;
    const double x = 2.2 + 1.5 * std::cos(s) + 0.25 * std::cos(3.0 * s), y = 1.5 + 1.0 * std::sin(s);
    return {x, y, height(x, y)};
  }
  [[nodiscard]] Eigen::Vector3d velocity(double t) const {
    return (place(t + kStep) - place(t - kStep)) / (2.0 * kStep);
  }
  [[nodiscard]] Eigen::Vector3d acceleration(double t) const {
    return (place(t + kStep) - 2.0 * place(t) + place(t - kStep)) / (kStep * kStep);
  }
  /// Of the road under the car, which slips a little.
  [[nodiscard]] CarAttitude road(double t) const {
    const Eigen::Vector3d v = velocity(t), p = place(t);
    const double psi = std::atan2(v(1), v(0));
    constexpr double d = 1e-4;
    const double gx = (height(p(0) + d, p(1)) - height(p(0) - d, p(1))) / (2.0 * d);
    const double gy = (height(p(0), p(1) + d) - height(p(0), p(1) - d)) / (2.0 * d);
    const double up = gx * std::cos(psi) + gy * std::sin(psi), left = -gx * std::sin(psi) + gy * std::cos(psi);
    return {psi + 0.03 * std::sin(0.9 * t), -std::atan(up), std::atan(left)};
  }
};

/// The body's attitude every millisecond: the road's, and what the springs add under acceleration.
inline std::vector<CarAttitude> attitudes_on(const WavyCircuit& circuit, int steps) {
  constexpr double h = WavyCircuit::kStep;
  std::vector<CarAttitude> attitude(static_cast<std::size_t>(steps) + 2);
  const double first = circuit.road(0.0).heading;
  double pitch = 0.0, pitch_rate = 0.0, roll = 0.0, roll_rate = 0.0, turns = 0.0, last = first;
  const double omega = 2.0 * kPi * 2.5, zeta = 0.3;
  for (int k = 0; k < steps + 2; ++k) {
    const double t = k * h;
    const Eigen::Vector3d a = circuit.acceleration(t);
    const CarAttitude now = circuit.road(t);
    turns += numerics::wrap_angle(now.heading - last);
    last = now.heading;
    const double forward = std::cos(now.heading) * a(0) + std::sin(now.heading) * a(1);
    const double left = -std::sin(now.heading) * a(0) + std::cos(now.heading) * a(1);
    // The nose rises (pitch < 0) when the car speeds up, and it leans out of a turn to the left (roll > 0).
    pitch_rate += h * (omega * omega * (-0.5 * kDegree * forward - pitch) - 2.0 * zeta * omega * pitch_rate);
    roll_rate += h * (omega * omega * (0.5 * kDegree * left - roll) - 2.0 * zeta * omega * roll_rate);
    pitch += h * pitch_rate;
    roll += h * roll_rate;
    attitude[k] = {first + turns, now.pitch + pitch, now.roll + roll};
  }
  return attitude;
}

inline Eigen::Vector3d normal3(numerics::RandomStream& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal());
}

/// The car's true motion at a step of the attitudes.
inline TrueMotion true_motion(const WavyCircuit& circuit, const CarAttitude& now, double t) {
  TrueMotion m{.time = t,
               .position = circuit.place(t),
               .velocity = circuit.velocity(t),
               .acceleration = circuit.acceleration(t),
               .heading = now.heading,
               .pitch = now.pitch,
               .roll = now.roll,
               .along_the_car = {}};
  const double c = std::cos(now.heading), s = std::sin(now.heading);
  m.along_the_car = {c * m.acceleration(0) + s * m.acceleration(1), c * m.acceleration(1) - s * m.acceleration(0)};
  return m;
}

/// Truth and inertial samples at 100 Hz.
inline void add_inertial(SimulatedRun& run, const WavyCircuit& circuit, const std::vector<CarAttitude>& attitude,
                         numerics::RandomStream& random) {
  constexpr double h = WavyCircuit::kStep;
  Eigen::Vector3d gyro_bias, accel_bias;
  for (int i = 0; i < 3; ++i) {
    gyro_bias(i) = 0.015 * random.normal();
    accel_bias(i) = 0.05 * random.normal();
  }
  Eigen::Matrix3d askew = Eigen::Matrix3d::Identity() * 1.005;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (i != k) askew(i, k) = 0.3 * kDegree * random.normal();
  constexpr std::size_t kEvery = 10;
  for (std::size_t i = kEvery; i + kEvery + 2 < attitude.size(); i += kEvery) {
    const double t = static_cast<double>(i) * h;
    const CarAttitude &before = attitude[i - 1], &now = attitude[i], &after = attitude[i + 1];
    const TrueMotion m = true_motion(circuit, now, t);
    const Eigen::Vector3d euler((after.roll - before.roll) / (2.0 * h), (after.pitch - before.pitch) / (2.0 * h),
                                (after.heading - before.heading) / (2.0 * h));
    const Eigen::Vector3d rate = numerics::body_rates<double>(now.roll, now.pitch, euler);
    const Eigen::Vector3d force = numerics::R_body_from_ned<double>(now.roll, now.pitch, now.heading) *
                                  (m.acceleration + Eigen::Vector3d(0.0, 0.0, kGravity));
    constexpr double dt = static_cast<double>(kEvery) * h;
    gyro_bias += 1e-4 * std::sqrt(dt) * normal3(random);
    accel_bias += 1e-3 * std::sqrt(dt) * normal3(random);
    const Eigen::Vector3d vibration = 0.3 * std::sin(2.0 * kPi * 31.0 * t) * Eigen::Vector3d(0.5, 0.3, 1.0);
    run.truth.push_back(m);
    run.inertial.push_back({t, askew * rate + gyro_bias + 0.01 * normal3(random),
                            force + accel_bias + vibration + 0.08 * normal3(random)});
  }
}

/// Frames of the camera at 30 Hz, in the order of their arrival.
inline void add_frames(SimulatedRun& run, const RunOptions& o, const WavyCircuit& circuit,
                       const std::vector<CarAttitude>& attitude, numerics::RandomStream& random) {
  for (double t = 0.05; t < o.duration_s - 0.2; t += 1.0 / 30.0) {
    if (o.occlusions && std::fmod(t, 15.0) > 14.0) continue;
    const auto i = static_cast<std::size_t>(std::lround(t / WavyCircuit::kStep));
    CameraSample frame;
    frame.stamp = t + o.offset;
    const double lateness = o.latest_s * random.uniform();
    frame.arrival = std::max(t, frame.stamp) + lateness;
    const Eigen::Vector3d sigma(1.5e-3, 1.5e-3, 8e-3);
    frame.covariance = sigma.cwiseAbs2().asDiagonal();
    const double exact = static_cast<double>(i) * WavyCircuit::kStep;
    frame.stamp += exact - t;
    frame.pose << circuit.place(exact).head<2>(), attitude[i].heading;
    frame.pose += sigma.cwiseProduct(normal3(random));
    frame.pose(2) = numerics::wrap_angle(frame.pose(2));
    run.frames.push_back(frame);
  }
  std::sort(run.frames.begin(), run.frames.end(),
            [](const CameraSample& a, const CameraSample& b) { return a.arrival < b.arrival; });
}

/// A drive on a wavy circuit, of a car on springs: the body pitches and rolls under acceleration with 2.5 Hz and little
/// damping. The gyro has a drifting bias, a scale error of 0.5 % and is mounted 0.3 deg askew; the accelerometer has a
/// drifting bias and the motor's vibration at 31 Hz. None of that is in the filter's model but noise and walks.
inline SimulatedRun simulated_run(const RunOptions& o) {
  numerics::RandomStream random(o.seed, "fusion/run");
  WavyCircuit circuit{.hills = o.hills};
  circuit.phase = 2.0 * kPi * random.uniform();
  circuit.swing = random.uniform(0.9, 1.2);
  const std::vector<CarAttitude> attitude =
      attitudes_on(circuit, static_cast<int>(std::lround(o.duration_s / WavyCircuit::kStep)));
  SimulatedRun run;
  add_inertial(run, circuit, attitude, random);
  add_frames(run, o, circuit, attitude, random);
  return run;
}

}  // namespace veridyn::camera::testing
