#include "veridyn/muscle/model/signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/io/opensim/storage.hpp"
#include "veridyn/io/read.hpp"
#include "veridyn/numerics/filters.hpp"

namespace veridyn::muscle {
namespace {

SignalTable from_storage(const io::Storage& storage) {
  SignalTable table;
  table.source = storage.source;
  table.names = storage.labels;
  table.time = storage.time;
  for (std::size_t i = 0; i < storage.columns(); ++i) table.values.push_back(storage.column(i));
  table.rotations_in_degrees = storage.in_degrees;
  table.storage = true;
  return table;
}

SignalTable from_recording(const Recording& recording) {
  SignalTable table;
  table.source = recording.source;
  for (const Channel& channel : recording.channels()) {
    if (table.time.empty()) table.time.assign(channel.times().begin(), channel.times().end());
    if (channel.size() != table.time.size()) {
      throw InputError(recording.source, fmt::format("column '{}' has other times than the first", channel.name));
    }
    table.names.push_back(channel.name);
    table.values.push_back(channel.value);
  }
  for (std::size_t i = 1; i < table.time.size(); ++i) {
    if (!(table.time[i] > table.time[i - 1])) {
      throw InputError(recording.source,
                       fmt::format("time {} after {} does not increase", table.time[i], table.time[i - 1]));
    }
  }
  if (table.time.empty()) throw InputError(recording.source, "has no rows");
  return table;
}

/// "a_b/c" -> last part after the slash.
std::string_view last_part(std::string_view name) {
  const std::size_t slash = name.rfind('/');
  return slash == std::string_view::npos ? name : name.substr(slash + 1);
}

bool means(std::string_view column, std::string_view name, std::string_view suffix) {
  if (last_part(column) == name) return true;
  for (const char separator : {'.', '_', '/'}) {
    const std::string wanted = fmt::format("{}{}{}", name, separator, suffix);
    if (column == wanted || (column.ends_with(wanted) && column[column.size() - wanted.size() - 1] == '/')) return true;
  }
  return false;
}

}  // namespace

int SignalTable::find(std::string_view name, std::string_view suffix) const {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<int>(i);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (means(names[i], name, suffix)) return static_cast<int>(i);
  }
  return -1;
}

SignalTable read_signals(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  if (io::is_storage(text)) return from_storage(io::parse_storage(text, path.string()));
  Recording recording = io::read_recording(path);
  recording.source = path.string();
  // A topic name precedes the column's, except in tables of the form that this program writes.
  return from_recording(recording);
}

numerics::FirKernel low_pass_of(const SignalTable& table, double cut_off_Hz) {
  const std::vector<double>& t = table.time;
  const double rate = t.size() < 2 ? 0.0 : static_cast<double>(t.size() - 1) / (t.back() - t.front());
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (std::abs((t[i] - t[i - 1]) * rate - 1.0) > 0.01) {
      throw InputError(table.source,
                       fmt::format("samples are not evenly spaced near {} s, so it cannot be low-passed", t[i]));
    }
  }
  if (!(3.0 * cut_off_Hz < rate)) {
    throw InputError(table.source,
                     fmt::format("a low-pass of {} Hz needs more than {} samples a second, there are {:.4g}",
                                 cut_off_Hz, 3.0 * cut_off_Hz, rate));
  }
  return numerics::low_pass({.rate_Hz = rate, .pass_Hz = cut_off_Hz, .stop_Hz = 1.5 * cut_off_Hz});
}

void check_finite(const SignalTable& table, std::size_t column) {
  const std::vector<double>& v = table.values[column];
  const auto bad = std::find_if(v.begin(), v.end(), [](double x) { return !std::isfinite(x); });
  if (bad == v.end()) return;
  throw InputError(table.source,
                   fmt::format("column '{}' has no value at {} s", table.names[column], table.time[bad - v.begin()]));
}

