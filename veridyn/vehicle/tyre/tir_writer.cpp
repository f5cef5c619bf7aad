#include "veridyn/vehicle/tyre/tir_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace veridyn::vehicle {
namespace {

std::string line(std::string_view key, double value, std::string_view meaning) {
  return fmt::format("{:<24} = {:.12g}  $ {}\n", key, value, meaning);
}

/// Comments must stay in their line.
std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return text;
}

}  // namespace

std::string write_tir(const SimpleMagicFormulaTyre<double>& tyre, const TirNotes& notes) {
  // K = PKY1 F_z0 sin(2 atan(x/PKY2)) is 2 PKY1 F_z0 (x/PKY2)/(1 + (x/PKY2)^2): that of the reduced formula with
  // q = 1/PKY2. In proportion to the load it would be infinite; a thousand errs by 1e-6 (x^2 - 1).
  constexpr double kInProportion = 1e-3;
  const double q = std::max(tyre.stiffness_saturation, kInProportion);
  const double PKY1 = -tyre.stiffness / tyre.nominal_load * (1.0 + q * q) / (2.0 * q);
  std::string text = "[MDI_HEADER]\nFILE_TYPE = 'tir'\nFILE_VERSION = 3.0\nFILE_FORMAT = 'ASCII'\n";
  for (const std::string& comment : notes.comments) text += "$ " + one_line(comment) + "\n";
  text +=
      "[UNITS]\nLENGTH = 'meter'\nFORCE = 'newton'\nANGLE = 'radians'\nMASS = 'kg'\nTIME = 'second'\n"
      "[MODEL]\nPROPERTY_FILE_FORMAT = 'PAC2002'\nTYRESIDE = 'LEFT'\n";
  text += "[DIMENSION]\n" + line("UNLOADED_RADIUS", notes.radius, "m");
  text += "[VERTICAL]\n" + line("FNOMIN", tyre.nominal_load, "nominal load, N");
  if (notes.vertical_stiffness > 0.0) text += line("VERTICAL_STIFFNESS", notes.vertical_stiffness, "N/m");
  text += "[LONGITUDINAL_COEFFICIENTS]\n";
  text += line("PCX1", tyre.C, "shape, as of the lateral force");
  text += line("PDX1", tyre.mu, "friction at the nominal load, as of the lateral force");
  text += line("PDX2", -tyre.mu * tyre.mu_load, "its change with load");
  text += line("PEX1", tyre.E, "curvature, as of the lateral force");
  text += line("PKX1", tyre.slip_stiffness / tyre.nominal_load, "slip stiffness over load");
  text += "[LATERAL_COEFFICIENTS]\n";
  text += line("PCY1", tyre.C, "shape");
  text += line("PDY1", tyre.mu, "friction at the nominal load");
  text += line("PDY2", -tyre.mu * tyre.mu_load, "its change with load");
  text += line("PEY1", tyre.E, "curvature");
  text += line("PKY1", PKY1, "largest cornering stiffness over the nominal load");
  text += line("PKY2", 1.0 / q, "load at which it is reached, over the nominal load");
  return text;
}

}  // namespace veridyn::vehicle
