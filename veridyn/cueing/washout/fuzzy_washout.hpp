#pragma once

#include "veridyn/cueing/washout/shared_channels.hpp"

namespace veridyn::cueing {

/// Numbers of the washout with fuzzy gains.
class FuzzyDesign final : public WashoutDesign {
 public:
  SharedKnobs shared;
  double onset = 0.8;       ///< high-pass of surge and sway, second order [rad/s]
  double tilt = 2.0;        ///< low-pass of tilt coordination, second order [rad/s]
  double boldness = 1.4;    ///< gain over nominal while there is room in every direction
  double caution = 0.3;     ///< gain over nominal while the platform nears a limit
  double adaptation = 3.0;  ///< how fast the gain follows [1/s]

  [[nodiscard]] std::vector<Knob> knobs() override;
  [[nodiscard]] std::unique_ptr<Washout> make(const Platform& platform) const override;
  [[nodiscard]] std::unique_ptr<WashoutDesign> clone() const override { return std::make_unique<FuzzyDesign>(*this); }
};

/// Gain over nominal by fuzzy rules of the first order of Takagi & Sugeno 1985 (IEEE Trans Syst Man Cybern 15:116).
/// @param used share of the range in use, 0 to 1 @param outward rate away from neutral over the range [1/s]
[[nodiscard]] double fuzzy_gain(double used, double outward, double boldness, double caution);

/// Classical filters whose gain follows from the room that is left, after Hwang, Yeh, Lin & Su 2009 (IROS): bold while
/// the platform is near neutral or on its way there, cautious as it nears a limit.
class FuzzyWashout final : public Washout {
 public:
  /// @throws InputError as `check_knobs`.
  FuzzyWashout(const FuzzyDesign& design, const Platform& platform);
  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<FuzzyWashout>(*this); }

 private:
  PlatformCommand next(const VehicleMotion& motion, SampleStep step) override;

  struct Pair {
    double shift_range = 0.0, tilt_range = 1.0;  ///< [m], 0: the platform has none; [rad]
    ShiftChannel shift;
    numerics::CausalFilter low_pass;
    TiltCoordination tilt;
    double gain = 1.0;       ///< over nominal
    PairedOutput last = {};  ///< what the gain follows from
    double last_shift = 0.0, shift_rate = 0.0;
    PairedOutput step(const PairedInput& now, const FuzzyDesign& d, SampleStep step);
  };
  [[nodiscard]] static Pair pair_of(const FuzzyDesign& design, const Platform& platform, Eigen::Index pair);

  FuzzyDesign design_;
  SharedChannels shared_;
  std::array<Pair, 2> pairs_;
};

}  // namespace veridyn::cueing
