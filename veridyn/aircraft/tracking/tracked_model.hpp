#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/reconstruction/guarded_replay.hpp"
#include "veridyn/aircraft/tracking/flight_tracker.hpp"

namespace veridyn::aircraft {

/// Where a coefficient of a filter's model comes from.
enum class ModelSource {
  kNone,    ///< it is not known: CL leaves the model-free filter alone; CD and CY are then as the accelerometer shows
  kStudy,   ///< given beforehand
  kTracked  ///< identified in this flight
};
/// "none", "study", "tracked".
[[nodiscard]] std::string_view to_string(ModelSource source);

/// CL, CD and CY, the coefficients of a force model.
inline constexpr std::array<Coefficient, 3> kForceCoefficients{Coefficient::kCL, Coefficient::kCD, Coefficient::kCY};

/// A model that the guarded filter was given, and why.
struct FilterModel : TimedModel {
  std::array<ModelSource, 3> source{};  ///< of CL, CD, CY
  std::string reason;                   ///< "CL identified"; "CL changed at 161.2 s"
};

/// Decides which of the coefficients that are followed a model-based filter is given, and when.
///
/// A coefficient is taken when its own rows of evidence let it be used (see tracked_evidence: identified), with every
/// combination of parameters excited (what is held was not measured) and an error bar within `model_error` (or its
/// default, where that is larger): with 30 s of a frozen vane in memory CY passes all rows with an error bar of 4000.
/// It is given again when it has moved by more than its error bar, or when that has halved: every new model starts the
/// model-based filter again from the model-free one. Both are seen through the flown regressors: rms of x' d(theta),
/// and sigma^2 = trace(P mean(x x')). That sigma adds to `model_error`. A change that the tracker finds withdraws the
/// coefficient, also that of the study, until it is identified again from rows after `detection_settling`: the aircraft
/// is no longer the one that was known.
///
/// No model confirms itself: the tracker's rows are made of sensors and of the model-free filter, which never sees the
/// model. Rows filtered with the model would show its lift curve in place of the aircraft's wherever the vane is the
/// weaker witness, and the estimate would settle where it began. So the tracker's estimates are the same with and
/// without a guarded filter (a test compares them).
class TrackedModel {
 public:
  /// @param known the subject whose values hold at the start; its values of CL, CD and CY may be missing
  TrackedModel(const Subject& known, const TrackOptions& track, const ReconstructOptions& reconstruct);

  /// The model at the start, at any time.
  [[nodiscard]] FilterModel start() const;
  /// What follows from the tracker as it stands, for a filter that has come to `time` [s]: a new model, or none.
  [[nodiscard]] std::optional<FilterModel> look(const FlightTracker& tracker, double time);

 private:
  struct Known {
    ModelSource source = ModelSource::kNone;
    CoefficientModel model = {};
    double sigma = 0.0;          ///< of the coefficient, through the flown regressors
    std::size_t changes = 0;     ///< that were found when it was last looked at
    double not_before = -1e300;  ///< rows before say nothing [s]
  };
  /// Of the coefficient of that index in `kForceCoefficients`: why a new model is due, or nothing.
  [[nodiscard]] std::string look_at(const TrackedCoefficient& c, const Subject& subject, double time,
                                    std::size_t index);
  [[nodiscard]] FilterModel model_at(double time, std::string reason) const;

  std::array<Known, 3> known_;
  std::optional<StallBlend> stall_;
  std::array<double, 3> model_error_, walk_;
  double settling_s_;
};

}  // namespace veridyn::aircraft
