#include "veridyn/vehicle/drive_sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"
#include "veridyn/vehicle/model/changed_vehicle.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::IndexInput;
using estimation::Response;

constexpr const char* kCgPosition = "cg_position";
/// Differences below it are rounding, as a share of a metric and in SI units of a signal.
constexpr double kRounding = 1e-9;

/// The places in `kVehicleFields`; that of cg_position is behind them.
std::size_t field_index(std::string_view name) {
  const auto found = std::ranges::find_if(kVehicleFields, [&](const VehicleField& f) { return name == f.name; });
  return static_cast<std::size_t>(found - kVehicleFields.begin());
}

std::vector<IndexInput> numbers_of(const VehicleParameters<double>& p) {
  std::vector<IndexInput> known;
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    if (std::isfinite(field_of(p, i)))
      known.push_back({.name = kVehicleFields[i].name, .unit = kVehicleFields[i].unit, .nominal = field_of(p, i)});
  }
  known.push_back({.name = kCgPosition, .unit = "m", .nominal = p.a});
  return known;
}

/// Those that the driven model uses and that are not zero.
std::vector<std::string> default_inputs(VehicleModelKind model, const VehicleParameters<double>& p) {
  constexpr std::array kBicycle{"mass", "I_z", "C_f", "C_r", "mu"};
  std::vector<std::string> names{kCgPosition};
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const std::string_view name = kVehicleFields[i].name;
    const bool used = model == VehicleModelKind::kFourWheel ? name != "a" && name != "b"
                                                            : std::ranges::find(kBicycle, name) != kBicycle.end();
    if (used && field_of(p, i) != 0.0) names.emplace_back(name);
  }
  return names;
}

/// The vehicle's numbers at a point of the inputs.
VehicleParameters<double> parameters_at(VehicleParameters<double> p, std::span<const IndexInput> inputs,
                                        const Eigen::VectorXd& point) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const double value = point(i);
    if (inputs[i].name == kCgPosition) {
      const double wheelbase = p.wheelbase();
      p.a = value;
      p.b = wheelbase - value;
    } else {
      field_of(p, field_index(inputs[i].name)) = value;
    }
  }
  return p;
}

void check_inputs(std::span<const IndexInput> inputs, const VehicleParameters<double>& nominal) {
  const auto named = [&](std::string_view name) {
    return std::ranges::find_if(inputs, [&](const IndexInput& i) { return i.name == name; });
  };
  for (const char* axle : {"a", "b"}) {
    if (named(axle) != inputs.end() && named(kCgPosition) != inputs.end())
      throw InputError(named(axle)->place, fmt::format("'{}' and '{}' exclude each other: both move the centre of "
                                                       "gravity",
                                                       axle, kCgPosition));
  }
  for (const IndexInput& input : inputs) {
    for (const double end : {input.low, input.high}) {
      const std::string why =
          inadmissible(parameters_at(nominal, std::span(&input, 1), Eigen::VectorXd::Constant(1, end)));
      if (!why.empty()) throw InputError(input.place, fmt::format("{} from {:g}: {}", input.name, end, why));
    }
  }
}

std::vector<double> slip_of(const VehicleTrajectory& t) {
  std::vector<double> beta(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) beta[i] = std::atan2(t.v[i], t.u[i]);
  return beta;
}

/// A signal of a trajectory that is compared with the nominal one.
struct ComparedSignal {
  const char* name;
  const char* unit;
  std::vector<double> value;
};
std::vector<ComparedSignal> signals_of(const VehicleTrajectory& t, const SimulationStudy& study) {
  std::vector<ComparedSignal> list{{"yaw_rate", "rad/s", t.r},
                                   {"lateral_acceleration", "m/s^2", t.lateral_acceleration},
                                   {"sideslip", "rad", slip_of(t)}};
  if (study.four_wheel.longitudinal) list.push_back({"speed", "m/s", t.u});
  if (t.roll.size() != t.size()) return list;
  list.push_back({"roll", "rad", t.roll});
  list.push_back({"pitch", "rad", t.pitch});
  list.push_back({"heave", "m", t.heave});
  return list;
}

double rms_difference(const std::vector<double>& one, const std::vector<double>& other) {
  double sum = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) sum += std::pow(one[i] - other[i], 2);
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, one.size())));
}

double value_of(std::span<const Metric> metrics, const std::string& name) {
  const auto found = std::ranges::find_if(metrics, [&](const Metric& m) { return m.name == name; });
  return found == metrics.end() ? kNaN : found->value;
}

