#pragma once

#include <cstddef>
#include <vector>

namespace veridyn::vehicle {

/// Force of a suspension spring over its travel, from a table: what replaces a constant rate. Both count from rest:
/// travel 0 is that of the vehicle at rest on level ground, where the force is that of the corner's static load; only
/// differences from it count, so that the table may hold them or the spring's whole force.
///
/// Between the rows a monotone cubic with continuous slope (Fritsch & Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300:
/// slopes are weighted harmonic means of neighbouring secants); beyond the ends straight on.
class SpringCurve {
 public:
  /// No curve.
  SpringCurve() = default;
  /// Travel at the wheel, bump positive [m], and force of one corner, pushing body and wheel apart [N]: two rows or
  /// more, both strictly increasing. @throws InputError("spring", ...) naming the first row that is not.
  SpringCurve(std::vector<double> travel, std::vector<double> force);

  [[nodiscard]] bool empty() const { return travel_.empty(); }
  [[nodiscard]] const std::vector<double>& travels() const { return travel_; }
  [[nodiscard]] const std::vector<double>& forces() const { return force_; }

  /// Force less that at rest [N]. Does not throw or allocate; usable with Jets.
  template <typename Scalar>
  [[nodiscard]] Scalar force(const Scalar& travel) const {
    return along(travel) - at_rest_;
  }
  /// Slope of the force [N/m].
  [[nodiscard]] double rate(double travel) const;
  /// Where the force less that at rest is `force` [m].
  template <typename Scalar>
  [[nodiscard]] Scalar travel_at(const Scalar& force) const;

  /// The same curve with lengths and forces multiplied.
  [[nodiscard]] SpringCurve scaled(double length, double force) const;

 private:
  /// The table's own force at a travel.
  template <typename Scalar>
  [[nodiscard]] Scalar along(const Scalar& travel) const;

  std::vector<double> travel_, force_, slope_;
  double at_rest_ = 0.0;
};

template <typename Scalar>
Scalar SpringCurve::along(const Scalar& travel) const {
  if (travel <= travel_.front()) return force_.front() + slope_.front() * (travel - travel_.front());
  if (travel >= travel_.back()) return force_.back() + slope_.back() * (travel - travel_.back());
  std::size_t i = 0;
  while (travel >= travel_[i + 1]) ++i;
  // Hermite's cubic in p from 0 to 1.
  const double width = travel_[i + 1] - travel_[i], rise = force_[i + 1] - force_[i];
  const double begin = slope_[i] * width, end = slope_[i + 1] * width;
  const Scalar p = (travel - travel_[i]) / width;
  return force_[i] + p * (begin + p * ((3.0 * rise - 2.0 * begin - end) + p * (begin + end - 2.0 * rise)));
}

template <typename Scalar>
Scalar SpringCurve::travel_at(const Scalar& wanted) const {
  double low = -1.0, high = 1.0;
  while (force(low) > wanted) low *= 2.0;
  while (force(high) < wanted) high *= 2.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (force(middle) < wanted ? low : high) = middle;
  }
  // The last step of Newton's method brings the derivatives of a Jet.
  const double near = 0.5 * (low + high);
  return near + (wanted - force(near)) / rate(near);
}

}  // namespace veridyn::vehicle
