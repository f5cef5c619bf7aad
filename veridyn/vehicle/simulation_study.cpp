#include "veridyn/vehicle/simulation_study.hpp"

#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "veridyn/core/at_place.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/vehicle/road/road_study.hpp"

namespace veridyn::vehicle {
namespace {

constexpr EnumArray<VehicleModelKind, const char*, 3> kModels{"linear bicycle", "bicycle", "four-wheel"};

FourWheelOptions options_of(const DriveKeys& keys, const Vehicle& vehicle) {
  FourWheelOptions options = four_wheel_options(vehicle);
  options.gravity = keys.gravity;
  options.convention = keys.convention;
  options.geometry = keys.geometry;
  if (!keys.longitudinal) options.longitudinal.reset();
  return options;
}

/// A tyre with a share of its stiffness and friction.
template <typename Tyre>
Tyre slipperier(Tyre tyre, double grip) {
  tyre.stiffness *= grip;
  tyre.slip_stiffness *= grip;
  tyre.mu *= grip;
  return tyre;
}

MagicFormulaTyre<double> slipperier(MagicFormulaTyre<double> tyre, double grip) {
  auto& c = tyre.coefficients;
  for (double* scaling : {&c.LKX, &c.LKY, &c.LMUX, &c.LMUY}) *scaling *= grip;
  return tyre;
}

void read_grip(const StudyTable& drive, const std::string& key, DriveKeys& keys) {
  for (const StudyTable& table : drive.tables(key)) {
    GripChange change;
    change.time = table.number("time", "s");
    if (!keys.grip.empty() && !(change.time > keys.grip.back().time))
      table.fail("time", "must be later than the one before");
    const double both = table.positive_or("grip", "1", 1.0);
    change.front = table.positive_or("front", "1", both);
    change.rear = table.positive_or("rear", "1", both);
    keys.grip.push_back(change);
  }
}

}  // namespace

std::string_view to_string(VehicleModelKind kind) { return kModels[kind]; }

const KeyTable<DriveKeys>& DriveKeys::keys() {
  using K = DriveKeys;
  using S = SimulationOptions;
  const auto simulation = [](auto member) { return [member](K& keys) -> double& { return keys.simulation.*member; }; };
  static const auto table =
      KeyTable<K>("drive", "How the vehicle is driven, whatever the manoeuvre.")
          .choice("model", &K::model,
                  {{kModels[VehicleModelKind::kLinearBicycle], VehicleModelKind::kLinearBicycle},
                   {kModels[VehicleModelKind::kBicycle], VehicleModelKind::kBicycle},
                   {kModels[VehicleModelKind::kFourWheel], VehicleModelKind::kFourWheel}},
                  "what moves")
          .number("speed", &K::speed, "m/s", kPositive, "kept, unless `longitudinal`")
          .otherwise("required, but for a built-in vehicle")
          .other({"manoeuvre", "", quoted_list({manoeuvre_names().begin(), manoeuvre_names().end()}, "`"),
                  "\"reference\"", "the manoeuvre that is driven"},
                 [](const StudyTable&, const std::string&, K&) {})
          .number("duration", &K::duration, "s", kPositive, "of the drive")
          .otherwise("that of the manoeuvre")
          .number("step", simulation(&S::step), "s", kPositive, "of the integration")
          .number("output_step", simulation(&S::output_step), "s", kPositive, "of the results, a multiple of `step`")
          .number("gravity", &K::gravity, "m/s^2", kPositive, "acceleration of free fall")
          .flag("longitudinal", &K::longitudinal,
                "speed follows from torques, drag and grade of `[subject.longitudinal]`")
          .choice(
              "convention", &K::convention,
              {{"first principles", FourWheelConvention::kFirstPrinciples}, {"source", FourWheelConvention::kSource}},
              "`source`: that of the published similarity study")
          .choice("geometry", &K::geometry,
                  {{"exact", BicycleGeometry::kExact}, {"small angles", BicycleGeometry::kSmallAngles}},
                  "of the four-wheel model")
          .other({"change", "", "tables `[[drive.change]]` with `time` and `grip`, or `front` and `rear`", "none",
                  "from `time` on, factor on the tyres' initial stiffness and friction", true},
                 read_grip);
  return table;
}

SimulationStudy read_simulation_study(const StudyTable& root, const Progress& progress) {
  SimulationStudy study;
  study.title = root.text_or("title", "drive");
  const long long seed = root.integer_or("seed", 1);
  if (seed < 0) root.fail("seed", "must not be negative");
  study.seed = static_cast<std::uint64_t>(seed);
  const StudyTable drive = root.table_or_empty("drive");
  const DriveKeys keys = DriveKeys::keys().read(drive);
  study.model = keys.model;
  study.vehicle =
      read_vehicle(root.table("subject"),
                   study.model == VehicleModelKind::kFourWheel ? VehicleNeeds::kFourWheel : VehicleNeeds::kBicycle);
  study.inputs = study.vehicle.inputs;
  study.four_wheel = options_of(keys, study.vehicle);
  if (study.four_wheel.longitudinal && study.model != VehicleModelKind::kFourWheel)
    drive.fail("longitudinal", "needs model = \"four-wheel\"");

  SimulationOptions& s = study.simulation;
  s = keys.simulation;
  if (std::isnan(keys.speed) && !study.vehicle.speed) drive.fail("speed", "is missing");
  s.speed = std::isnan(keys.speed) ? *study.vehicle.speed : keys.speed;
  ManoeuvreContext context{.parameters = study.vehicle.parameters,
                           .speed = s.speed,
                           .gravity = study.four_wheel.gravity,
                           .seed = study.seed,
                           .wheel_radius = study.vehicle.longitudinal.wheel_radius};
  const auto [C_f, C_r] = cornering_stiffnesses(study.vehicle, study.four_wheel.gravity);
  context.C_f = C_f;
  context.C_r = C_r;
  study.manoeuvre = read_manoeuvre(drive, context, progress);
  s.duration = std::isnan(keys.duration) ? study.manoeuvre.default_duration : keys.duration;
  at_place(root.place("drive"), [&] { s.validate(); });
  if (!study.manoeuvre.speed.empty() && !study.four_wheel.longitudinal)
    drive.fail("manoeuvre", "changes its speed, which needs `longitudinal = true`");

  study.grip = keys.grip;
  if (root.has("road")) {
    study.road = read_road(root.table("road"), study.seed);
    if (study.road && study.model != VehicleModelKind::kFourWheel)
      root.fail("road", "needs model = \"four-wheel\": the bicycle does not move up and down");
  }
  if (root.has("sensors")) {
    study.sensors = read_drive_sensors(root.table("sensors"));
    study.sensors->gravity = study.four_wheel.gravity;
  }
  return study;
}

VehicleTrajectory simulate(const Vehicle& vehicle, VehicleModelKind model, const FourWheelOptions& options,
                           Driver& driver, const Road* road, const SimulationOptions& simulation, Progress& progress,
                           std::span<const GripChange> grip) {
  const auto geometry = model == VehicleModelKind::kBicycle ? BicycleGeometry::kExact : BicycleGeometry::kSmallAngles;
  return std::visit(
      [&]<typename Tyre>(const AxleTyres<Tyre>& tyres) {
        // The model of the beginning and those of the changes, made and driven in the same way.
        const auto drive = [&](const auto& make, const auto& run) {
          using Model = decltype(make(tyres));
          std::vector<ModelChange<Model>> changes;
          for (const GripChange& change : grip) {
            const AxleTyres<Tyre> changed{slipperier(tyres.front, change.front), slipperier(tyres.rear, change.rear)};
            changes.push_back({change.time, make(changed)});
          }
          return run(make(tyres), std::span<const ModelChange<Model>>(changes));
        };
        if (model == VehicleModelKind::kFourWheel) {
          return drive(
              [&](const AxleTyres<Tyre>& t) {
                return FourWheelModel<double, Tyre>(vehicle.parameters, mounted(t), options);
              },
              [&](const auto& start, auto changes) {
                return simulate(start, driver, road, simulation, progress, changes);
              });
        }
        return drive(
            [&](const AxleTyres<Tyre>& t) {
              return BicycleModel<double, Tyre>{vehicle.parameters, symmetric_tyre(t.front), symmetric_tyre(t.rear),
                                                options.gravity, geometry};
            },
            [&](const auto& start, auto changes) { return simulate(start, driver, simulation, progress, changes); });
      },
      vehicle.tyres);
}

SimulationRun run_simulation_study(const SimulationStudy& study, Progress& progress) {
  SimulationRun run;
  const VehicleParameters<double>& p = study.vehicle.parameters;
  const double gravity = study.four_wheel.gravity;
  run.trajectory = simulate(study.vehicle, study.model, study.four_wheel, *study.manoeuvre.driver, study.road.get(),
                            study.simulation, progress, study.grip);
  const auto [C_f, C_r] = cornering_stiffnesses(study.vehicle, gravity);
  run.linear = {p.mass, p.I_z, p.a, p.b, C_f, C_r, study.simulation.speed};
  run.characteristics = characteristics(run.linear);
  run.modes = modes(run.linear.A());
  if (study.model == VehicleModelKind::kFourWheel) {
    std::visit(
        [&]<typename Tyre>(const AxleTyres<Tyre>& t) {
          const FourWheelModel<double, Tyre> model(p, mounted(t), study.four_wheel);
          const LinearFourWheel linear = linearise(model, study.simulation.speed);
          run.vehicle_modes = modes(linear);
          run.cornering = steady_cornering(linear, p.wheelbase());
        },
        study.vehicle.tyres);
  }
  if (!run.trajectory.usable()) return run;
  run.metrics = manoeuvre_metrics(run.trajectory, study.manoeuvre, p, gravity);
  if (study.sensors) run.measured = record_drive(run.trajectory, *study.sensors, study.seed);
  return run;
}

}  // namespace veridyn::vehicle
