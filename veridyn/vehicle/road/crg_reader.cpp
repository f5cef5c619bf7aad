#include "veridyn/vehicle/road/crg_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/text.hpp"

namespace veridyn::vehicle {
namespace {

constexpr double kMissing = kNaN;

std::optional<double> to_number(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

struct Channel {
  bool along_reference = false;  ///< phi, slope, banking
  std::string name;              ///< "PHI"
  std::optional<double> v;       ///< where the file says so
  std::size_t number = 0;        ///< of `long section N`
  std::size_t line = 0;
};

/// View of the bytes of an OpenCRG file, parsed section by section.
class CrgParser {
 public:
  CrgParser(std::string_view bytes, std::string source) : rest_(bytes), source_(std::move(source)) {}

  CrgRoad run() {
    read_header();
    CrgRoad::Grid grid;
    grid.step_u = positive("REFERENCE_LINE_INCREMENT");
    grid.start_u = number_or("REFERENCE_LINE_START_U", 0.0);
    grid.start_x = number_or("REFERENCE_LINE_START_X", 0.0);
    grid.start_y = number_or("REFERENCE_LINE_START_Y", 0.0);
    grid.heading = number_or("REFERENCE_LINE_START_PHI", 0.0);
    refuse_what_is_not_straight(grid);
    Sections sections = place_sections();
    grid.v = std::move(sections.v);
    grid.z = read_values(grid, sections.mirrored);
    return CrgRoad(std::move(grid));
  }

 private:
  struct Entry {
    std::string value;
    std::size_t line = 0;
  };

  [[noreturn]] void fail(std::size_t line, std::string_view what) const {
    throw InputError(line == 0 ? source_ : fmt::format("{}:{}", source_, line), what);
  }

  // ---- header

  void read_header() {
    std::string section;
    std::size_t line_number = 0;
    while (true) {
      const std::size_t end = rest_.find('\n');
      if (end == std::string_view::npos)
        fail(0, line_number == 0 ? "is no OpenCRG file" : "is cut: the header has no end ($$$$)");
      std::string_view line = rest_.substr(0, end);
      rest_.remove_prefix(end + 1);
      ++line_number;
      for (const char c : line) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 && c != '\t' && c != '\r') fail(line_number, "is no OpenCRG file: this line is not text");
      }
      if (line.starts_with("$$$$")) break;
      if (line.starts_with('*')) continue;
      if (section != "CT") line = line.substr(0, line.find('!'));
      line = trimmed(line);
      if (line.empty()) continue;
      if (line.front() == '$') {
        section = upper(trimmed(line.substr(1, line.find_first_of(" !") - 1)));
        if (section == "ROAD_CRG_FILE") fail(line_number, "$ROAD_CRG_FILE: data in another file are not supported");
        continue;
      }
      if (section == "ROAD_CRG") {
        read_key(line, line_number);
      } else if (section == "KD_DEFINITION") {
        read_definition(line, line_number);
      } else if (section == "ROAD_CRG_MODS" || section == "ROAD_CRG_OPTS") {
        fail(line_number, fmt::format("${}: '{}' is not supported", section, shown(line)));
      } else if (section.empty() && line_number > 1000) {
        fail(0, "is no OpenCRG file: no section in 1000 lines");
      }
    }
    if (format_.empty() || channels_.empty())
      fail(0, "is no OpenCRG file: $KD_DEFINITION with a format (#:) and channels (D:) is missing");
  }

  void read_key(std::string_view line, std::size_t number) {
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) fail(number, fmt::format("'{}' is not KEY = value", shown(line)));
    const std::string key = upper(trimmed(line.substr(0, equals)));
    const auto [at, inserted] = keys_.try_emplace(key, Entry{std::string(trimmed(line.substr(equals + 1))), number});
    if (!inserted) fail(number, fmt::format("{} is given twice, first in line {}", shown(key), at->second.line));
  }

