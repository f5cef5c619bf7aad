#include "veridyn/vehicle/model/vehicle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/estimation/judgement/subject_grades.hpp"
#include "veridyn/vehicle/model/builtin_vehicles.hpp"
#include "veridyn/vehicle/model/subject_keys.hpp"
#include "veridyn/vehicle/model/suspension_study.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle {
namespace {

/// A vehicle while it is read, and which of its parameters are given.
struct KnownVehicle {
  Vehicle vehicle;
  std::array<bool, kVehicleFields.size()> given{};
};

std::size_t index_of(std::string_view name) {
  const auto found =
      std::find_if(kVehicleFields.begin(), kVehicleFields.end(), [&](const VehicleField& f) { return name == f.name; });
  return static_cast<std::size_t>(found - kVehicleFields.begin());
}

/// Typical values, for numbers on which no result depends.
double typical(const VehicleParameters<double>& p, std::size_t field) {
  const double L = p.wheelbase(), m = p.mass;
  const PerWheel<double> load = static_loads(p, kGravity);
  const std::string_view name = kVehicleFields[field].name;
  if (name == "unsprung_mass") return 0.03 * m;
  if (name == "track_f" || name == "track_r") return 0.6 * L;
  if (name == "cg_height") return 0.2 * L;
  if (name == "I_x") return 0.1 * m * L * L;
  if (name == "I_y" || name == "I_z") return m * p.a * p.b;
  // Per radian some twelve times the load that the tyre carries.
  if (name == "C_f") return 12.0 * load[kFrontLeft];
  if (name == "C_r") return 12.0 * load[kRearLeft];
  const bool front = name.ends_with('f');
  // Ride at 1.3 Hz, damped by a third; a tyre ten times as stiff.
  const double corner = load[front ? kFrontLeft : kRearLeft] / kGravity;
  const double K = corner * 8.2 * 8.2;
  if (name == "K_sf" || name == "K_sr") return K;
  if (name == "C_sf" || name == "C_sr") return 2.0 * 0.33 * std::sqrt(K * corner);
  if (name == "K_tf" || name == "K_tr") return 10.0 * K;
  return field_of(p, field);
}

std::vector<std::string_view> needed(VehicleNeeds needs) {
  std::vector<std::string_view> names{"mass", "a", "b"};
  if (needs == VehicleNeeds::kGeometry) return names;
  names.insert(names.end(), {"I_z", "C_f", "C_r"});
  if (needs == VehicleNeeds::kBicycle) return names;
  for (const VehicleField& f : kVehicleFields) {
    const std::string_view name = f.name;
    const bool optional = name == "mu" || name == "K_bf" || name == "K_br";
    if (!optional && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

/// With the parameters that the table gives; both axles by one key first.
KnownVehicle with_parameters(const StudyTable& table, KnownVehicle known) {
  VehicleParameters<double>& p = known.vehicle.parameters;
  constexpr std::array<std::array<std::string_view, 3>, 5> kBoth{{{"track", "track_f", "track_r"},
                                                                  {"K_s", "K_sf", "K_sr"},
                                                                  {"C_s", "C_sf", "C_sr"},
                                                                  {"K_b", "K_bf", "K_br"},
                                                                  {"K_t", "K_tf", "K_tr"}}};
  for (const auto& [both, front, rear] : kBoth) {
    if (!table.has(both)) continue;
    for (const std::string_view name : {front, rear}) {
      const std::size_t i = index_of(name);
      field_of(p, i) = table.number(both, kVehicleFields[i].unit);
      known.given[i] = true;
    }
  }
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    if (!table.has(kVehicleFields[i].name)) continue;
    field_of(p, i) = table.number(kVehicleFields[i].name, kVehicleFields[i].unit);
    known.given[i] = true;
  }
  return known;
}

/// With the axles of `[subject.suspension]`: the rate of a spring by table at rest is K_s, for all that asks for it.
KnownVehicle with_suspension(const StudyTable& subject, KnownVehicle known) {
  if (!subject.has("suspension")) return known;
  const StudyTable table = subject.table("suspension");
  for (const char suffix : {'f', 'r'}) {
    AxleSuspension& axle = suffix == 'f' ? known.vehicle.suspension_f : known.vehicle.suspension_r;
    suspension_keys(suffix).read(table, axle);
    if (axle.spring.empty()) continue;
    const std::string rate = fmt::format("K_s{}", suffix);
    if (subject.has(rate))
      table.fail(fmt::format("force_{}", suffix), fmt::format("takes the place of {}: give one", rate));
    field_of(known.vehicle.parameters, index_of(rate)) = axle.spring.rate(0.0);
    known.given[index_of(rate)] = true;
  }
  return known;
}

/// With the air of `[subject.aerodynamics]`, whose drag and density are also those of longitudinal dynamics.
Vehicle with_air(const StudyTable& subject, Vehicle vehicle) {
  if (!subject.has("aerodynamics")) return vehicle;
  const StudyTable table = subject.table("aerodynamics"), other = subject.table_or_empty("longitudinal");
  for (const char* key : {"drag_area", "air_density"}) {
    if (table.has(key) && other.has(key)) table.fail(key, "is also in [subject.longitudinal]: give one of them");
  }
  LongitudinalParameters& l = vehicle.longitudinal;
  l.drag_area = table.number_or("drag_area", "m^2", l.drag_area);
  l.air_density = table.number_or("air_density", "kg/m^3", l.air_density);
  vehicle.lift = {.area_f = table.number_or("lift_area_f", "m^2", 0.0),
                  .area_r = table.number_or("lift_area_r", "m^2", 0.0),
                  .air_density = l.air_density};
  for (const std::string& why : {inadmissible(vehicle.lift), inadmissible(l)}) {
    if (!why.empty()) throw InputError(table.place(why.substr(0, why.find(' '))), why);
  }
  return vehicle;
}

void check(const StudyTable& subject, const VehicleParameters<double>& p) {
  const std::string why = inadmissible(p);
  if (!why.empty()) throw InputError(subject.place(why.substr(0, why.find(' '))), why);
}

bool is_file(const std::string& tyre) { return tyre.ends_with(".tir") || tyre.ends_with(".TIR"); }

bool tyres_by_files(const StudyTable& subject) {
  const StudyTable details = subject.table_or_empty("tyres");
  return details.has("front") || details.has("rear") || is_file(subject.text_or("tyre", "linear"));
}

/// What is needed and not given; without what tyre files will give.
std::vector<std::string> missing(const KnownVehicle& known, VehicleNeeds needs, bool tyres_by_files) {
  constexpr std::array<std::string_view, 4> kOfTyres{"C_f", "C_r", "K_tf", "K_tr"};
  std::vector<std::string> names;
  for (const std::string_view name : needed(needs)) {
    const bool by_file = tyres_by_files && std::ranges::find(kOfTyres, name) != kOfTyres.end();
    if (!known.given[index_of(name)] && !by_file) names.emplace_back(name);
  }
  return names;
}

/// With what the tyre file of an axle gives apart from the forces.
KnownVehicle with_axle(const TirFile& file, const std::filesystem::path& path, std::string_view stiffness,
                       KnownVehicle known) {
  Vehicle& vehicle = known.vehicle;
  vehicle.inputs.push_back(path);
  for (const std::string& warning : file.warnings)
    vehicle.warnings.push_back(path.filename().string() + ": " + warning);
  const std::size_t i = index_of(stiffness);
  if (!known.given[i] && file.vertical_stiffness > 0.0) {
    field_of(vehicle.parameters, i) = file.vertical_stiffness;
    known.given[i] = true;
  }
  return known;
}

/// With the tyres of files, or the kind of tyres that numbers of the vehicle describe.
KnownVehicle with_tyres(const StudyTable& subject, KnownVehicle known) {
  const StudyTable details = subject.table_or_empty("tyres");
  std::string kind = subject.text_or("tyre", "linear");
  if (tyres_by_files(subject)) {
    std::filesystem::path both = is_file(kind) ? subject.file("tyre") : std::filesystem::path();
    const auto path_of = [&](const char* axle) {
      if (details.has(axle)) return details.file(axle);
      if (both.empty()) details.fail(axle, "is missing: both axles need a tyre file");
      return both;
    };
    const std::filesystem::path front = path_of("front"), rear = path_of("rear");
    const TirFile front_file = read_tir(front), rear_file = read_tir(rear);
    known = with_axle(rear_file, rear, "K_tr", with_axle(front_file, front, "K_tf", std::move(known)));
    // Files are of a tyre for one side: those of the right are brought to the left.
    const AxleTyres<MagicFormulaTyre<double>> tyres{front_file.on(TyreSide::kLeft), rear_file.on(TyreSide::kLeft)};
    VehicleParameters<double>& p = known.vehicle.parameters;
    const PerWheel<double> load = static_loads(p, kGravity);
    p.C_f = tyres.front.symmetric().cornering_stiffness(load[kFrontLeft]);
    p.C_r = tyres.rear.symmetric().cornering_stiffness(load[kRearLeft]);
    known.given[index_of("C_f")] = known.given[index_of("C_r")] = true;
    known.vehicle.tyre_text =
        front == rear ? "Magic Formula of " + front.filename().string()
                      : fmt::format("Magic Formula of {} and {}", front.filename().string(), rear.filename().string());
    known.vehicle.tyres = tyres;
    return known;
  }
  static const std::vector<std::string> kKinds = [] {
    std::vector<std::string> names;
    AllTyresByNumbers::for_each([&]<typename Tyre>() { names.emplace_back(Tyre::kStudyName); });
    return names;
  }();
  kind = subject.choice_or("tyre", kKinds, "linear");
  known.vehicle.tyre_text = kind;
  return known;
}

/// Tyres that are described by numbers of the vehicle.
decltype(Vehicle::tyres) tyres_of(const StudyTable& subject, const Vehicle& vehicle) {
  if (std::holds_alternative<AxleTyres<MagicFormulaTyre<double>>>(vehicle.tyres)) return vehicle.tyres;
  const VehicleParameters<double>& p = vehicle.parameters;
  const StudyTable details = subject.table_or_empty("tyres");
  const double trail = details.number_or("pneumatic_trail", "m", 0.0);
  if (!(std::abs(trail) < 1.0)) details.fail("pneumatic_trail", fmt::format("is {:g} m; must be below 1 m", trail));
  const auto detailed = [&]<typename Tyre>(AxleTyres<Tyre> tyres) {
    for (Tyre* t : {&tyres.front, &tyres.rear}) {
      t->slip_stiffness = details.positive_or("slip_stiffness", "N", t->slip_stiffness);
      t->pneumatic_trail = trail;
      if constexpr (requires { Tyre::study_keys(); }) {
        for (const auto& key : Tyre::study_keys()) t->*key.value = details.number_or(key.name, "1", t->*key.value);
        for (const auto& key : Tyre::study_keys()) {
          const double value = t->*key.value;
          if (key.is_admissible != nullptr && !key.is_admissible(value))
            details.fail(key.name, fmt::format(fmt::runtime(key.otherwise), value));
        }
      }
    }
    return tyres;
  };
  VehicleTyres tyres;
  AllTyresByNumbers::for_each([&]<typename Tyre>() {
    if (vehicle.tyre_text != Tyre::kStudyName) return;
    if (Tyre::kNeedsFriction && !std::isfinite(p.mu))
      subject.fail("tyre", fmt::format("is \"{}\", which needs the friction coefficient `mu`", Tyre::kStudyName));
    tyres = detailed(tyres_by_numbers<Tyre>(p));
  });
  return tyres;
}

/// Of the front tyres [m]; of a file's, what stands for it there.
double pneumatic_trail(const VehicleTyres& tyres) {
  return std::visit(
      []<typename Tyre>(const AxleTyres<Tyre>& t) {
        if constexpr (requires { t.front.pneumatic_trail; })
          return t.front.pneumatic_trail;
        else
          return t.front.coefficients.QDZ1 * t.front.coefficients.UNLOADED_RADIUS;
      },
      tyres);
}

/// A tyre's own numbers, as a study gives them; empty where it has none.
template <typename Tyre>
std::string study_keys_toml(const Tyre& tyre) {
  std::string text;
  if constexpr (requires { Tyre::study_keys(); }) {
    for (const auto& key : Tyre::study_keys()) {
      text += fmt::format("{} = {}", key.name, tyre.*key.value);
      text += key.meaning.empty() ? "\n" : fmt::format("  # {}\n", key.meaning);
    }
  }
  return text;
}

}  // namespace

FourWheelOptions four_wheel_options(const Vehicle& vehicle) {
  FourWheelOptions options;
  options.ackermann = vehicle.ackermann;
  options.camber_per_roll = vehicle.camber_per_roll;
  options.relaxation_length = vehicle.relaxation_length;
  options.suspension_f = vehicle.suspension_f;
  options.suspension_r = vehicle.suspension_r;
  options.lift = vehicle.lift;
  options.aligning_moment = vehicle.aligning_moment;
  options.longitudinal = vehicle.longitudinal;
  return options;
}

bool is_vehicle_study(const StudyTable& root) {
  // Not `has`: a key that `has` looked for counts as known, and these are known in some domains only.
  const auto names_any = [](const StudyTable& table, const auto& wanted) {
    const std::vector<std::string> keys = table.keys();
    return std::ranges::any_of(keys, [&](const std::string& key) { return wanted(key); });
  };
  const auto names = [&](const StudyTable& table, std::string_view key) {
    return names_any(table, [key](std::string_view k) { return k == key; });
  };
  if (names(root, "subject") && root.is_table("subject")) {
    const StudyTable subject = root.table("subject");
    if (names(subject, "kind")) return subject.is_text("kind") && subject.text("kind") == "vehicle";
    if (names(subject, "builtin") && subject.is_text("builtin") &&
        std::ranges::find(builtin_vehicles(), subject.text("builtin"), &BuiltinVehicle::name) !=
            builtin_vehicles().end())
      return true;
    const auto of_vehicles = [](std::string_view key) {
      return key != "mass" && index_of(key) < kVehicleFields.size();
    };
    if (names_any(subject, of_vehicles)) return true;
    if (names(subject, "model")) return false;
  }
  if (names(root, "drive")) return true;
  if (!names(root, "data") || !root.is_table("data") || !names(root.table("data"), "map")) return false;
  const StudyTable map = root.table("data").table_or_empty("map");
  return names(map, "steer") || names(map, "steering_wheel");
}

Vehicle read_vehicle(const StudyTable& subject, VehicleNeeds needs) {
  KnownVehicle known;
  Vehicle& vehicle = known.vehicle;
  VehicleParameters<double>& p = vehicle.parameters;
  static_cast<void>(subject.text_or("kind", "vehicle"));
  subject.accept("grades");
  static_cast<void>(subject.has("accept_rejected"));
  if (subject.has("builtin")) {
    const BuiltinVehicle& builtin = builtin_vehicle(subject.text("builtin"), subject.place("builtin"));
    p = builtin.parameters;
    vehicle.name = builtin.name;
    vehicle.description = builtin.description;
    vehicle.speed = builtin.speed;
    vehicle.suspension_f = builtin.suspension_f;
    vehicle.suspension_r = builtin.suspension_r;
    known.given.fill(true);
  }
  if (vehicle.name.empty()) vehicle.name = "vehicle";
  vehicle_keys().read(subject, vehicle);
  known = with_parameters(subject, std::move(known));
  known = with_suspension(subject, std::move(known));
  refuse_missing(subject, missing(known, needs, tyres_by_files(subject)));
  // What is assumed below follows from these.
  for (const std::string_view name : {"mass", "a", "b"}) {
    const std::size_t i = index_of(name);
    if (!(field_of(p, i) > 0.0))
      subject.fail(name, fmt::format("is {:g} {}; must be > 0", field_of(p, i), kVehicleFields[i].unit));
  }
  known = with_tyres(subject, std::move(known));
  refuse_missing(subject, missing(known, needs, false));
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const std::string_view name = kVehicleFields[i].name;
    if (known.given[i] || name == "mu" || name == "K_bf" || name == "K_br") continue;
    field_of(p, i) = typical(p, i);
    vehicle.assumed.push_back(fmt::format("{} = {:.4g} {}", name, field_of(p, i), kVehicleFields[i].unit));
  }
  check(subject, p);
  vehicle.tyres = tyres_of(subject, vehicle);
  if (subject.has("longitudinal")) longitudinal_keys().read(subject.table("longitudinal"), vehicle.longitudinal);
  vehicle = with_air(subject, std::move(vehicle));
  if (vehicle.aligning_moment && pneumatic_trail(vehicle.tyres) == 0.0)
    subject.fail("aligning_moment", "needs the tyres' pneumatic_trail in [subject.tyres], or tyre files with QDZ1");
  if (needs != VehicleNeeds::kGeometry) {
    if (std::string warning = estimation::grades_warning(subject); !warning.empty())
      vehicle.warnings.push_back(std::move(warning));
  }
  return vehicle;
}

std::array<double, 2> cornering_stiffnesses(const Vehicle& vehicle, double gravity) {
  const PerWheel<double> load = static_loads(vehicle.parameters, gravity);
  return std::visit(
      [&](const auto& t) {
        return std::array<double, 2>{symmetric_tyre(t.front).cornering_stiffness(load[kFrontLeft]),
                                     symmetric_tyre(t.rear).cornering_stiffness(load[kRearLeft])};
      },
      vehicle.tyres);
}

std::string write_vehicle_toml(const Vehicle& vehicle) {
  std::string text = "[subject]\nkind = \"vehicle\"\n";
  const auto quoted = [](std::string on_one_line) {
    std::ranges::replace(on_one_line, '\n', ' ');
    return toml_text(on_one_line);
  };
  text += "name = " + quoted(vehicle.name) + "\n";
  if (!vehicle.description.empty()) text += "description = " + quoted(vehicle.description) + "\n";
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const double value = field_of(vehicle.parameters, i);
    const bool by_table = (i == index_of("K_sf") && !vehicle.suspension_f.spring.empty()) ||
                          (i == index_of("K_sr") && !vehicle.suspension_r.spring.empty());
    if (std::isfinite(value) && !by_table) {
      text += fmt::format("{} = {}  # {}, {}\n", kVehicleFields[i].name, value, kVehicleFields[i].unit,
                          kVehicleFields[i].meaning);
    }
  }
  if (vehicle.aligning_moment) text += "aligning_moment = true\n";
  if (vehicle.relaxation_length > 0.0) text += fmt::format("relaxation_length = {}  # m\n", vehicle.relaxation_length);
  if (std::holds_alternative<AxleTyres<MagicFormulaTyre<double>>>(vehicle.tyres)) {
    if (!vehicle.inputs.empty()) {
      text += "[subject.tyres]\n";
      text += "front = " + quoted(std::filesystem::absolute(vehicle.inputs.front()).string()) + "\n";
      text += "rear = " + quoted(std::filesystem::absolute(vehicle.inputs.back()).string()) + "\n";
    }
  } else {
    text += "tyre = " + quoted(vehicle.tyre_text) + "\n";
    const double trail = pneumatic_trail(vehicle.tyres);
    const std::string keys = std::visit([](const auto& t) { return study_keys_toml(t.front); }, vehicle.tyres);
    if (trail != 0.0 || !keys.empty()) text += "[subject.tyres]\n";
    if (trail != 0.0) text += fmt::format("pneumatic_trail = {}\n", trail);
    text += keys;
  }
  return text + write_suspension_toml(vehicle.suspension_f, vehicle.suspension_r, vehicle.lift);
}

}  // namespace veridyn::vehicle
