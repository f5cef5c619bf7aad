#pragma once

#include <string>
#include <string_view>

namespace veridyn::io {

/// Unit of a field of a PX4 topic, since ULog does not carry it, and what the logged number is to be multiplied with to
/// be in it. From the comments in PX4's msg/*.msg for the topics that matter for flight; otherwise from a suffix such
/// as
/// `_m_s`; else {"1", 1}. `field` is the name without indices and without the names of nested messages.
struct Px4Unit {
  std::string unit = "1";
  double scale = 1.0;
};
/// See Px4Unit.
[[nodiscard]] Px4Unit px4_unit(std::string_view topic, std::string_view field);

}  // namespace veridyn::io