  void read_definition(std::string_view line, std::size_t number) {
    if (line.starts_with("#:")) {
      format_ = upper(trimmed(line.substr(2)));
      if (format_ != "LRFI" && format_ != "LDFI" && format_ != "KRBI" && format_ != "KDBI")
        fail(number, fmt::format("format '{}' is not one of LRFI, LDFI, KRBI, KDBI", shown(format_)));
      return;
    }
    if (line.starts_with("U:")) return;  // the same as the increment of $ROAD_CRG
    if (!line.starts_with("D:")) fail(number, fmt::format("'{}' is no definition of a channel", shown(line)));
    const std::size_t comma = line.rfind(',');
    const std::string text = upper(trimmed(line.substr(2, comma == std::string_view::npos ? comma : comma - 2)));
    const std::string_view unit = comma == std::string_view::npos ? "" : trimmed(line.substr(comma + 1));
    Channel channel;
    channel.line = number;
    constexpr std::string_view kReference = "REFERENCE LINE ";
    constexpr std::string_view kSectionAt = "LONG SECTION AT V =";
    constexpr std::string_view kSection = "LONG SECTION ";
    const std::string_view name = text;
    if (name.starts_with(kReference)) {
      channel.along_reference = true;
      channel.name = std::string(name.substr(kReference.size()));
    } else if (name.starts_with(kSectionAt)) {
      channel.v = to_number(name.substr(kSectionAt.size()));
      if (!channel.v || !std::isfinite(*channel.v)) fail(number, fmt::format("'{}' has no position v", shown(line)));
    } else if (name.starts_with(kSection)) {
      const auto index = to_number(name.substr(kSection.size()));
      if (!index || !(*index >= 1.0) || !(*index < 1e6)) fail(number, fmt::format("'{}' has no number", shown(line)));
      channel.number = static_cast<std::size_t>(*index);
    } else {
      fail(number, fmt::format("channel '{}' is not known", shown(line)));
    }
    if (!channel.along_reference && unit != "m") fail(number, fmt::format("'{}': heights must be in m", shown(line)));
    if (channels_.size() >= 100000) fail(number, "has more than 100000 channels");
    channels_.push_back(std::move(channel));
  }

  [[nodiscard]] std::optional<double> number(const std::string& key) const {
    const auto found = keys_.find(key);
    if (found == keys_.end()) return std::nullopt;
    const auto value = to_number(found->second.value);
    if (!value || !std::isfinite(*value))
      fail(found->second.line, fmt::format("{} = {} is not a finite number", shown(key), shown(found->second.value)));
    return value;
  }
  [[nodiscard]] double number_or(const std::string& key, double otherwise) const {
    return number(key).value_or(otherwise);
  }
  [[nodiscard]] std::size_t line_of(const std::string& key) const {
    const auto found = keys_.find(key);
    return found == keys_.end() ? 0 : found->second.line;
  }
  [[nodiscard]] double positive(const std::string& key) const {
    const auto value = number(key);
    if (!value) fail(0, fmt::format("{} is missing", key));
    if (!(*value > 0.0)) fail(line_of(key), fmt::format("{} = {} must be > 0", key, *value));
    return *value;
  }

  void refuse_what_is_not_straight(const CrgRoad::Grid& grid) const {
    for (const char* key :
         {"REFERENCE_LINE_START_S", "REFERENCE_LINE_END_S", "REFERENCE_LINE_START_B", "REFERENCE_LINE_END_B",
          "REFERENCE_LINE_OFFSET_X", "REFERENCE_LINE_OFFSET_Y", "REFERENCE_LINE_OFFSET_Z", "REFERENCE_LINE_OFFSET_PHI",
          "REFERENCE_LINE_START_Z", "REFERENCE_LINE_END_Z"}) {
      if (const double value = number_or(key, 0.0); value != 0.0)
        fail(line_of(key),
             fmt::format("{} = {} is not supported: the reference line must be level and not displaced", key, value));
    }
    const double end = number_or("REFERENCE_LINE_END_PHI", grid.heading);
    if (end != grid.heading)
      fail(line_of("REFERENCE_LINE_END_PHI"), "curved reference lines are not supported: its heading changes");
  }

  // ---- where the long sections are

