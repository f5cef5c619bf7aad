#include "tests/vehicle/campaign/campaign.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "tests/vehicle/cars.hpp"
#include "tests/vehicle/simulated_drive.hpp"
#include "tests/vehicle/simulation/drives.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/model/builtin_vehicles.hpp"

namespace veridyn::vehicle::testing {
namespace {

constexpr double kDuration_s = 90.0;
/// Of the road car [rad/(m/s^2)].
constexpr double kRollGradient = 0.0089;

class OneThread : public Progress {
 public:
  [[nodiscard]] int threads() const override { return 1; }
};

VehicleTrajectory bicycle_drive(const VehicleParameters<double>& p, double speed, std::uint64_t seed) {
  const WanderingSteer steer(seed, 0.02);
  return drive_bicycle<BicycleModel<double, LinearTyre<double>>>(
      [&](double) { return linear_bicycle(p); }, kDuration_s, [&](double t) { return steer(t); },
      [&](double t) { return speed * (1.0 + 0.35 * std::sin(0.2 * t)); });
}

VehicleTrajectory four_wheel_drive(const VehicleParameters<double>& p, double speed, std::uint64_t seed,
                                   double steer_rms = 0.015) {
  const WanderingSteer steer(seed, steer_rms);
  SimulationOptions options;
  options.speed = speed;
  options.duration = kDuration_s;
  return drive(
      linear_car(p), [&](double t) { return Controls{.steer = steer(t)}; }, options);
}

/// A study of what the sensors of a drive recorded. Mass and place of the centre of gravity are known.
VehicleStudy study_of(const std::string& name, const VehicleParameters<double>& p, const VehicleTrajectory& trajectory,
                      std::uint64_t seed, double roll_gradient) {
  DriveSensorSet sensors = reference_drive_sensors();
  sensors[DriveSensorKind::kPosition].enabled = true;
  const std::string text = fmt::format(
      "seed = {}\n[subject]\nkind = \"vehicle\"\nname = \"{}\"\nmass = {}\na = {}\nb = {}\n[signals]\nroll_gradient = "
      "{}\n"
      "[segments]\nmin_speed = 1\n",
      seed, name, p.mass, p.a, p.b, roll_gradient);
  OneThread silent;
  VehicleStudy out = read_study(Study::parse(text, name + ".toml"), record_drive(trajectory, sensors, seed), silent);
  out.truth = {{"C_f", p.C_f}, {"C_r", p.C_r}, {"I_z", p.I_z}, {"understeer_gradient", understeer_gradient(p)}};
  return out;
}

/// Whether the program says less of this drive than of the clean one.
bool is_found(const IdentifiedDrive& drive, const IdentifiedDrive& clean) {
  const estimation::Judgement &now = drive.analysis.estimate.judgement, &then = clean.analysis.estimate.judgement;
  return drive.refused || now.data.grade > then.data.grade || now.parameters.grade > then.parameters.grade ||
         now.prediction.grade > then.prediction.grade;
}

test::Outcomes outcomes_of(const IdentifiedDrive& drive) {
  return {.refused = drive.refused,
          .message = drive.message,
          .evidence = drive.analysis.estimate.evidence,
          .confidence = drive.confidence};
}

}  // namespace

const std::vector<std::string>& campaign_vehicles() {
  static const std::vector<std::string> names{"reference bicycle", "reference_1to5 bicycle", "reference four-wheel"};
  return names;
}

VehicleStudy campaign_drive(const std::string& vehicle, std::uint64_t seed) {
  const std::string builtin = vehicle.substr(0, vehicle.find(' '));
  const bool rolls = vehicle.ends_with("four-wheel");
  const BuiltinVehicle& known = builtin_vehicle(builtin);
  const VehicleParameters<double> p = rolls ? road_car() : known.parameters;
  const VehicleTrajectory trajectory =
      rolls ? four_wheel_drive(p, known.speed, seed) : bicycle_drive(p, 0.9 * known.speed, seed);
  // What the sensors of the drive do is known; what the body does is what its owner can measure.
  return study_of(vehicle, p, trajectory, seed, rolls ? kRollGradient : 0.0);
}

VehicleStudy gentle_drive(std::size_t number, RollKnown roll) {
  const auto i = static_cast<double>(number);
  VehicleParameters<double> p = road_car();
  // Springs of 0.7 to 1.3 times: a body that leans more and less.
  const double springs = 0.7 + 0.2 * std::fmod(i, 4.0);
  p.K_sf *= springs;
  p.K_sr *= springs;
  const double speed = 14.0 + 1.0 * std::fmod(i, 12.0);
  constexpr std::array<double, 3> kLateral{0.5, 0.8, 1.1};  // rms [m/s^2]
  const double steer_rms = kLateral[number % 3] * p.wheelbase() / (speed * speed) + 0.002;
  const std::uint64_t seed = 100 + number;
  return study_of(fmt::format("rolling car {}", number), p, four_wheel_drive(p, speed, seed, steer_rms), seed,
                  roll == RollKnown::kGiven ? kRollGradient / springs : 0.0);
}

IdentifiedDrive identified(const VehicleStudy& study) {
  OneThread silent;
  IdentifiedDrive drive;
  try {
    drive.analysis = identify(study, silent);
  } catch (const InputError& e) {
    drive.refused = true;
    drive.message = e.what();
    return drive;
  }
  for (const estimation::ParameterGroup& group : drive.analysis.groups)
    if (group.judgement.parameters.grade == estimation::Grade::kYes)
      drive.confidence.add(group.parameters, drive.analysis.truth);
  return drive;
}

test::Trial try_fault(const VehicleStudy& study, const IdentifiedDrive& clean, const DriveFault& fault) {
  VehicleStudy faulty = study;
  fault.apply(faulty);
  const IdentifiedDrive drive = identified(faulty);
  test::Trial trial = test::tried(outcomes_of(drive), outcomes_of(clean), is_found(drive, clean), fault.rows);
  trial.subject = study.subject_name;
  trial.fault = fault.name;
  if (drive.refused) return trial;
  trial.data = to_string(drive.analysis.estimate.judgement.data.grade);
  trial.parameters = to_string(drive.analysis.estimate.judgement.parameters.grade);
  return trial;
}

}  // namespace veridyn::vehicle::testing
