#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string_view>

namespace veridyn::vehicle {

/// Coefficients of the Magic Formula as `.tir` files name them (PAC2002, MF-Tyre 5.2), in the file's convention:
/// SI, radians, slip angle positive where the contact point moves to the LEFT of the wheel plane, so that PKY1 is
/// negative. P: pure slip; R: combined slip; Q, S: moments; L: scaling. X, Y, Z: of F_x, F_y and the aligning moment.
///
/// The defaults are a plain car tyre of no make, symmetric, its friction independent of load; every number not given
/// in a file is 0 (scaling factors: 1).
template <typename Scalar>
struct MagicFormulaCoefficients {
  Scalar FNOMIN{4000.0};         ///< nominal load F_z0 [N]
  Scalar UNLOADED_RADIUS{0.32};  ///< R_0 [m], of the moments only

  // Longitudinal force, pure slip.
  Scalar PCX1{1.6};                                   ///< shape C_x
  Scalar PDX1{1.0}, PDX2{0.0}, PDX3{0.0};             ///< friction mu_x; with load; with camber squared
  Scalar PEX1{0.0}, PEX2{0.0}, PEX3{0.0}, PEX4{0.0};  ///< curvature E_x; with load, load squared; sign of slip
  Scalar PKX1{20.0}, PKX2{0.0}, PKX3{0.0};            ///< slip stiffness K_x/F_z; with load; exponent
  Scalar PHX1{0.0}, PHX2{0.0};                        ///< horizontal shift; with load
  Scalar PVX1{0.0}, PVX2{0.0};                        ///< vertical shift/F_z; with load
  // Longitudinal force, its share under a slip angle.
  Scalar RBX1{0.0}, RBX2{0.0}, RCX1{0.0}, REX1{0.0}, REX2{0.0}, RHX1{0.0};

  // Lateral force, pure slip.
  Scalar PCY1{1.3};                                   ///< shape C_y
  Scalar PDY1{1.0}, PDY2{0.0}, PDY3{0.0};             ///< friction mu_y; with load; with camber squared
  Scalar PEY1{0.0}, PEY2{0.0}, PEY3{0.0}, PEY4{0.0};  ///< curvature E_y; with load; sign of slip, with camber
  Scalar PKY1{-20.0}, PKY2{2.0}, PKY3{0.0};           ///< peak of K_y/F_z0; where [F_z0]; with |camber|
  Scalar PHY1{0.0}, PHY2{0.0}, PHY3{0.0};             ///< horizontal shift; with load; with camber
  Scalar PVY1{0.0}, PVY2{0.0}, PVY3{0.0}, PVY4{0.0};  ///< vertical shift/F_z; with load; camber; both
  // Lateral force, its share under a slip ratio, and what the slip ratio adds.
  Scalar RBY1{0.0}, RBY2{0.0}, RBY3{0.0}, RCY1{0.0}, REY1{0.0}, REY2{0.0}, RHY1{0.0}, RHY2{0.0};
  Scalar RVY1{0.0}, RVY2{0.0}, RVY3{0.0}, RVY4{0.0}, RVY5{0.0}, RVY6{0.0};

  // Aligning moment: pneumatic trail (B, C, D, E, H), residual moment (9, 10 of B; 6 to 9 of D), arm of F_x (SSZ).
  Scalar QBZ1{0.0}, QBZ2{0.0}, QBZ3{0.0}, QBZ4{0.0}, QBZ5{0.0}, QBZ9{0.0}, QBZ10{0.0}, QCZ1{0.0};
  Scalar QDZ1{0.0}, QDZ2{0.0}, QDZ3{0.0}, QDZ4{0.0}, QDZ6{0.0}, QDZ7{0.0}, QDZ8{0.0}, QDZ9{0.0};
  Scalar QEZ1{0.0}, QEZ2{0.0}, QEZ3{0.0}, QEZ4{0.0}, QEZ5{0.0};
  Scalar QHZ1{0.0}, QHZ2{0.0}, QHZ3{0.0}, QHZ4{0.0};
  Scalar SSZ1{0.0}, SSZ2{0.0}, SSZ3{0.0}, SSZ4{0.0};

  // Scaling: of the nominal load; of shape, friction, curvature, stiffness, shifts and camber; of combined slip.
  Scalar LFZO{1.0};
  Scalar LCX{1.0}, LMUX{1.0}, LEX{1.0}, LKX{1.0}, LHX{1.0}, LVX{1.0}, LGAX{1.0};
  Scalar LCY{1.0}, LMUY{1.0}, LEY{1.0}, LKY{1.0}, LHY{1.0}, LVY{1.0}, LGAY{1.0};
  Scalar LXAL{1.0}, LYKA{1.0}, LVYKA{1.0};
  Scalar LTR{1.0}, LRES{1.0}, LGAZ{1.0}, LS{1.0};

