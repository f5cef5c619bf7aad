// From a drive to the tyres of a car: simulate, add the errors of production sensors, identify, and see whether the
// intervals hold the truth. With a recording of your own only the first part changes: read_study.
#include <cmath>
#include <cstdio>

#include "veridyn/core/progress.hpp"
#include "veridyn/vehicle/identification/signals/drive_log.hpp"
#include "veridyn/vehicle/identification/signals/drive_segments.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"
#include "veridyn/vehicle/model/bicycle_model.hpp"
#include "veridyn/vehicle/simulation/drive_sensors.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

int main() {
  using namespace veridyn;
  using namespace veridyn::vehicle;

  // The truth: a family car driven with random steering at 20 m/s for a minute.
  VehicleParameters<double> truth;
  truth.mass = 1500.0;
  truth.a = 1.2;
  truth.b = 1.5;
  truth.I_z = 2600.0;
  truth.C_f = 55000.0;
  truth.C_r = 62000.0;
  const BicycleModel<double, LinearTyre<double>> car{
      .parameters = truth, .front = {.stiffness = truth.C_f}, .rear = {.stiffness = truth.C_r}};
  const Manoeuvre drive = random_steer(0.06, 0.1, 1.5, 60.0);
  Progress silent;
  const VehicleTrajectory trajectory = simulate(car, *drive.driver, {.duration = 60.0, .speed = 20.0}, silent);

  // What production sensors make of it: noise, and biases that nobody knows.
  const Recording recording = record_drive(trajectory, reference_drive_sensors(), 7);

  // Signals on one grid, stretches to identify from and to validate on.
  const DriveSignalOptions signal_options;
  const DriveSignals signals = prepare_drive_signals(map_drive_channels(recording, StudyTable()), signal_options);
  const DriveSegments segments = find_drive_segments(signals, {});
  std::printf("%s\n\n", segments.text.c_str());

  // Known beforehand: mass (within 15 kg) and geometry. Stiffnesses and yaw inertia are guesses to start from.
  VehicleParameters<double> start = truth;
  start.C_f = start.C_r = 80000.0;
  start.I_z = 2000.0;
  VehicleIdentifyOptions options;
  options.mass_sigma = 15.0;
  const VehicleIdentification result = identify_parameters({signals, segments, start, signal_options, options}, silent);

  for (const VehicleMethod method : {VehicleMethod::kGtls, VehicleMethod::kOutputError}) {
    const VehicleEstimate* estimate = result.find(method);
    if (estimate == nullptr || !estimate->usable) continue;
    std::printf("%s\n", std::string(to_string(method)).c_str());
    for (const auto& p : estimate->parameters) {
      std::printf("  %-20s %12.6g  [%.6g, %.6g] %s, %s\n", p.name.c_str(), p.value, p.low95, p.high95, p.unit.c_str(),
                  std::string(estimation::to_string(p.status)).c_str());
    }
  }
  std::printf("\n%s\n", result.reason.c_str());
  const estimation::PredictedQuantity* yaw_rate = result.validation.find("yaw_rate");
  const bool holds =
      result.verdict == estimation::GroupVerdict::kIdentified && yaw_rate != nullptr && yaw_rate->fit.r2 > 0.99;
  return holds ? 0 : 1;
}