Motion make_motion(const SignalTable& table, const Model& model, const MotionOptions& options) {
  Motion motion;
  motion.begin = table.time.front();
  motion.end = table.time.back();
  motion.coordinate.resize(model.coordinates.size());
  std::optional<numerics::FirKernel> kernel;
  if (options.low_pass_Hz > 0.0) kernel = low_pass_of(table, options.low_pass_Hz);
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    const Coordinate& coordinate = model.coordinates[c];
    const int column = table.find(coordinate.name, "value");
    if (column < 0) {
      motion.missing.push_back(coordinate.name);
      continue;
    }
    check_finite(table, static_cast<std::size_t>(column));
    std::vector<double> value = table.values[column];
    if (table.rotations_in_degrees && coordinate.motion == CoordinateMotion::kRotational) {
      for (double& v : value) v *= kDegree;
    }
    const auto [low, high] = std::minmax_element(value.begin(), value.end());
    const double slack = 1e-3 * (coordinate.high - coordinate.low);
    if (*low < coordinate.low - slack || *high > coordinate.high + slack)
      motion.beyond_range.push_back(coordinate.name);
    if (kernel) value = numerics::filter(value, *kernel);
    motion.coordinate[c] = numerics::PiecewisePolynomial::quintic_spline(table.time, value);
  }
  if (motion.missing.size() == model.coordinates.size()) {
    throw InputError(table.source,
                     fmt::format("no column is a coordinate of model '{}'{}", model.name,
                                 suggestion(table.names.empty() ? "" : table.names.front(), motion.missing)));
  }
  return motion;
}

ControlSignals::ControlSignals(std::vector<double> constant)
    : names_(constant.size()), time_{0.0}, values_(std::move(constant)) {}

ControlSignals::ControlSignals(std::vector<double> time, std::vector<double> values, std::size_t names,
                               Interpolation interpolation)
    : names_(names), interpolation_(interpolation), time_(std::move(time)), values_(std::move(values)) {}

void ControlSignals::evaluate(double time, double* out) const {
  const auto after = static_cast<std::size_t>(std::upper_bound(time_.begin(), time_.end(), time) - time_.begin());
  const std::size_t i = after == 0 ? 0 : after - 1;
  const double* a = values_.data() + i * names_;
  if (interpolation_ == Interpolation::kHold || after == 0 || after == time_.size()) {
    std::copy(a, a + names_, out);
    return;
  }
  const double* b = a + names_;
  const double s = (time - time_[i]) / (time_[after] - time_[i]);
  for (std::size_t k = 0; k < names_; ++k) out[k] = a[k] + s * (b[k] - a[k]);
}

double ControlSignals::next_break(double time) const {
  if (time_.size() < 2) return kInfinity;
  const auto after = std::upper_bound(time_.begin(), time_.end(), time);
  return after == time_.end() ? kInfinity : *after;
}

ControlSignals make_excitations(const SignalTable& table, const Model& model, std::span<const double> otherwise,
                                Interpolation interpolation) {
  const std::size_t n = model.muscles.size();
  std::vector<double> values(table.time.size() * n);
  std::size_t found = 0;
  for (std::size_t m = 0; m < n; ++m) {
    const std::string& name = model.muscles[m].name();
    int column = table.find(name, "excitation");
    if (column < 0) column = table.find(name, "control");
    if (column >= 0) {
      ++found;
      check_finite(table, static_cast<std::size_t>(column));
    }
    for (std::size_t i = 0; i < table.time.size(); ++i) {
      const double value = column < 0 ? otherwise[m] : table.values[column][i];
      // Solvers leave a trace of rounding at their bounds.
      constexpr double kRounding = 1e-6;
      if (value < -kRounding || value > 1.0 + kRounding) {
        throw InputError(table.source, fmt::format("excitation of '{}' is {} at {} s, it must be within 0 .. 1", name,
                                                   value, table.time[i]));
      }
      values[i * n + m] = std::clamp(value, 0.0, 1.0);
    }
  }
  if (found == 0) {
    std::vector<std::string> names;
    for (const Muscle& muscle : model.muscles) names.push_back(muscle.name());
    throw InputError(table.source, fmt::format("no column is a muscle of model '{}'{}", model.name,
                                               suggestion(table.names.empty() ? "" : table.names.front(), names)));
  }
  return {table.time, std::move(values), n, interpolation};
}

}  // namespace veridyn::muscle
