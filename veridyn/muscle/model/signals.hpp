#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/muscle/model/model.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::muscle {

/// Columns of a .sto, .mot or .csv file over one time.
struct SignalTable {
  std::string source;
  std::vector<std::string> names;
  std::vector<double> time;                 ///< [s], strictly increasing
  std::vector<std::vector<double>> values;  ///< by column
  /// True for storage files with `inDegrees=yes`: rotations, which only a model knows, are in degrees. The columns of a
  /// CSV are in SI already.
  bool rotations_in_degrees = false;
  /// A storage file of OpenSim's: speeds are those of `opensim_speeds`. Elsewhere they are rates of the coordinates.
  bool storage = false;

  /// Index of the column that means `name` in one of the ways OpenSim and this program write it: "name",
  /// "name.suffix", "name_suffix", "/jointset/.../name", "/forceset/name/suffix"; -1 when there is none.
  [[nodiscard]] int find(std::string_view name, std::string_view suffix) const;
};

/// @throws InputError with file and line for what the format refuses, time that does not increase, missing cells.
[[nodiscard]] SignalTable read_signals(const std::filesystem::path& path);

/// Refuses a column that has a cell without a finite value. @throws InputError naming column and time.
void check_finite(const SignalTable& table, std::size_t column);
/// A zero-phase low-pass for the table's samples: passes what is below the cut-off, stops what is above 1.5 times it.
/// @throws InputError when samples are not evenly spaced or too few.
[[nodiscard]] numerics::FirKernel low_pass_of(const SignalTable& table, double cut_off_Hz);

struct ExternalLoads;

/// A motion as functions of time, one a coordinate of the model; quintic splines through the samples.
struct Motion {
  double begin = 0.0, end = 0.0;                                         ///< [s]
  std::vector<std::optional<numerics::PiecewisePolynomial>> coordinate;  ///< in the model's order; rad or m
  /// Coordinates of the model that the file does not have.
  std::vector<std::string> missing;
  /// Coordinates that leave their range by more than a thousandth of it.
  std::vector<std::string> beyond_range;
  /// Forces of the surroundings during the motion; null: none.
  std::shared_ptr<const ExternalLoads> external = {};
};

/// How a motion is made of samples.
struct MotionOptions {
  /// Pass band of a zero-phase low-pass (FIR, 60 dB at 1.5 times it); 0: none [Hz]
  double low_pass_Hz = 0.0;
};

/// The motion in a table. @throws InputError when no column is a coordinate of the model, or the samples are too
/// few or too uneven for the low-pass.
[[nodiscard]] Motion make_motion(const SignalTable& table, const Model& model, const MotionOptions& options = {});

/// How signals continue between their samples.
enum class Interpolation {
  kLinear,  ///< on a line to the next sample, as OpenSim's controllers do
  kHold,    ///< constant until the next sample: a control that was held over windows
};

/// Functions of time for a list of names (excitations of muscles, controls of actuators), evaluated together. Constant
/// before the first and after the last sample.
class ControlSignals {
 public:
  ControlSignals() = default;
  /// Constants.
  explicit ControlSignals(std::vector<double> constant);
  /// `values` is times x names, row after row.
  ControlSignals(std::vector<double> time, std::vector<double> values, std::size_t names, Interpolation interpolation);

  [[nodiscard]] std::size_t size() const { return names_; }
  /// Writes the values at `time` to `out`, as many as `size()`. Does not allocate.
  void evaluate(double time, double* out) const;
  /// The first instant after `time` at which a value or a slope jumps; infinite when there is none.
  [[nodiscard]] double next_break(double time) const;
  [[nodiscard]] std::span<const double> times() const { return time_; }
  [[nodiscard]] std::span<const double> row(std::size_t index) const {
    return {values_.data() + index * names_, names_};
  }
  [[nodiscard]] Interpolation interpolation() const { return interpolation_; }

 private:
  std::size_t names_ = 0;
  Interpolation interpolation_ = Interpolation::kHold;
  std::vector<double> time_;
  std::vector<double> values_;
};

/// Excitations of all muscles from a table; muscles without a column keep `otherwise`. @throws InputError when no
/// column is a muscle of the model, naming muscle and time for values that are not within 0 .. 1.
[[nodiscard]] ControlSignals make_excitations(const SignalTable& table, const Model& model,
                                              std::span<const double> otherwise, Interpolation interpolation);

}  // namespace veridyn::muscle
