#include "veridyn/vehicle/model/subject_keys.hpp"

#include <fmt/format.h>

#include <string_view>

#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/model/builtin_vehicles.hpp"

namespace veridyn::vehicle {
namespace {

/// The numbers of a vehicle, alone and for both axles at once.
std::vector<StudyKey> numbers_of_vehicles() {
  std::vector<StudyKey> keys;
  for (const VehicleField& field : kVehicleFields) keys.push_back({field.name, field.unit, {}, {}, field.meaning});
  for (const std::string_view both : {"track", "K_s", "C_s", "K_b", "K_t"})
    keys.push_back({std::string(both),
                    both == "track" ? "m"
                    : both == "C_s" ? "N s/m"
                                    : "N/m",
                    {},
                    {},
                    fmt::format("`{0}_f` and `{0}_r` at once", both == "track" ? "track" : both)});
  for (std::size_t i = keys.size() - 4; i < keys.size(); ++i)
    keys[i].says = fmt::format("`{0}f` and `{0}r` at once", keys[i].name);
  return keys;
}

StudyKeys tyre_keys() {
  StudyKeys tyres{"subject.tyres", "Details of the tyres.", {}};
  tyres.keys = {{"front", "", "a file", "", "tyre file of the front axle, in place of `tyre`"},
                {"rear", "", "a file", "", "tyre file of the rear axle"},
                {"slip_stiffness", "N", "> 0", "1.3 of the axle's cornering stiffness",
                 "force over longitudinal slip of one tyre; not of files", true},
                {"pneumatic_trail", "m", "between -1 and 1", "\"0 m\"", "what an aligning moment needs; not of files"}};
  AllTyresByNumbers::for_each([&]<typename Tyre>() {
    if constexpr (requires { Tyre::study_keys(); })
      for (const auto& key : Tyre::study_keys())
        tyres.keys.push_back(
            {std::string(key.name), "", "", veridyn::internal::shown(Tyre{}.*key.value, "1"),
             fmt::format("of `tyre = \"{}\"`{}{}", Tyre::kStudyName, key.meaning.empty() ? "" : ": ", key.meaning)});
  });
  return tyres;
}

}  // namespace

const KeyTable<Vehicle>& vehicle_keys() {
  using V = Vehicle;
  static const auto table = KeyTable<V>("subject")
                                .text("name", &V::name, "of the vehicle, in results")
                                .text("description", &V::description, "one sentence")
                                .number("ackermann", &V::ackermann, "1", kAnyNumber, "share of Ackermann geometry")
                                .number("camber_per_roll", &V::camber_per_roll, "1", kAnyNumber,
                                        "camber of the wheels against the road over the body's roll")
                                .number("relaxation_length", &V::relaxation_length, "m", kAnyNumber,
                                        "travel in which slip follows by 63 %; 0: at once")
                                .flag("aligning_moment", &V::aligning_moment,
                                      "the tyres' aligning moments turn the vehicle; needs a pneumatic trail");
  return table;
}

const KeyTable<LongitudinalParameters>& longitudinal_keys() {
  using L = LongitudinalParameters;
  static const auto table =
      KeyTable<L>("subject.longitudinal", "For `longitudinal = true`.")
          .number("front_drive_share", &L::front_drive_share, "1", kAnyNumber, "share of the drive torque in front")
          .number("front_brake_share", &L::front_brake_share, "1", kAnyNumber, "share of the brake torque in front")
          .number("wheel_radius", &L::wheel_radius, "m", kAnyNumber, "loaded")
          .number("wheel_inertia", &L::wheel_inertia, "kg m^2", kAnyNumber, "of one wheel with what turns with it")
          .number("drag_area", &L::drag_area, "m^2", kAnyNumber, "drag coefficient times area")
          .number("air_density", &L::air_density, "kg/m^3", kAnyNumber, "of the air")
          .number("rolling_resistance", &L::rolling_resistance, "1", kAnyNumber, "force over load")
          .number("grade", &L::grade, "rad", kAnyNumber, "of the road, uphill positive")
          .check([](const StudyTable& t, L& l) {
            if (const std::string why = inadmissible(l); !why.empty()) throw InputError(t.path(), why);
          });
  return table;
}

KeyTable<AxleSuspension> suspension_keys(char suffix) {
  using A = AxleSuspension;
  const auto key = [suffix](const char* name) { return fmt::format("{}_{}", name, suffix); };
  const std::string travel = key("travel"), force = key("force");
  return KeyTable<A>("subject.suspension", "Kinematics and compliance; `_f` of the front axle, `_r` of the rear one.")
      .number(key("roll_centre"), &A::roll_centre, "m", kAnyNumber, "height of the roll centre above the road at rest")
      .number(key("roll_steer"), &A::roll_steer, "rad/rad", kAnyNumber,
              "steer of both wheels per roll of the body against the axle, left positive")
      .number(key("bump_steer"), &A::bump_steer, "rad/m", kAnyNumber, "toe-in of each wheel per travel in bump")
      .number(key("compliance_steer"), &A::compliance_steer, "rad/N", kAnyNumber,
              "steer of a wheel per lateral force of its tyre, with the force positive (`\"-0.2 deg/kN\"`)")
      .other(
          {travel, "m", "two numbers or more, growing", "none", "a spring by table in place of K_s: its travel", true},
          [travel, force](const StudyTable& t, const std::string&, A& axle) {
            std::vector<double> travels = t.numbers(travel, "m"), forces = t.numbers(force, "N");
            try {
              axle.spring = SpringCurve(std::move(travels), std::move(forces));
            } catch (const InputError& wrong) {
              t.fail(force, std::string_view(wrong.what()).substr(wrong.place().size() + 2));
            }
          })
      .other({force, "N", "as many, growing", "none", "and its force", true},
             [travel](const StudyTable& t, const std::string&, A&) { static_cast<void>(t.numbers(travel, "m")); })
      .check([suffix](const StudyTable& t, A& axle) {
        if (const std::string why = inadmissible(axle, suffix); !why.empty())
          throw InputError(t.place(why.substr(0, why.find(' '))), why);
      });
}

std::vector<StudyKeys> subject_keys() {
  StudyKeys subject{
      "subject",
      "The vehicle. Identification needs `mass`, `a` and `b`, the bicycle I_z, C_f and C_r too, the "
      "four-wheel model all numbers but `mu` and anti-roll bars; what is missing and not needed is assumed "
      "and listed.",
      {}};
  std::vector<std::string> builtin;
  for (const BuiltinVehicle& vehicle : builtin_vehicles()) builtin.push_back(vehicle.name);
  std::vector<std::string> tyres;
  AllTyresByNumbers::for_each([&]<typename Tyre>() { tyres.emplace_back(Tyre::kStudyName); });
  subject.keys = {
      {"kind", "", "`\"vehicle\"`", "", "what the study is about; not needed beside keys that only vehicles have"},
      {"builtin", "", quoted_list(builtin, "`"), "none", "start from it; other keys override", true},
      {"file", "", "a file", "none", "start from the `[subject]` of it, as `veridyn identify` writes it", true},
      {"accept_rejected", "", "`true`, `false`", "false", "drive a car whose parameters were rejected"},
      {"tyre", "", quoted_list(tyres, "`") + ", or a tyre file (.tir)", "\"linear\"", "law of the tyres"}};
  const auto add = [&](const std::vector<StudyKey>& more) {
    subject.keys.insert(subject.keys.end(), more.begin(), more.end());
  };
  add(numbers_of_vehicles());
  add(vehicle_keys().described().front().keys);
  StudyKeys suspension = suspension_keys('f').described().front();
  const std::vector<StudyKey> rear = suspension_keys('r').described().front().keys;
  suspension.keys.insert(suspension.keys.end(), rear.begin(), rear.end());
  StudyKeys air{"subject.aerodynamics", "Drag and lift of the air.", {}};
  air.keys = {{"lift_area_f", "m^2", "", "0", "lift coefficient times area at the front axle, upward positive"},
              {"lift_area_r", "m^2", "", "0", "at the rear axle"},
              {"drag_area", "m^2", "", "that of `[subject.longitudinal]`", "drag coefficient times area", true},
              {"air_density", "kg/m^3", "", "that of `[subject.longitudinal]`", "of the air", true}};
  return {std::move(subject), tyre_keys(), std::move(suspension), std::move(air),
          longitudinal_keys().described().front()};
}

}  // namespace veridyn::vehicle
