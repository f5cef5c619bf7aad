#pragma once

#include <variant>

#include "veridyn/vehicle/tyre/fiala_tyre.hpp"
#include "veridyn/vehicle/tyre/four_fiala_tyres.hpp"
#include "veridyn/vehicle/tyre/four_linear_tyres.hpp"
#include "veridyn/vehicle/tyre/four_magic_formula.hpp"
#include "veridyn/vehicle/tyre/four_simple_magic_formula.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"
#include "veridyn/vehicle/tyre/magic_formula.hpp"
#include "veridyn/vehicle/tyre/magic_formula_moment.hpp"
#include "veridyn/vehicle/tyre/simple_magic_formula.hpp"

// clang-format off
/// Every tyre law, a line each: a vehicle takes any of them, and what is templated on the tyre is compiled for all of
/// them. A macro, as the compiler has no other way to instantiate a template for a list of types.
#define VERIDYN_TYRE_LAWS(LAW) \
  LAW(LinearTyre)              \
  LAW(FialaTyre)               \
  LAW(SimpleMagicFormulaTyre)  \
  LAW(MagicFormulaTyre)
// clang-format on

namespace veridyn::vehicle {

/// Types of tyres, of doubles.
template <typename... Tyres>
struct TyreList {
  /// One of them, wrapped.
  template <template <typename> typename Wrapped>
  using Variant = std::variant<Wrapped<Tyres>...>;

  /// Calls `visit.operator()<Tyre>()` for each in turn.
  template <typename Visit>
  static void for_each(const Visit& visit) {
    (visit.template operator()<Tyres>(), ...);
  }
};

/// A tyre that numbers of a study describe, by its name there; others come from files.
template <typename Tyre>
concept TyreByNumbers = requires {
  Tyre::kStudyName;
};

namespace internal {

template <typename /*Before*/, typename... Tyres>
using TyresAfter = TyreList<Tyres...>;

template <typename... Found>
TyreList<Found...> by_numbers(TyreList<Found...>, TyreList<>);
template <typename... Found, typename Tyre, typename... Rest>
auto by_numbers(TyreList<Found...>, TyreList<Tyre, Rest...>) {
  if constexpr (TyreByNumbers<Tyre>)
    return by_numbers(TyreList<Found..., Tyre>(), TyreList<Rest...>());
  else
    return by_numbers(TyreList<Found...>(), TyreList<Rest...>());
}

}  // namespace internal

// NOLINTNEXTLINE(bugprone-macro-parentheses): the name of a template takes none
#define VERIDYN_NEXT_TYRE(Tyre) , Tyre<double>
/// All tyre laws, of numbers without derivatives.
using AllTyres = internal::TyresAfter<void VERIDYN_TYRE_LAWS(VERIDYN_NEXT_TYRE)>;
#undef VERIDYN_NEXT_TYRE

/// Those that numbers of a study describe.
using AllTyresByNumbers = decltype(internal::by_numbers(TyreList<>(), AllTyres()));

/// A law without its numbers: which of a list is meant.
template <typename Tyre>
struct TyreLaw {
  [[nodiscard]] friend bool operator==(const TyreLaw&, const TyreLaw&) = default;
};

/// The law has a shape of its own, factor C and curvature E.
template <typename Tyre>
concept TyreWithShape = requires(Tyre tyre) {
  tyre.C;
  tyre.E;
};

}  // namespace veridyn::vehicle