/// View of a study whose vehicle it drives with other numbers, on several threads at once.
class ChangedDrives {
 public:
  explicit ChangedDrives(const DriveSensitivityStudy& study) : study_(study) {
    const SimulationStudy& drive = study.drive;
    const VehicleTrajectory nominal = run(drive.vehicle);
    if (nominal.end != DriveEnd::kCompleted)
      throw std::runtime_error(fmt::format("the nominal drive ends early: {}", nominal.message()));
    for (const Metric& m : metrics_of(nominal, drive.vehicle.parameters)) {
      // The same as the one before in another unit.
      if (!std::isfinite(m.value) || m.unit == "deg/g") continue;
      responses_.push_back({m.name, m.unit, m.value, kRounding * std::abs(m.value)});
    }
    metrics_ = responses_.size();
    nominal_ = signals_of(nominal, drive);
    for (const ComparedSignal& s : nominal_)
      responses_.push_back({fmt::format("{} difference", s.name), s.unit, 0.0, kRounding});
  }

  [[nodiscard]] const std::vector<Response>& responses() const { return responses_; }

  /// Bits of the nominal drive.
  [[nodiscard]] std::uint64_t fingerprint() const {
    numerics::Fingerprint print;
    for (const ComparedSignal& s : nominal_)
      for (const double v : s.value) print.add(v);
    return print.value();
  }

  bool respond(const Eigen::VectorXd& point, std::span<double> values) {
    const VehicleParameters<double> p = parameters_at(study_.drive.vehicle.parameters, study_.inputs, point);
    try {
      const VehicleTrajectory t = run(with_parameters(study_.drive.vehicle, p));
      if (t.end != DriveEnd::kCompleted || t.size() != nominal_.front().value.size()) return false;
      const std::vector<Metric> metrics = metrics_of(t, p);
      for (std::size_t k = 0; k < metrics_; ++k) values[k] = value_of(metrics, responses_[k].name);
      const std::vector<ComparedSignal> signals = signals_of(t, study_.drive);
      for (std::size_t k = 0; k < signals.size(); ++k)
        values[metrics_ + k] = rms_difference(signals[k].value, nominal_[k].value);
    } catch (const InputError&) {
      return false;  // a vehicle whose model needs shorter steps
    }
    return true;
  }

 private:
  /// With a driver that no other thread has at the time; one whose drive failed is not used again, as it may not have
  /// begun.
  [[nodiscard]] VehicleTrajectory run(const Vehicle& vehicle) {
    const SimulationStudy& drive = study_.drive;
    Progress silent;
    std::unique_ptr<Driver> driver = borrow();
    VehicleTrajectory t = simulate(vehicle, drive.model, drive.four_wheel, *driver, drive.road.get(), drive.simulation,
                                   silent, drive.grip);
    if (t.end == DriveEnd::kCompleted) give_back(std::move(driver));
    return t;
  }
  [[nodiscard]] std::unique_ptr<Driver> borrow() {
    const std::scoped_lock lock(mutex_);
    if (drivers_.empty()) return read_simulation_study(study_.root, Progress()).manoeuvre.driver;
    std::unique_ptr<Driver> driver = std::move(drivers_.back());
    drivers_.pop_back();
    return driver;
  }
  void give_back(std::unique_ptr<Driver> driver) {
    const std::scoped_lock lock(mutex_);
    drivers_.push_back(std::move(driver));
  }
  std::vector<Metric> metrics_of(const VehicleTrajectory& t, const VehicleParameters<double>& p) const {
    return manoeuvre_metrics(t, study_.drive.manoeuvre, p, study_.drive.four_wheel.gravity);
  }

  const DriveSensitivityStudy& study_;
  std::vector<Response> responses_;
  std::vector<ComparedSignal> nominal_;
  std::size_t metrics_ = 0;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Driver>> drivers_;  ///< that nobody uses
};

}  // namespace

DriveSensitivityStudy read_drive_sensitivity(const StudyTable& root, const Progress& progress) {
  DriveSensitivityStudy study{.drive = read_simulation_study(root, progress), .root = root};
  const StudyTable table = root.table_or_empty("sensitivity");
  const VehicleParameters<double>& p = study.drive.vehicle.parameters;
  study.options = estimation::read_index_options(table, study.drive.seed);
  if (study.options.method == estimation::IndexMethod::kNone)
    table.fail("method", "= \"none\" leaves nothing to compute; take \"variance\" or \"morris\"");
  study.inputs = estimation::index_inputs(estimation::GivenInputs::keys().read(table), numbers_of(p),
                                          default_inputs(study.drive.model, p));
  check_inputs(study.inputs, p);
  return study;
}

estimation::ResponseIndices analyse_drive(const DriveSensitivityStudy& study, numerics::BlockStore& store,
                                          Progress& progress) {
  ChangedDrives drives(study);
  return estimation::response_indices(
      {.inputs = study.inputs,
       .responses = drives.responses(),
       .run = [&](const Eigen::VectorXd& point, std::span<double> values) { return drives.respond(point, values); },
       .fingerprint = drives.fingerprint()},
      study.options, store, progress);
}

}  // namespace veridyn::vehicle
