#include "veridyn/io/tables/known_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

namespace veridyn::io::internal {
namespace {

using ColumnUnit = std::pair<std::string_view, std::string_view>;

// FGOutputTextFile.cpp of JSBSim 1.3: what has no unit in the header is in its own, foot, slug and second.
constexpr ColumnUnit kJsbsim[] = {
    {"UBody", "ft/s"},        {"VBody", "ft/s"},         {"WBody", "ft/s"},          {"UdotBody", "ft/s^2"},
    {"VdotBody", "ft/s^2"},   {"WdotBody", "ft/s^2"},    {"UdotBody_i", "ft/s^2"},   {"VdotBody_i", "ft/s^2"},
    {"WdotBody_i", "ft/s^2"}, {"BodyAccel_X", "ft/s^2"}, {"BodyAccel_Y", "ft/s^2"},  {"BodyAccel_Z", "ft/s^2"},
    {"I_{xx}", "slug ft^2"},  {"I_{xy}", "slug ft^2"},   {"I_{xz}", "slug ft^2"},    {"I_{yx}", "slug ft^2"},
    {"I_{yy}", "slug ft^2"},  {"I_{yz}", "slug ft^2"},   {"I_{zx}", "slug ft^2"},    {"I_{zy}", "slug ft^2"},
    {"I_{zz}", "slug ft^2"},  {"Mass", "slug"},          {"Weight", "lbf"},          {"X_{cg}", "in"},
    {"Y_{cg}", "in"},         {"Z_{cg}", "in"},          {"Temperature (R)", "degR"}};

// Data.txt of X-Plane 10 to 12: names of twice five letters, the second of which is the unit or what it is of.
constexpr ColumnUnit kXPlane[] = {
    {"_real,_time", "s"}, {"_totl,_time", "s"},   {"missn,_time", "s"},   {"Gload,norml", "g"},   {"Gload,axial", "g"},
    {"Gload,_side", "g"}, {"hding,_true", "deg"}, {"hding,__mag", "deg"}, {"hpath,_true", "deg"}, {"_Mach,ratio", "1"}};

/// A program by a name that only its tables have.
struct KnownTable {
  std::string_view mark;
  std::span<const ColumnUnit> units;
};
constexpr KnownTable kTables[] = {{"BodyAccel_X", kJsbsim},     {"UBody", kJsbsim},       {"I_{xx}", kJsbsim},
                                  {"Temperature (R)", kJsbsim}, {"missn,_time", kXPlane}, {"_totl,_time", kXPlane},
                                  {"_real,_time", kXPlane}};

// As SIDPAC's own routines use them (compfc.m, compmc.m, massprop.m and the examples of output error).
constexpr SidpacColumn kSidpac[] = {{1, "t", "s"},
                                    {2, "V", "ft/s"},
                                    {3, "beta", "deg"},
                                    {4, "alpha", "deg"},
                                    {5, "p", "deg/s"},
                                    {6, "q", "deg/s"},
                                    {7, "r", "deg/s"},
                                    {8, "phi", "deg"},
                                    {9, "theta", "deg"},
                                    {10, "psi", "deg"},
                                    {11, "ax", "g"},
                                    {12, "ay", "g"},
                                    {13, "az", "g"},
                                    {14, "de", "deg"},
                                    {15, "da", "deg"},
                                    {16, "dr", "deg"},
                                    {27, "qbar", "psf"},
                                    {38, "thrust1", "lbf"},
                                    {39, "thrust2", "lbf"},
                                    {40, "thrust3", "lbf"},
                                    {41, "thrust4", "lbf"},
                                    {42, "pdot", "deg/s^2"},
                                    {43, "qdot", "deg/s^2"},
                                    {44, "rdot", "deg/s^2"},
                                    {48, "mass", "slug"},
                                    {49, "Ixx", "slug ft^2"},
                                    {50, "Iyy", "slug ft^2"},
                                    {51, "Izz", "slug ft^2"},
                                    {52, "Ixz", "slug ft^2"},
                                    {77, "sarea", "ft^2"},
                                    {78, "bspan", "ft"},
                                    {79, "cbar", "ft"}};
constexpr std::size_t kSidpacColumns = 79;

}  // namespace

void add_known_units(std::vector<Header>& headers) {
  const auto has = [&](const KnownTable& table) {
    return std::ranges::find(headers, table.mark, &Header::name) != headers.end();
  };
  const auto* const table = std::ranges::find_if(kTables, has);
  if (table == std::end(kTables)) return;
  for (Header& header : headers) {
    const auto known = std::ranges::find(table->units, header.name, &ColumnUnit::first);
    if (header.unit.empty() && known != table->units.end()) header.unit = known->second;
  }
}

std::vector<Header> sidpac_columns(std::size_t count) {
  std::vector<Header> headers;
  if (count < kSidpacColumns) return headers;
  for (std::size_t i = 1; i <= count; ++i) headers.push_back({fmt::format("fdata({})", i), ""});
  for (const SidpacColumn& column : kSidpac)
    headers[column.number - 1] = {std::string(column.name), std::string(column.unit)};
  return headers;
}

}  // namespace veridyn::io::internal
