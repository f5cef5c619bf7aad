#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/cueing/platform/platform.hpp"
#include "veridyn/cueing/washout/foresight.hpp"
#include "veridyn/cueing/washout/washout.hpp"

namespace veridyn::cueing {

/// A number of an algorithm that its user may turn.
struct Knob {
  std::string name;                       ///< key in `[washout]`
  std::string unit;                       ///< SI
  std::span<double> values;               ///< where they are kept: one, or one an axis
  std::string feel;                       ///< what the driver feels when it is turned up
  bool zero = false;                      ///< whether zero is allowed; below zero never is
  double tune_from = 0.0, tune_to = 0.0;  ///< where the automatic tuning looks; the same: nowhere
};

/// Reads the knobs that the table names. @throws InputError with file, line and key.
void read_knobs(const StudyTable& table, std::span<const Knob> knobs);
/// @throws InputError "washout.onset: is 0; must be above 0".
void check_knobs(std::span<const Knob> knobs);

/// The design, its knobs checked.
template <typename Design>
[[nodiscard]] Design checked(Design design) {
  check_knobs(design.knobs());
  return design;
}

/// The numbers of an algorithm, before it runs: what a study sets and the automatic tuning turns.
class WashoutDesign {
 public:
  virtual ~WashoutDesign() = default;
  /// They point into this design.
  [[nodiscard]] virtual std::vector<Knob> knobs() = 0;
  /// The algorithm for a platform. @throws InputError as `check_knobs`, and where the platform lacks what it needs.
  [[nodiscard]] virtual std::unique_ptr<Washout> make(const Platform& platform) const = 0;
  [[nodiscard]] virtual std::unique_ptr<WashoutDesign> clone() const = 0;
  /// What its algorithms foresee from; those that do not plan ahead have no use for it.
  virtual void foresee_from(const Foresight& /*foresight*/) {}

 protected:
  WashoutDesign() = default;
  WashoutDesign(const WashoutDesign&) = default;
  WashoutDesign& operator=(const WashoutDesign&) = default;
};

/// An algorithm by its name.
struct WashoutAlgorithm {
  std::string_view name;
  std::string_view summary;  ///< in one line, with its source
  std::unique_ptr<WashoutDesign> (*design)();
};

/// All of them.
[[nodiscard]] std::span<const WashoutAlgorithm> washout_algorithms();
/// @throws InputError with the nearest name.
[[nodiscard]] const WashoutAlgorithm& washout_algorithm(std::string_view name);

}  // namespace veridyn::cueing
