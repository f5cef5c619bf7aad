#pragma once

#include <cstdint>
#include <vector>

#include "veridyn/vehicle/road/road.hpp"

namespace veridyn::vehicle {

/// G_d(n_0) [m^3], the displacement density of a road class at n_0 = 0.1 cycle/m: the geometric means of ISO 8608:2016,
/// table C.1, 16e-6 for A and four times more from class to class up to 0.262 for H.
/// @throws InputError for any other letter.
[[nodiscard]] double iso8608_roughness(char road_class);

/// A random road.
struct Iso8608Options {
  double roughness = 256e-6;  ///< G_d(n_0) [m^3]; class C
  double waviness = 2.0;      ///< w
  double low = 0.011;         ///< band [cycle/m]: the range of the standard
  double high = 2.83;
  double length = 1000.0;  ///< at least so long before the road repeats [m]
  double fade_in =
      10.0;  ///< the road grows from a level one over this distance, so that nothing jumps at the start [m]
  /// Left and right track have the coherence (of amplitudes) exp(-n coherence_length): waves much longer than that are
  /// the same on both sides and shorter ones independent. Exponential as Bogsjoe (2008), Veh. Syst. Dyn. 46 S1:599,
  /// fits to measured roads; the length is a choice, about that of paved roads and tracks at a distance of 1.5 m. 0:
  /// equal tracks.
  double coherence_length = 4.0;
  std::uint64_t seed = 1;

  /// @throws InputError naming the number.
  void validate() const;
};

/// A road whose displacement has the one-sided density of ISO 8608:2016, (C.1),
///
///     G_d(n) = G_d(n_0) (n/n_0)^-w,   low <= n <= high
///
/// as a sum of waves of the period of the whole, each with the amplitude that its part of the density has and a phase
/// from the seed; so every realisation has this density exactly, on both tracks, and its distribution is normal to the
/// extent that sums of thousands of waves are. Tabulated every 2 cm (by fast Fourier transform) and interpolated by
/// cubics with a continuous slope: errors of the shortest waves stay below 0.1 % of their amplitude. The track depends
/// on the sign of the offset (0: the mean of both). Deterministic from the seed on every machine to rounding.
class Iso8608Road final : public Road {
 public:
  explicit Iso8608Road(const Iso8608Options& options);
  [[nodiscard]] double height(const RoadPoint& point) const override;
  [[nodiscard]] double period() const;  ///< [m]

 private:
  double fade_in_;
  std::vector<double> left_, right_;
};

}  // namespace veridyn::vehicle
