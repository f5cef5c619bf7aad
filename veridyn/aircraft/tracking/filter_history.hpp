#pragma once

#include <array>
#include <string>
#include <vector>

#include "veridyn/aircraft/tracking/tracked_model.hpp"
#include "veridyn/core/recording.hpp"

namespace veridyn::aircraft {

/// Errors of both filters for one quantity, where the truth is known.
struct TrackedFilterError {
  std::string quantity;     ///< "alpha"
  std::string unit;         ///< SI
  double model_free = 0.0;  ///< rms of the model-free filter [unit]
  double guarded = 0.0;     ///< rms of the guarded filter [unit]
};

/// What the guarded filter of a tracked flight made of it, sample by sample, and the models that it was given.
class FilterHistory {
 public:
  /// A model from now on.
  void add_model(FilterModel model) { models_.push_back(std::move(model)); }
  /// Takes the samples of a piece of the flight that come after those taken before; `guarded` of replay_guarded,
  /// `model_free` the model-free filter's on the same stamps.
  void append(const Recording& guarded, const Recording& model_free);

  [[nodiscard]] const std::vector<FilterModel>& models() const { return models_; }
  [[nodiscard]] bool empty() const { return time_.empty(); }
  [[nodiscard]] const std::vector<double>& time() const { return time_; }  ///< [s]
  /// `airspeed`, `alpha`, `beta` with `sigma_...`, `wind_north|east|down`, `model_based`, `guard_ratio`, and of the
  /// model-free filter `airspeed_model_free`, `alpha_model_free`, `beta_model_free`; `model_CL|CD|CY`: where the
  /// coefficient in use comes from (0 none, 1 study, 2 tracked).
  [[nodiscard]] Recording recording() const;
  /// Share of the time in which the estimate was the model-based filter's.
  [[nodiscard]] double model_based_share() const;
  /// When it was the model-free filter's.
  [[nodiscard]] std::vector<TimeSpan> model_free() const;
  /// How often the guard, or the loss of the model, ended the use of the model-based filter.
  [[nodiscard]] std::size_t reverts() const;
  /// One sentence on the above.
  [[nodiscard]] std::string statement() const;
  /// Airspeed and flow angles of both filters against the truth, without the first 10 s.
  [[nodiscard]] std::vector<TrackedFilterError> errors(const Recording& truth) const;

 private:
  static constexpr std::size_t kColumns = 14;
  [[nodiscard]] const std::vector<double>& model_based() const;

  std::vector<FilterModel> models_;
  std::vector<double> time_;
  std::array<std::vector<double>, kColumns> value_;
};

/// The models as CSV: time, reason, and per coefficient its source, sigma and values.
[[nodiscard]] std::string models_csv(const std::vector<FilterModel>& models);

}  // namespace veridyn::aircraft
