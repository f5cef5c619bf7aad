#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/tables/csv_header.hpp"

namespace veridyn::io::internal {

/// Gives columns without a unit that which the program has that writes such a table: of JSBSim's `BodyAccel_X` (ft/s^2)
/// and X-Plane's `Gload,norml` (g), recognised by names that no other has.
void add_known_units(std::vector<Header>& headers);

/// A column of SIDPAC's standard array `fdata`.
struct SidpacColumn {
  std::size_t number = 0;  ///< from 1, as SIDPAC counts them
  std::string_view name;
  std::string_view unit;
};

/// Names and units of the columns of an array `fdata` of so many columns, those that are not known called `fdata(17)`;
/// empty where there are too few for the standard of Klein and Morelli's "System IDentification Programs for AirCraft".
[[nodiscard]] std::vector<Header> sidpac_columns(std::size_t count);

}  // namespace veridyn::io::internal