  /// The lateral positions of the long sections, and whether the file lists them from left to right.
  struct Sections {
    std::vector<double> v;
    bool mirrored = false;
  };
  [[nodiscard]] Sections place_sections() const {
    Sections out;
    std::size_t sections = 0;
    for (const Channel& channel : channels_) sections += channel.along_reference ? 0U : 1U;
    if (sections < 2) fail(0, fmt::format("has {} long sections; at least 2 make a surface", sections));
    const double right = number_or("LONG_SECTION_V_RIGHT", 0.0);
    double step = number_or("LONG_SECTION_V_INCREMENT", 0.0);
    if (step == 0.0 && number("LONG_SECTION_V_LEFT"))
      step = (*number("LONG_SECTION_V_LEFT") - right) / static_cast<double>(sections - 1);
    for (const Channel& channel : channels_) {
      if (channel.along_reference) continue;
      if (!channel.v && !(step > 0.0))
        fail(channel.line, "no LONG_SECTION_V_INCREMENT > 0 says where the long sections are");
      out.v.push_back(channel.v ? *channel.v : right + step * static_cast<double>(channel.number - 1));
    }
    // From right to left, or all the other way round.
    out.mirrored = out.v.back() < out.v.front();
    if (out.mirrored) std::reverse(out.v.begin(), out.v.end());
    for (std::size_t i = 1; i < out.v.size(); ++i) {
      if (!(out.v[i] > out.v[i - 1])) fail(channels_.front().line, "the long sections are not in order of v");
    }
    return out;
  }

  // ---- values

  /// The heights, row by row, for a grid that lacks only them.
  [[nodiscard]] std::vector<float> read_values(const CrgRoad::Grid& grid, bool mirrored) const {
    const bool text = format_.front() == 'L';
    const std::vector<double> values = text ? text_values() : binary_values();
    const std::size_t per_row = channels_.size();
    std::size_t rows = values.size() / per_row;
    if (const auto end = number("REFERENCE_LINE_END_U")) {
      const double expected = std::round((*end - grid.start_u) / grid.step_u) + 1.0;
      if (!(expected >= 2.0) || !(expected <= 1e9))
        fail(line_of("REFERENCE_LINE_END_U"), fmt::format("REFERENCE_LINE_END_U = {} leaves no length", *end));
      if (static_cast<double>(rows) < expected)
        fail(0, fmt::format("is cut: {} of {} cross sections are there", rows, expected));
      rows = static_cast<std::size_t>(expected);
    } else {
      // Without that key the padding of the last binary record must not become a cross section.
      while (rows > 0 && std::all_of(values.begin() + static_cast<std::ptrdiff_t>((rows - 1) * per_row),
                                     values.begin() + static_cast<std::ptrdiff_t>(rows * per_row),
                                     [](double z) { return std::isnan(z); }))
        --rows;
    }
    if (rows < 2) fail(0, "has fewer than two cross sections");
    std::vector<float> z;
    z.reserve(rows * grid.v.size());
    std::vector<double> section;
    for (std::size_t row = 0; row < rows; ++row) {
      section.clear();
      for (std::size_t k = 0; k < per_row; ++k) {
        const double value = values[row * per_row + k];
        if (channels_[k].along_reference) {
          // The first heading or slope is not used by the format.
          const double expected = channels_[k].name == "PHI" ? grid.heading : 0.0;
          if (row > 0 && !std::isnan(value) && value != expected)
            fail(channels_[k].line,
                 fmt::format("reference line {} is not constant: curved, sloped or banked roads are not supported",
                             shown(channels_[k].name)));
        } else {
          if (std::isinf(value) || std::abs(value) > 1e6)
            fail(0, fmt::format("height {} of cross section {} is no height", value, row));
          section.push_back(value);
        }
      }
      if (mirrored) std::reverse(section.begin(), section.end());
      for (const double height : without_missing_heights(section, row)) z.push_back(static_cast<float>(height));
    }
    return z;
  }

  /// Missing heights are those of the nearest section to the right, of the first known one at the edge.
  [[nodiscard]] std::vector<double> without_missing_heights(std::vector<double> section, std::size_t row) const {
    std::size_t known = section.size();
    for (std::size_t i = 0; i < section.size() && known == section.size(); ++i) {
      if (!std::isnan(section[i])) known = i;
    }
    if (known == section.size()) fail(0, fmt::format("cross section {} has no height at all", row));
    for (std::size_t i = 0; i < known; ++i) section[i] = section[known];
    for (std::size_t i = known + 1; i < section.size(); ++i) {
      if (std::isnan(section[i])) section[i] = section[i - 1];
    }
    return section;
  }

