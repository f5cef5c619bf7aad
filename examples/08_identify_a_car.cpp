// From a drive to the tyres of a car: simulate, add the errors of production sensors, identify, and see whether the
// intervals hold the truth. With a recording of your own only the first part changes: read_study.
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "picture.hpp"
#include "veridyn/vehicle.hpp"

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
  options.given.mass = 15.0;
  const VehicleIdentification result = identify_parameters({signals, segments, start, signal_options, options}, silent);

  const std::map<std::string, double> known = {{"C_f", truth.C_f}, {"C_r", truth.C_r}, {"I_z", truth.I_z}};
  std::vector<std::string> labels;
  std::vector<double> value, low, high, true_value;
  for (const VehicleMethod method : {VehicleMethod::kGtls, VehicleMethod::kOutputError}) {
    const VehicleEstimate* estimate = result.find(method);
    if (estimate == nullptr || !estimate->usable) continue;
    std::printf("%s\n", std::string(to_string(method)).c_str());
    for (const auto& p : estimate->parameters) {
      std::printf("  %-20s %12.6g  [%.6g, %.6g] %s, %s\n", p.name.c_str(), p.value, p.low95, p.high95, p.unit.c_str(),
                  std::string(estimation::to_string(p.status)).c_str());
      if (!known.contains(p.name)) continue;
      labels.push_back(p.name + " by " + std::string(to_string(method)));
      value.push_back(p.value);
      low.push_back(p.low95);
      high.push_back(p.high95);
      true_value.push_back(known.at(p.name));
    }
  }
  picture::write("08_identify_a_car.csv", {{"value", value}, {"low", low}, {"high", high}, {"true", true_value}},
                 labels);
  std::printf("\n%s\n", result.reason.c_str());
  const estimation::PredictedQuantity* yaw_rate = result.validation.find("yaw_rate");
  const bool holds =
      result.verdict == estimation::GroupVerdict::kIdentified && yaw_rate != nullptr && yaw_rate->fit.r2 > 0.99;
  return holds ? 0 : 1;
}
