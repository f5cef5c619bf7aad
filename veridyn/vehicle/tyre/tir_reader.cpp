#include "veridyn/vehicle/tyre/tir_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/vehicle/tyre/tir_lines.hpp"

namespace veridyn::vehicle {
namespace {

using internal::TirLines;

/// A unit by its name in tyre files.
struct UnitWord {
  std::string_view word;
  std::string_view unit;
};
constexpr UnitWord kUnitWords[] = {{"METER", "m"},         {"METRE", "m"},        {"METERS", "m"},
                                   {"MM", "mm"},           {"MILLIMETER", "mm"},  {"CM", "cm"},
                                   {"CENTIMETER", "cm"},   {"KM", "km"},          {"INCH", "in"},
                                   {"FOOT", "ft"},         {"NEWTON", "N"},       {"NEWTONS", "N"},
                                   {"KNEWTON", "kN"},      {"KILO_NEWTON", "kN"}, {"KN", "kN"},
                                   {"POUND_FORCE", "lbf"}, {"LBF", "lbf"},        {"KILOGRAM_FORCE", "kgf"},
                                   {"RADIAN", "rad"},      {"RADIANS", "rad"},    {"RAD", "rad"},
                                   {"DEGREE", "deg"},      {"DEGREES", "deg"},    {"DEG", "deg"},
                                   {"SECOND", "s"},        {"SECONDS", "s"},      {"SEC", "s"},
                                   {"MILLISECOND", "ms"},  {"MINUTE", "min"},     {"HOUR", "h"},
                                   {"KG", "kg"},           {"KILOGRAM", "kg"},    {"GRAM", "gram"},
                                   {"POUND_MASS", "lb"},   {"SLUG", "slug"},      {"PASCAL", "Pa"},
                                   {"PA", "Pa"},           {"KPASCAL", "kPa"},    {"KPA", "kPa"},
                                   {"MPASCAL", "MPa"},     {"BAR", "bar"},        {"PSI", "psi"}};

/// What a unit of [UNITS] is in SI; 1 where the file does not have it.
double scale_of(const TirLines& lines, std::string_view key, std::string_view si) {
  const TirLines::Entry* entry = lines.find(key);
  if (entry == nullptr) return 1.0;
  const std::string word = upper(entry->value);
  for (const UnitWord& known : kUnitWords) {
    if (word != known.word) continue;
    if (known.unit == "kgf") return si == "N" ? kGravity : throw InputError(lines.place(key), "kgf is a force");
    if (known.unit == "MPa") return si == "Pa" ? 1e6 : throw InputError(lines.place(key), "MPa is a pressure");
    try {
      return parse_unit_like(known.unit, parse_unit(si)).scale;
    } catch (const InputError& error) {
      throw InputError(lines.place(key), fmt::format("{}: {}", key, error.what()));
    }
  }
  std::vector<std::string> words;
  for (const UnitWord& known : kUnitWords) words.emplace_back(known.word);
  lines.fail(key, fmt::format("= '{}' is not a known unit; a tyre file's are {}", shown(entry->value),
                              fmt::join(words, ", ")));
}

// Keys of PAC2002 that say nothing about steady forces and the aligning moment.
bool known_without_effect(std::string_view key) {
  constexpr std::string_view kNames[] = {"FILE_TYPE",
                                         "FILE_VERSION",
                                         "FILE_FORMAT",
                                         "LENGTH",
                                         "FORCE",
                                         "ANGLE",
                                         "MASS",
                                         "TIME",
                                         "PRESSURE",
                                         "PROPERTY_FILE_FORMAT",
                                         "FITTYP",
                                         "USE_MODE",
                                         "VXLOW",
                                         "LONGVL",
                                         "TYRESIDE",
                                         "MESSAGES",
                                         "BELT_DYNAMICS",
                                         "CONTACT_MODEL",
                                         "FUNCTION_NAME",
                                         "N_TIRE_STATES",
                                         "MEASURED_SPEED",
                                         "ROAD_INCREMENT",
                                         "USER_SUB_ID",
                                         "UNLOADED_RADIUS",
                                         "WIDTH",
                                         "ASPECT_RATIO",
                                         "RIM_RADIUS",
                                         "RIM_WIDTH",
                                         "BOTTOMING_RADIUS",
                                         "VERTICAL_STIFFNESS",
                                         "VERTICAL_DAMPING",
                                         "BREFF",
                                         "DREFF",
                                         "FREFF",
                                         "FNOMIN",
                                         "DYNAMIC_STIFFNESS",
                                         "DYNAMIC_DAMPING",
                                         "IP",
                                         "IP_NOM",
                                         "LIP",
                                         "LCZ",
                                         "KPUMIN",
                                         "KPUMAX",
                                         "ALPMIN",
                                         "ALPMAX",
                                         "CAMMIN",
                                         "CAMMAX",
                                         "FZMIN",
                                         "FZMAX",
                                         "MBELT",
                                         "LSGKP",
                                         "LSGAL",
                                         "LGYR",
                                         "LMX",
                                         "LVMX",
                                         "LMY",
                                         "LKG",
                                         "MASS1",
                                         "IXX",
                                         "IYY",
                                         "IZZ"};
  if (std::find(std::begin(kNames), std::end(kNames), key) != std::end(kNames)) return true;
  const bool numbered = key.size() >= 4 && key.back() >= '0' && key.back() <= '9';
  for (const std::string_view family : {"PTX", "PTY", "PPX", "PPY", "QSX", "QSY", "QTZ", "QPX", "QPZ"}) {
    if (numbered && key.substr(0, 3) == family) return true;
  }
  return false;
}

std::string checked_format(const TirLines& lines, const std::string& source) {
  const TirLines::Entry* entry = lines.find("PROPERTY_FILE_FORMAT");
  if (entry == nullptr) throw InputError(source, "PROPERTY_FILE_FORMAT is missing: is this a tyre file?");
  const std::string format = upper(entry->value);
  if (format == "PAC2002") return entry->value;
  const bool tno =
      format == "MF-TYRE" || format == "MF_TYRE" || format == "MF_05" || format == "MF05" || format == "MF52";
  if (!tno)
    lines.fail("PROPERTY_FILE_FORMAT",
               fmt::format("is '{}', which is not supported; PAC2002 and MF-Tyre 5.2 are", shown(entry->value)));
  const double version = lines.number_or("FITTYP", format == "MF52" ? 52.0 : 0.0);
  if (version != 6.0 && version != 52.0)
    throw InputError(
        lines.find("FITTYP") != nullptr ? lines.place("FITTYP") : lines.place("PROPERTY_FILE_FORMAT"),
        fmt::format("FITTYP {} of '{}' is not supported; 6 and 52 (MF-Tyre 5.2) are", version, shown(entry->value)));
  return entry->value;
}

MagicFormulaCoefficients<double> read_coefficients(const TirLines& lines, const std::string& source) {
  constexpr std::array<std::string_view, 9> kEssential{
      "FNOMIN", "UNLOADED_RADIUS", "PCX1", "PDX1", "PKX1", "PCY1", "PDY1", "PKY1", "PKY2"};
  std::vector<std::string_view> missing;
  for (const std::string_view key : kEssential) {
    if (lines.find(key) == nullptr) missing.push_back(key);
  }
  if (!missing.empty())
    throw InputError(source, fmt::format("has no {}: without {} there is no tyre (was the file cut?)",
                                         fmt::join(missing, ", "), missing.size() == 1 ? "it" : "them"));
  MagicFormulaCoefficients<double> c;
  for (const MagicFormulaField<double>& field : kMagicFormulaFields<double>) {
    const bool scaling = field.name.front() == 'L';
    c.*field.member = lines.number_or(field.name, scaling ? 1.0 : 0.0);
    if (scaling && !(c.*field.member >= 0.0))
      lines.fail(field.name, fmt::format("= {} is a scaling factor: must be >= 0", c.*field.member));
  }
  return c;
}

/// The ranges with the units of force and angle of the file.
MagicFormulaRange read_ranges(const TirLines& lines, double force, double angle) {
  MagicFormulaRange range;
  const auto read = [&](std::string_view key, double scale, double& limit) {
    if (const auto number = lines.number(key)) limit = scale * *number;
  };
  const auto ordered = [&](std::string_view low, std::string_view high, double lowest, double highest) {
    if (!(lowest < highest)) lines.fail(high, fmt::format("= {} must be above {} = {}", highest, low, lowest));
  };
  read("FZMIN", force, range.load_min);
  read("FZMAX", force, range.load_max);
  read("KPUMIN", 1.0, range.slip_ratio_min);
  read("KPUMAX", 1.0, range.slip_ratio_max);
  read("ALPMIN", angle, range.slip_angle_min);
  read("ALPMAX", angle, range.slip_angle_max);
  read("CAMMIN", angle, range.camber_min);
  read("CAMMAX", angle, range.camber_max);
  if (!(range.load_min >= 0.0)) lines.fail("FZMIN", fmt::format("= {} must be >= 0", range.load_min));
  ordered("FZMIN", "FZMAX", range.load_min, range.load_max);
  ordered("KPUMIN", "KPUMAX", range.slip_ratio_min, range.slip_ratio_max);
  ordered("ALPMIN", "ALPMAX", range.slip_angle_min, range.slip_angle_max);
  ordered("CAMMIN", "CAMMAX", range.camber_min, range.camber_max);
  return range;
}

// (4.E13), (4.E15), (4.E23), (4.E25) with the factors of a pressure that is not the nominal one.
TirFile with_pressure(const TirLines& lines, TirFile file) {
  const double nominal = lines.number_or("IP_NOM", 0.0);
  const double actual = lines.number_or("IP", nominal) * lines.number_or("LIP", 1.0);
  if (!(nominal > 0.0) || actual == nominal) return file;
  const double p = (actual - nominal) / nominal;
  const auto k = [&](std::string_view key) { return lines.number_or(key, 0.0); };
  MagicFormulaCoefficients<double>& c = file.tyre.coefficients;
  const double stiffness_x = 1.0 + p * (k("PPX1") + p * k("PPX2"));
  const double friction_x = 1.0 + p * (k("PPX3") + p * k("PPX4"));
  const double friction_y = 1.0 + p * (k("PPY3") + p * k("PPY4"));
  c.PKX1 *= stiffness_x;
  c.PKX2 *= stiffness_x;
  c.PDX1 *= friction_x;
  c.PDX2 *= friction_x;
  c.PDY1 *= friction_y;
  c.PDY2 *= friction_y;
  c.PKY1 *= 1.0 + p * k("PPY1");
  c.PKY2 *= 1.0 + p * k("PPY2");
  file.vertical_stiffness *= 1.0 + p * k("QPZ1");
  file.warnings.push_back(
      fmt::format("inflation pressure is {:.3g} of nominal: its effect is in the coefficients, "
                  "not in the aligning moment",
                  actual / nominal));
  return file;
}

TirFile with_use_mode(const TirLines& lines, TirFile file) {
  const MagicFormulaCoefficients<double>& c = file.tyre.coefficients;
  const bool weighting = c.RBX1 != 0.0 || c.RBY1 != 0.0 || c.RCX1 != 0.0 || c.RCY1 != 0.0;
  file.tyre.combined_slip = weighting ? CombinedSlip::kWeighting : CombinedSlip::kEquivalentSlip;
  const double mode = lines.number_or("USE_MODE", 4.0);
  const double kind = std::fmod(std::abs(mode), 10.0);
  file.tyre.mirrored = mode < 0.0;
  if (kind == 3.0) {
    file.tyre.combined_slip = CombinedSlip::kNone;
  } else if (kind != 4.0) {
    file.warnings.push_back(fmt::format("USE_MODE {} switches forces off; read as 4, combined slip", mode));
  }
  if (kind != 3.0 && !weighting)
    file.warnings.emplace_back("has no combined slip coefficients (R...): combined slip by an equivalent slip");
  return file;
}

/// Refuses coefficients beyond what the formulas allow; warns where they are changed.
std::vector<std::string> check_admissible(const TirLines& lines, const TirFile& file) {
  std::vector<std::string> warnings;
  const MagicFormulaCoefficients<double>& c = file.tyre.coefficients;
  const auto positive = [&](std::string_view key, double value) {
    if (!(value > 0.0)) lines.fail(key, fmt::format("= {} must be > 0", value));
  };
  positive("FNOMIN", c.FNOMIN);
  positive("UNLOADED_RADIUS", c.UNLOADED_RADIUS);
  positive("PCX1", c.PCX1);
  positive("PDX1", c.PDX1);
  positive("PKX1", c.PKX1);
  positive("PCY1", c.PCY1);
  positive("PDY1", c.PDY1);
  positive("PKY2", c.PKY2);
  for (const std::string_view key : {"LFZO", "LCX", "LMUX", "LKX", "LCY", "LMUY", "LKY"}) {
    positive(key, lines.number_or(key, 1.0));
  }
  if (!(c.PKY1 < 0.0))
    lines.fail("PKY1",
               fmt::format("= {} must be < 0: in this format a positive slip angle gives a negative force", c.PKY1));
  if (!(file.vertical_stiffness >= 0.0))
    lines.fail("VERTICAL_STIFFNESS", fmt::format("= {} must be >= 0", file.vertical_stiffness));
  const double unfit = c.PKX2 < 0.0 ? c.FNOMIN * c.LFZO * (1.0 - 0.9 * c.PKX1 / c.PKX2) : 0.0;
  if (c.PKX2 < 0.0 && file.tyre.range.load_max > unfit)
    warnings.push_back(
        fmt::format("longitudinal stiffness per load falls below a tenth of nominal above {:.0f} N "
                    "(PKX2 = {}), within FZMAX: kept at that tenth",
                    unfit, c.PKX2));
  if (!(file.vertical_damping >= 0.0))
    lines.fail("VERTICAL_DAMPING", fmt::format("= {} must be >= 0", file.vertical_damping));
  // Friction and stiffness are linear and exponential in the load: the ends of the range decide.
  const double highest = std::isfinite(file.tyre.range.load_max) ? file.tyre.range.load_max : c.FNOMIN * c.LFZO;
  const MagicFormulaRange& range = file.tyre.range;
  const double leaning = std::isfinite(range.camber_max) && std::isfinite(range.camber_min)
                             ? std::max(std::abs(range.camber_min), std::abs(range.camber_max))
                             : 0.0;
  for (const double load : {0.0, highest}) {
    for (const double camber : {0.0, leaning}) {
      const auto t = file.tyre.at(load, camber);
      const auto refuse = [&](std::string_view what, std::string_view key, double value) {
        if (value > 0.0 && std::isfinite(value)) return;
        throw InputError(lines.place(key), fmt::format("{} is {} at a load of {} N and a camber of {} rad ({}); must "
                                                       "be > 0",
                                                       what, value, t.Fz, camber, key));
      };
      refuse("longitudinal friction", camber == 0.0 ? "PDX2" : "PDX3", t.mu_x);
      refuse("lateral friction", camber == 0.0 ? "PDY2" : "PDY3", t.mu_y);
      refuse("slip stiffness", "PKX2", t.K_x);
      refuse("cornering stiffness", camber == 0.0 ? "PKY2" : "PKY3", -t.K_y);
    }
  }
  return warnings;
}

}  // namespace

TirFile parse_tir(std::string_view text, std::string source) {
  TirFile file;
  file.source = source;
  const TirLines lines(text, std::move(source));
  file.format = checked_format(lines, file.source);
  file.tyre.coefficients = read_coefficients(lines, file.source);
  const auto unit = [&](std::string_view key, std::string_view si) {
    if (lines.find(key) == nullptr) file.warnings.push_back(fmt::format("[UNITS] has no {}; taken as {}", key, si));
    return scale_of(lines, key, si);
  };
  const double length = unit("LENGTH", "m"), force = unit("FORCE", "N"), angle = unit("ANGLE", "rad"),
               time = unit("TIME", "s");
  if (angle != 1.0)
    file.warnings.emplace_back(
        "angles are not in radians: converted in the ranges; coefficients are in radians always");
  file.tyre.coefficients.FNOMIN *= force;
  file.tyre.coefficients.UNLOADED_RADIUS *= length;
  file.nominal_load = file.tyre.coefficients.FNOMIN;
  file.unloaded_radius = file.tyre.coefficients.UNLOADED_RADIUS;
  file.width = length * lines.number_or("WIDTH", 0.0);
  file.vertical_stiffness = force / length * lines.number_or("VERTICAL_STIFFNESS", 0.0) * lines.number_or("LCZ", 1.0);
  file.vertical_damping = force * time / length * lines.number_or("VERTICAL_DAMPING", 0.0);
  file.tyre.range = read_ranges(lines, force, angle);
  file = with_use_mode(lines, with_pressure(lines, std::move(file)));
  const std::string side = upper(lines.text_or("TYRESIDE", "LEFT"));
  if (side == "RIGHT") {
    file.side = TyreSide::kRight;
  } else if (side != "LEFT") {
    file.warnings.push_back(fmt::format("TYRESIDE is '{}'; taken as LEFT", shown(side)));
  }
  for (std::string& warning : check_admissible(lines, file)) file.warnings.push_back(std::move(warning));

  if (lines.number_or("LKG", 1.0) != 1.0) file.warnings.emplace_back("LKG is not 1; it is not modelled");
  for (const auto& entry : lines.entries()) {
    const std::string& key = entry.first;
    const auto& fields = kMagicFormulaFields<double>;
    const bool coefficient = std::any_of(fields.begin(), fields.end(), [&](const auto& f) { return f.name == key; });
    if (!coefficient && !known_without_effect(key)) file.unknown_keys.push_back(key);
  }
  if (!file.unknown_keys.empty())
    file.warnings.push_back(fmt::format("keys without effect: {}", fmt::join(file.unknown_keys, ", ")));
  return file;
}

TirFile read_tir(const std::filesystem::path& path) { return parse_tir(read_file(path), path.string()); }

}  // namespace veridyn::vehicle