  template <typename Other>
  [[nodiscard]] MagicFormulaCoefficients<Other> cast() const;
};

/// A coefficient by its name in tyre files.
template <typename Scalar>
struct MagicFormulaField {
  std::string_view name;
  Scalar MagicFormulaCoefficients<Scalar>::*member;
};

/// Every coefficient, once: what readers, estimators and derivatives go through.
template <typename Scalar>
inline constexpr auto kMagicFormulaFields = [] {
  using C = MagicFormulaCoefficients<Scalar>;
  return std::to_array<MagicFormulaField<Scalar>>({
      {"FNOMIN", &C::FNOMIN}, {"UNLOADED_RADIUS", &C::UNLOADED_RADIUS},
      {"PCX1", &C::PCX1},     {"PDX1", &C::PDX1},
      {"PDX2", &C::PDX2},     {"PDX3", &C::PDX3},
      {"PEX1", &C::PEX1},     {"PEX2", &C::PEX2},
      {"PEX3", &C::PEX3},     {"PEX4", &C::PEX4},
      {"PKX1", &C::PKX1},     {"PKX2", &C::PKX2},
      {"PKX3", &C::PKX3},     {"PHX1", &C::PHX1},
      {"PHX2", &C::PHX2},     {"PVX1", &C::PVX1},
      {"PVX2", &C::PVX2},     {"RBX1", &C::RBX1},
      {"RBX2", &C::RBX2},     {"RCX1", &C::RCX1},
      {"REX1", &C::REX1},     {"REX2", &C::REX2},
      {"RHX1", &C::RHX1},     {"PCY1", &C::PCY1},
      {"PDY1", &C::PDY1},     {"PDY2", &C::PDY2},
      {"PDY3", &C::PDY3},     {"PEY1", &C::PEY1},
      {"PEY2", &C::PEY2},     {"PEY3", &C::PEY3},
      {"PEY4", &C::PEY4},     {"PKY1", &C::PKY1},
      {"PKY2", &C::PKY2},     {"PKY3", &C::PKY3},
      {"PHY1", &C::PHY1},     {"PHY2", &C::PHY2},
      {"PHY3", &C::PHY3},     {"PVY1", &C::PVY1},
      {"PVY2", &C::PVY2},     {"PVY3", &C::PVY3},
      {"PVY4", &C::PVY4},     {"RBY1", &C::RBY1},
      {"RBY2", &C::RBY2},     {"RBY3", &C::RBY3},
      {"RCY1", &C::RCY1},     {"REY1", &C::REY1},
      {"REY2", &C::REY2},     {"RHY1", &C::RHY1},
      {"RHY2", &C::RHY2},     {"RVY1", &C::RVY1},
      {"RVY2", &C::RVY2},     {"RVY3", &C::RVY3},
      {"RVY4", &C::RVY4},     {"RVY5", &C::RVY5},
      {"RVY6", &C::RVY6},     {"QBZ1", &C::QBZ1},
      {"QBZ2", &C::QBZ2},     {"QBZ3", &C::QBZ3},
      {"QBZ4", &C::QBZ4},     {"QBZ5", &C::QBZ5},
      {"QBZ9", &C::QBZ9},     {"QBZ10", &C::QBZ10},
      {"QCZ1", &C::QCZ1},     {"QDZ1", &C::QDZ1},
      {"QDZ2", &C::QDZ2},     {"QDZ3", &C::QDZ3},
      {"QDZ4", &C::QDZ4},     {"QDZ6", &C::QDZ6},
      {"QDZ7", &C::QDZ7},     {"QDZ8", &C::QDZ8},
      {"QDZ9", &C::QDZ9},     {"QEZ1", &C::QEZ1},
      {"QEZ2", &C::QEZ2},     {"QEZ3", &C::QEZ3},
      {"QEZ4", &C::QEZ4},     {"QEZ5", &C::QEZ5},
      {"QHZ1", &C::QHZ1},     {"QHZ2", &C::QHZ2},
      {"QHZ3", &C::QHZ3},     {"QHZ4", &C::QHZ4},
      {"SSZ1", &C::SSZ1},     {"SSZ2", &C::SSZ2},
      {"SSZ3", &C::SSZ3},     {"SSZ4", &C::SSZ4},
      {"LFZO", &C::LFZO},     {"LCX", &C::LCX},
      {"LMUX", &C::LMUX},     {"LEX", &C::LEX},
      {"LKX", &C::LKX},       {"LHX", &C::LHX},
      {"LVX", &C::LVX},       {"LGAX", &C::LGAX},
      {"LCY", &C::LCY},       {"LMUY", &C::LMUY},
      {"LEY", &C::LEY},       {"LKY", &C::LKY},
      {"LHY", &C::LHY},       {"LVY", &C::LVY},
      {"LGAY", &C::LGAY},     {"LXAL", &C::LXAL},
      {"LYKA", &C::LYKA},     {"LVYKA", &C::LVYKA},
      {"LTR", &C::LTR},       {"LRES", &C::LRES},
      {"LGAZ", &C::LGAZ},     {"LS", &C::LS},
  });
}();

static_assert(sizeof(MagicFormulaCoefficients<double>) == kMagicFormulaFields<double>.size() * sizeof(double),
              "every coefficient is in kMagicFormulaFields");

template <typename Scalar>
template <typename Other>
MagicFormulaCoefficients<Other> MagicFormulaCoefficients<Scalar>::cast() const {
  MagicFormulaCoefficients<Other> to;
  for (std::size_t i = 0; i < kMagicFormulaFields<Scalar>.size(); ++i)
    to.*kMagicFormulaFields<Other>[i].member = Other(this->*kMagicFormulaFields<Scalar>[i].member);
  return to;
}

}  // namespace veridyn::vehicle
