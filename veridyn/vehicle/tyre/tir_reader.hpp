#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/vehicle/tyre/magic_formula.hpp"

namespace veridyn::vehicle {

/// On which side of the vehicle a tyre is mounted.
enum class TyreSide { kLeft, kRight };

/// A tyre property file: the tyre, and the numbers of its wheel that a vehicle model needs. SI, radians.
struct TirFile {
  std::string source;
  std::string format;                       ///< PROPERTY_FILE_FORMAT as written
  MagicFormulaTyre<double> tyre{};          ///< as measured: of the side `side`
  TyreSide side = TyreSide::kLeft;          ///< TYRESIDE; left where the file does not say
  double nominal_load = 0.0;                ///< FNOMIN [N], without LFZO
  double unloaded_radius = 0.0;             ///< [m]
  double width = 0.0;                       ///< [m]; 0: not given
  double vertical_stiffness = 0.0;          ///< with its scaling LCZ [N/m]; 0: not given
  double vertical_damping = 0.0;            ///< [N s/m]
  std::vector<std::string> unknown_keys{};  ///< in the file, not of PAC2002, and without effect
  std::vector<std::string> warnings{};      ///< one line each: what was assumed, and what is not modelled

  /// The tyre for a side of the vehicle: as measured, or its mirror image.
  [[nodiscard]] MagicFormulaTyre<double> on(TyreSide mounted) const {
    return mounted == side ? tyre : tyre.on_other_side();
  }
};

/// Reads a tyre property file (`.tir`, TeimOrbit format): sections `[NAME]`, lines `KEY = value`, texts in single
/// quotes, comments after `$` or `!`, tables under `{column names}` (skipped).
///
/// Formats: PAC2002, and MF-Tyre 5.2 (PROPERTY_FILE_FORMAT 'MF-TYRE', 'MF_05', 'MF52' with FITTYP 6 or 52), which has
/// the same formulas. The units of [UNITS] hold for lengths, forces, stiffnesses, ranges and pressures; Magic Formula
/// coefficients are dimensionless or in radians whatever [UNITS] gives. Inflation pressure other than nominal (IP,
/// IP_NOM) is put into the coefficients (PPX, PPY). USE_MODE 3 switches combined slip off, a negative one mirrors; a
/// file without R coefficients gets `CombinedSlip::kEquivalentSlip`.
///
/// @throws InputError with file:line for anything that is no such line, numbers that are none or not finite, keys that
/// appear twice, unknown units and formats, missing coefficients without which there is no tyre (all are named), and
/// coefficients outside what the formulas allow.
[[nodiscard]] TirFile read_tir(const std::filesystem::path& path);
/// The same from a text; `source` names it in errors.
[[nodiscard]] TirFile parse_tir(std::string_view text, std::string source);

}  // namespace veridyn::vehicle