  /// Fields of 10 (LRFI) or 20 (LDFI) characters, at most 80 a line; every cross section starts a line.
  [[nodiscard]] std::vector<double> text_values() const {
    const std::size_t width = format_ == "LRFI" ? 10 : 20;
    const std::size_t per_line = 80 / width;
    std::vector<double> values;
    std::string_view rest = rest_;
    std::size_t in_row = 0;
    while (!rest.empty()) {
      const std::size_t end = rest.find('\n');
      std::string_view line = rest.substr(0, end);
      rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (in_row == 0 && (trimmed(line).empty() || line.starts_with('*'))) {
        // A field may start with stars ("**unused**"), a comment has a blank or letter after one.
        if (!line.starts_with("**")) continue;
      }
      const std::size_t expected = std::min(per_line, channels_.size() - in_row);
      for (std::size_t k = 0; k < expected; ++k) {
        const std::size_t from = k * width;
        const std::string_view field = trimmed(from < line.size() ? line.substr(from, width) : std::string_view());
        if (field.empty() && end == std::string_view::npos) return values;  // cut here: counted by the caller
        const auto value = to_number(field);
        // "**unused**", "**missing*" and the like stand for missing values.
        if (!value && !field.starts_with('*'))
          throw InputError(source_, fmt::format("'{}' of cross section {} is not a number", shown(field),
                                                values.size() / channels_.size()));
        values.push_back(value.value_or(kMissing));
      }
      in_row = (in_row + expected) % channels_.size();
    }
    return values;
  }

  /// Big-endian, without a gap; the last record of 80 bytes is filled up with NaN.
  [[nodiscard]] std::vector<double> binary_values() const {
    const std::size_t size = format_ == "KRBI" ? 4 : 8;
    std::vector<double> values(rest_.size() / size);
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::uint64_t bits = 0;
      for (std::size_t k = 0; k < size; ++k) bits = bits << 8 | static_cast<unsigned char>(rest_[i * size + k]);
      values[i] = size == 4 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
                            : std::bit_cast<double>(bits);
    }
    return values;
  }

  std::string_view rest_;
  std::string source_;
  std::string format_;
  std::map<std::string, Entry> keys_;
  std::vector<Channel> channels_;
};

}  // namespace

CrgRoad::CrgRoad(Grid grid) : grid_(std::move(grid)), cos_(std::cos(grid_.heading)), sin_(std::sin(grid_.heading)) {
  VERIDYN_ASSERT(grid_.v.size() >= 2 && grid_.z.size() >= 2 * grid_.v.size() && grid_.z.size() % grid_.v.size() == 0);
}

double CrgRoad::height(const RoadPoint& point) const {
  const double dx = point.x - grid_.start_x;
  const double dy = point.y - grid_.start_y;
  const double u = cos_ * dx + sin_ * dy;
  const double v = cos_ * dy - sin_ * dx;
  const std::size_t columns = grid_.v.size();
  // Written so that NaN stays at the start.
  const double last = static_cast<double>(rows() - 1);
  const double along = u / grid_.step_u > 0.0 ? std::min(u / grid_.step_u, last) : 0.0;
  const std::size_t i = std::min(static_cast<std::size_t>(along), rows() - 2);
  const double s = along - static_cast<double>(i);
  std::size_t j = static_cast<std::size_t>(std::upper_bound(grid_.v.begin(), grid_.v.end(), v) - grid_.v.begin());
  j = std::clamp<std::size_t>(j, 1, columns - 1) - 1;
  const double t = std::clamp((v - grid_.v[j]) / (grid_.v[j + 1] - grid_.v[j]), 0.0, 1.0);
  const float* z = grid_.z.data() + i * columns + j;
  const double near = z[0] + t * (static_cast<double>(z[1]) - z[0]);
  const double far = z[columns] + t * (static_cast<double>(z[columns + 1]) - z[columns]);
  return near + s * (far - near);
}

CrgRoad parse_crg(std::string_view bytes, std::string source) { return CrgParser(bytes, std::move(source)).run(); }

CrgRoad read_crg(const std::filesystem::path& path) { return parse_crg(read_file(path), path.string()); }

}  // namespace veridyn::vehicle
