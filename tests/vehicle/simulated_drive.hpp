#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/vehicle/identification/signals/drive_log.hpp"
#include "veridyn/vehicle/model/bicycle_model.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"
#include "veridyn/vehicle/simulation/drive_sensors.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle::testing {

/// A common family car.
inline VehicleParameters<double> family_car() {
  VehicleParameters<double> p;
  p.mass = 1500.0;
  p.a = 1.2;
  p.b = 1.5;
  p.I_z = 2600.0;
  p.C_f = 55000.0;
  p.C_r = 62000.0;
  return p;
}

inline BicycleModel<double, LinearTyre<double>> linear_bicycle(const VehicleParameters<double>& p) {
  return {.parameters = p, .front = {.stiffness = p.C_f}, .rear = {.stiffness = p.C_r}};
}

/// Steering of a lively drive: twelve sines of random phase between two frequencies, of a given rms.
class WanderingSteer {
 public:
  WanderingSteer(std::uint64_t seed, double rms, double low_Hz = 0.1, double high_Hz = 1.2) : rms_(rms) {
    numerics::RandomStream stream(seed, "wandering steer");
    for (int i = 0; i < kTones; ++i) {
      frequency_.push_back(low_Hz + (high_Hz - low_Hz) * (i + stream.uniform()) / kTones);
      phase_.push_back(stream.uniform(0.0, 2.0 * M_PI));
    }
  }
  double operator()(double t) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < frequency_.size(); ++i) sum += std::sin(2.0 * M_PI * frequency_[i] * t + phase_[i]);
    return rms_ * std::sqrt(2.0 / kTones) * sum * std::min(1.0, 0.5 * t);
  }

 private:
  static constexpr int kTones = 12;
  double rms_;
  std::vector<double> frequency_, phase_;
};

/// Drives a bicycle, which may change with time, by RK4 at 1 ms: independent of the library's simulation.
template <typename Model>
VehicleTrajectory drive_bicycle(const std::function<Model(double)>& model_at, double duration,
                                const std::function<double(double)>& steer,
                                const std::function<double(double)>& speed) {
  VehicleTrajectory out;
  const double h = 1e-3;
  double v = 0.0, r = 0.0, x = 0.0, y = 0.0, psi = 0.0;
  const auto steps = static_cast<long>(std::lround(duration / h));
  for (long k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) * h;
    const Model model = model_at(t);
    const auto rates = [&](double at, double vv, double rr) { return model.rates(vv, rr, steer(at), speed(at)); };
    const auto k1 = rates(t, v, r);
    if (k % 10 == 0) {
      out.time.push_back(t);
      out.x.push_back(x);
      out.y.push_back(y);
      out.yaw.push_back(psi);
      out.u.push_back(speed(t));
      out.v.push_back(v);
      out.r.push_back(r);
      out.steer.push_back(steer(t));
      out.yaw_acceleration.push_back(k1.dr);
      out.longitudinal_acceleration.push_back((speed(t + h) - speed(std::max(0.0, t - h))) / (t > 0.0 ? 2.0 * h : h) -
                                              r * v);
      out.lateral_acceleration.push_back(k1.lateral_acceleration);
    }
    const auto k2 = rates(t + 0.5 * h, v + 0.5 * h * k1.dv, r + 0.5 * h * k1.dr);
    const auto k3 = rates(t + 0.5 * h, v + 0.5 * h * k2.dv, r + 0.5 * h * k2.dr);
    const auto k4 = rates(t + h, v + h * k3.dv, r + h * k3.dr);
    x += h * (speed(t) * std::cos(psi) - v * std::sin(psi));
    y += h * (speed(t) * std::sin(psi) + v * std::cos(psi));
    psi += h * r;
    v += h / 6.0 * (k1.dv + 2.0 * (k2.dv + k3.dv) + k4.dv);
    r += h / 6.0 * (k1.dr + 2.0 * (k2.dr + k3.dr) + k4.dr);
  }
  out.end_time = duration;
  return out;
}

inline VehicleTrajectory lively_drive(const VehicleParameters<double>& p, std::uint64_t seed, double rms = 0.02,
                                      double duration = 60.0) {
  const WanderingSteer steer(seed, rms);
  return drive_bicycle<BicycleModel<double, LinearTyre<double>>>(
      [&](double) { return linear_bicycle(p); }, duration, [&](double t) { return steer(t); },
      [](double t) { return 20.0 + 2.0 * std::sin(0.2 * t); });
}

inline DriveSensorSet perfect_sensors() {
  DriveSensorSet set = reference_drive_sensors();
  for (DriveSensor& s : set.sensors) s = {.enabled = s.enabled, .rate_Hz = s.rate_Hz};
  return set;
}

inline recording::MappedRecording mapped(const Recording& recording) {
  return map_drive_channels(recording, StudyTable());
}

}  // namespace veridyn::vehicle::testing
