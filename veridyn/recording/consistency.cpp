#include "veridyn/recording/consistency.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/recording/drive_relations.hpp"

namespace veridyn::recording {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Outcome;
using enum InertialChannel;
using Factors = PerInertialChannel<double>;

constexpr std::size_t kMostFaults = 3;  // looked for together
/// Ratios of steering gears that most cars have.
constexpr double kLeastUsualRatio = 11.0, kMostUsualRatio = 20.0;
/// What accel_y reads of the turning where the body leans by 11 deg/g; cars lean by 3 to 7.
constexpr double kMostLean = 1.2;

/// A fault that may be, how unlikely it is besides others (a wrong unit or sign counts 1), and the factors that it has.
struct Suspect {
  ChannelFault fault;
  double cost = 1.0;
  double least = 1.0, most = 1.0;  ///< of the factor; equal where it is known

  [[nodiscard]] bool is_free() const { return least != most; }
};

/// Range of a ratio.
struct Range {
  double low = -kInfinity, high = kInfinity;
};

Range product(Range a, Range b) {
  const std::array<double, 4> all{a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high};
  const auto [low, high] = std::ranges::minmax(all);
  return {low, high};
}

/// Of 1/f for a factor of one sign.
Range inverse(Range f) { return {1.0 / f.high, 1.0 / f.low}; }

bool is_off(const ChannelRelation& r) {
  // Where a right channel may read nothing at all, only what is far from both is wrong.
  return r.may_be_none ? r.outcome() == Outcome::kFailed : r.outcome() != Outcome::kPassed;
}

class Explainer {
 public:
  Explainer(const DriveMotion& motion, std::span<const ChannelRelation> relations) : m_(motion), relations_(relations) {
    collect_units();
    collect_signs();
    collect_others();
    std::erase_if(suspects_, [&](const Suspect& s) { return !concerns_what_is_off(s); });
  }

  /// All sets of faults of the least cost, and this cost; infinite where there is none.
  std::pair<std::vector<std::vector<ChannelFault>>, double> run() {
    for (std::size_t count = 1; count <= kMostFaults && found_.empty(); ++count) {
      chosen_.clear();
      search(count, 0, 0.0);
    }
    std::vector<std::vector<ChannelFault>> explanations;
    for (const auto& [faults, cost] : found_)
      if (cost < best_ + 1e-9) explanations.push_back(faults);
    return {std::move(explanations), best_};
  }

 private:
  [[nodiscard]] std::vector<InertialChannel> present(std::initializer_list<InertialChannel> channels) const {
    std::vector<InertialChannel> there;
    std::ranges::copy_if(channels, std::back_inserter(there), [&](InertialChannel c) { return m_.has(c); });
    return there;
  }
  void add(Cause cause, std::vector<InertialChannel> channels, double factor, double cost) {
    if (!channels.empty()) suspects_.push_back({{cause, std::move(channels), factor}, cost, factor, factor});
  }
  void add_units(const std::vector<InertialChannel>& channels, double cost) {
    if (channels.empty()) return;
    const Unit& taken = m_.recorded_in[channels.front()];
    for (const Unit& truly : units_like(taken)) {
      const double factor = taken.scale / truly.scale;
      if (std::abs(factor - 1.0) < 1e-6) continue;
      suspects_.push_back({{Cause::kUnit, channels, factor, truly.name, taken.name}, cost, factor, factor});
    }
  }
  void collect_units() {
    constexpr double kAlone = 1.1;  // of a sensor's three axes
    for (const auto& group :
         {present({kAccelX, kAccelY, kAccelZ}), present({kGyroX, kGyroY, kGyroZ}), present({kRoll, kPitch, kYaw})}) {
      add_units(group, 1.0);
      if (group.size() > 1)
        for (const InertialChannel c : group) add_units({c}, kAlone);
    }
    add_units(present({kSpeed}), 1.0);
    add_units(present({kPosX, kPosY}), 1.0);
    if (m_.has(kSteer)) add_units({kSteer}, 1.0);
  }
  void collect_signs() {
    ChannelFault frame{Cause::kFrame, present({kAccelY, kAccelZ, kGyroY, kGyroZ, kPitch, kYaw, kSteer}), -1.0};
    suspects_.push_back({std::move(frame), 1.0, -1.0, -1.0});
    for (const InertialChannel c : {kAccelX, kAccelY, kAccelZ, kGyroX, kGyroY, kGyroZ, kRoll, kPitch, kYaw, kSteer})
      add(Cause::kSign, present({c}), -1.0, 1.0);
    if (m_.has(kAccelX) && m_.has(kAccelY)) add(Cause::kSign, present({kAccelX, kAccelY, kAccelZ}), -1.0, 1.0);
  }
  void collect_others() {
    if (m_.has(kAccelZ)) add(Cause::kGravity, {kAccelZ}, 2.0, 1.0);
    if (m_.has(kSteer) && !m_.hand_wheel) {
      for (const double unit : {1.0, m_.recorded_in[kSteer].scale / kDegree}) {
        ChannelFault wheel{Cause::kUnit, {kSteer}, 1.0, unit == 1.0 ? "rad" : "deg"};
        wheel.hand_wheel = true;
        suspects_.push_back({wheel, unit == 1.0 ? 1.0 : 1.05, kLeastUsualRatio * unit, kMostUsualRatio * unit});
        suspects_.push_back({wheel, 1.2, kLeastSteeringRatio * unit, kMostSteeringRatio * unit});
        suspects_.push_back({wheel, 2.2, -kMostSteeringRatio * unit, -kLeastSteeringRatio * unit});
      }
    }
    // A body that leans, a road across and a vehicle that slides show more or less than it turns.
    const double least = estimation::info_of(Check::kLateralAcceleration).tolerance.lowest;
    if (m_.has(kAccelY)) suspects_.push_back({{Cause::kMissingTerm, {kAccelY}}, 1.3, least, kMostLean});
    constexpr double kScale = 1.6, kAnotherMotion = 2.5;
    for (const InertialChannel c : enumerators<InertialChannel, kInertialChannels>()) {
      // Of an angle a scale that is no unit's is no fault that sensors have; nor is that of one coordinate.
      if (!m_.has(c) || c == kPosX || c == kPosY) continue;
      suspects_.push_back({{Cause::kScale, {c}}, kScale, 0.05, 20.0});
      // What fits another one is no other motion.
      const auto some = [&](auto holds) {
        return std::ranges::any_of(relations_, [&](const ChannelRelation& r) { return r.power[c] != 0 && holds(r); });
      };
      const bool fits = some([](const ChannelRelation& r) { return !r.may_be_none && r.fits(); });
      const bool unrelated = some([](const ChannelRelation& r) { return r.unrelated(); });
      if (!fits && unrelated) suspects_.push_back({{Cause::kSwap, {c}, kNaN}, kAnotherMotion, kNaN, kNaN});
    }
  }
  [[nodiscard]] static bool in(const ChannelFault& fault, InertialChannel c) {
    return std::ranges::find(fault.channels, c) != fault.channels.end();
  }
  [[nodiscard]] bool concerns_what_is_off(const Suspect& s) const {
    return std::ranges::any_of(relations_, [&](const ChannelRelation& r) {
      return is_off(r) && std::ranges::any_of(s.fault.channels, [&](InertialChannel c) { return r.power[c] != 0; });
    });
  }

  void search(std::size_t count, std::size_t from, double cost) {
    if (chosen_.size() == count) {
      consider(cost);
      return;
    }
    for (std::size_t i = from; i < suspects_.size(); ++i) {
      const Suspect& s = suspects_[i];
      // One thing is wrong with a channel once, and one factor that is free is found.
      const bool again = std::ranges::any_of(chosen_, [&](const Suspect* other) {
        return (other->is_free() && s.is_free()) ||
               (other->fault.cause == s.fault.cause &&
                std::ranges::any_of(s.fault.channels, [&](InertialChannel c) { return in(other->fault, c); }));
      });
      if (again || cost + s.cost > best_ + 1e-9) continue;
      chosen_.push_back(&s);
      search(count, i + 1, cost + s.cost);
      chosen_.pop_back();
    }
  }

  /// By how much the chosen faults of known factor change reading and truth of a relation; NaN where one makes it
  /// another motion.
  [[nodiscard]] std::pair<double, double> known_factors(const ChannelRelation& r) const {
    std::pair<double, double> factors{1.0, 1.0};
    for (const Suspect* s : chosen_) {
      const bool another = std::isnan(s->least);
      if (s->is_free() && !another) continue;
      for (const InertialChannel c : s->fault.channels) {
        const int power = r.power[c];
        if (power == 0) continue;
        (power > 0 ? factors.first : factors.second) *= another ? kNaN : std::pow(s->fault.factor, std::abs(power));
      }
    }
    return factors;
  }
  [[nodiscard]] const Suspect* free_one() const {
    const auto found =
        std::ranges::find_if(chosen_, [](const Suspect* s) { return s->is_free() && !std::isnan(s->least); });
    return found == chosen_.end() ? nullptr : *found;
  }

  /// The ratio of a hand wheel as far as relations know it, whatever most cars have.
  void take_ratio(ChannelFault& fault, Range by_relations) const {
    const double unit = fault.truly == "deg" ? m_.recorded_in[kSteer].scale / kDegree : 1.0;
    const double sign = fault.factor < 0.0 ? -1.0 : 1.0;
    const Range along = product(by_relations, {sign, sign});
    fault.least = std::max(along.low, kLeastSteeringRatio * unit) / unit;
    fault.most = std::min(along.high, kMostSteeringRatio * unit) / unit;
    fault.factor = sign * unit * std::sqrt(fault.least * fault.most);
  }

  /// Takes the chosen faults down where they explain everything that is off and put nothing else off.
  void consider(double cost) {
    const Suspect* const free = free_one();
    Range factor{free != nullptr ? free->least : 1.0, free != nullptr ? free->most : 1.0};
    Range measured = factor, by_relations{};
    double sharpest = kInfinity;
    for (const ChannelRelation& r : relations_) {
      const auto [reading, truth] = known_factors(r);
      // Nothing is expected of another motion, or of noise where nothing moves.
      if (std::isnan(reading * truth) || !r.moved() || (r.unrelated() && !r.moved(reading, truth))) continue;
      const double known = reading / truth;
      if (r.unrelated()) return;
      int power = 0;
      if (free != nullptr)
        for (const InertialChannel c : free->fault.channels) power += r.power[c];
      const Range left = product({r.low, r.high}, {1.0 / known, 1.0 / known});
      if (power == 0) {
        // Where gravity may have been taken off, another unit is none because it makes too little of it.
        const bool another_unit = std::abs(std::abs(known) - 1.0) > 1e-6;
        const Outcome outcome = r.may_be_none && another_unit
                                    ? estimation::outcome_between(left.low, left.high, r.tolerance)
                                    : r.outcome_for(left.low, left.high);
        if (outcome == Outcome::kFailed || (outcome != Outcome::kPassed && !r.may_be_none)) return;
        continue;
      }
      // The factors for which left / f^power is within the tolerance.
      const double sign = free->least < 0.0 ? -1.0 : 1.0;
      if (left.low * sign <= 0.0 && left.high * sign <= 0.0) return;
      const Range positive{std::max(1e-9, std::min(left.low * sign, left.high * sign)),
                           std::max(left.low * sign, left.high * sign)};
      const Range tolerance =
          r.may_be_none ? Range{r.tolerance.lowest, r.tolerance.highest} : Range{r.tolerance.low, r.tolerance.high};
      Range may = product(positive, inverse(tolerance));
      Range seen = positive;
      if (power < 0) may = inverse(may), seen = inverse(seen);
      may = product(may, {sign, sign});
      seen = product(seen, {sign, sign});
      factor = {std::max(factor.low, may.low), std::min(factor.high, may.high)};
      by_relations = {std::max(by_relations.low, may.low), std::min(by_relations.high, may.high)};
      const double width = (seen.high - seen.low) / std::abs(seen.high + seen.low);
      if (recording::is_off(r) && width < sharpest) sharpest = width, measured = seen;
      if (!(factor.low <= factor.high)) return;
    }
    // What is off says what the factor is; it must suit the others.
    const double found_factor = 0.5 * (measured.low + measured.high);
    if (free != nullptr && !free->fault.hand_wheel && !(found_factor >= factor.low && found_factor <= factor.high))
      return;
    if (cost < best_ - 1e-9) found_.clear();
    best_ = std::min(best_, cost);
    std::vector<ChannelFault> faults;
    for (const Suspect* s : chosen_) {
      ChannelFault& fault = faults.emplace_back(s->fault);
      if (s != free) continue;
      fault.factor = std::clamp(found_factor, factor.low, factor.high);
      if (fault.hand_wheel) take_ratio(fault, by_relations);
    }
    found_.emplace_back(std::move(faults), cost);
  }

  const DriveMotion& m_;
  std::span<const ChannelRelation> relations_;
  std::vector<Suspect> suspects_;
  std::vector<const Suspect*> chosen_;
  std::vector<std::pair<std::vector<ChannelFault>, double>> found_;
  double best_ = kInfinity;
};

/// Channels that are taken for each other: where each of `to` is really recorded.
struct Exchange {
  std::vector<InertialChannel> to, from;
};

std::vector<Exchange> exchanges_in(const DriveMotion& m) {
  std::vector<Exchange> all{{{kAccelX, kAccelY}, {kAccelY, kAccelX}},
                            {{kAccelX, kAccelZ}, {kAccelZ, kAccelX}},
                            {{kAccelY, kAccelZ}, {kAccelZ, kAccelY}},
                            {{kAccelX, kAccelY, kAccelZ}, {kAccelY, kAccelZ, kAccelX}},
                            {{kAccelX, kAccelY, kAccelZ}, {kAccelZ, kAccelX, kAccelY}},
                            {{kGyroX, kGyroZ}, {kGyroZ, kGyroX}},
                            {{kGyroY, kGyroZ}, {kGyroZ, kGyroY}},
                            {{kSteer, kGyroZ}, {kGyroZ, kSteer}}};
  std::erase_if(all, [&](const Exchange& e) { return !std::ranges::all_of(e.to, [&](auto c) { return m.has(c); }); });
  return all;
}

DriveMotion led_back(DriveMotion m, const Exchange& e) {
  const PerInertialChannel<std::vector<double>> recorded = m.signals;
  for (std::size_t i = 0; i < e.to.size(); ++i) m.signals[e.to[i]] = recorded[e.from[i]];
  return m;
}

/// What another channel shows as one motion has moved, however little.
void mark_shown(const DriveMotion& m, const ConsistencyOptions& options, std::vector<ChannelRelation>& relations) {
  if (std::ranges::all_of(relations, [](const ChannelRelation& r) { return r.moved(); })) return;
  for (const Exchange& e : exchanges_in(m)) {
    const std::vector<ChannelRelation> others = drive_relations(led_back(m, e), options);
    for (ChannelRelation& r : relations) {
      const bool reading_alone =
          std::ranges::all_of(e.to, [&](InertialChannel c) { return c == r.channel || r.power[c] == 0; });
      const auto other = std::ranges::find(others, r.check, &ChannelRelation::check);
      r.shown = r.shown || (reading_alone && other != others.end() && other->is_one_motion());
    }
  }
}

/// Where two signals that move are unrelated: the exchange of channels that explains more than anything else.
void explain_by_exchange(const DriveMotion& m, const ConsistencyOptions& options, Consistency& result, double best) {
  for (const Exchange& e : exchanges_in(m)) {
    const DriveMotion right = led_back(m, e);
    const std::vector<ChannelRelation> relations = drive_relations(right, options);
    ChannelFault fault{Cause::kAxis, e.to};
    fault.from = e.from;
    std::vector<std::vector<ChannelFault>> found{{}};
    double cost = 1.0;
    if (std::ranges::any_of(relations, is_off)) {
      auto [others, more] = Explainer(right, relations).run();
      found = std::move(others);
      cost += more;
    }
    if (!(cost < best + 1e-9)) continue;
    if (cost < best - 1e-9) result.explanations.clear();
    best = cost;
    for (std::vector<ChannelFault>& faults : found) {
      faults.insert(faults.begin(), fault);
      result.explanations.push_back(std::move(faults));
    }
  }
}

std::string source_of(InertialChannel c, const ChannelNames& names, std::span<const ChannelOrigin> origins) {
  const auto found = std::ranges::find(origins, names[c], &ChannelOrigin::channel);
  return found == origins.end() ? names[c] : found->source;
}

}  // namespace

bool ChannelRelation::moved(double reading_factor, double truth_factor) const {
  constexpr double kManyTimes = 5.0;
  if (shown || is_one_motion()) return true;
  return truth_rms > std::abs(truth_factor) * least || reading_rms > std::abs(reading_factor) * kManyTimes * least;
}

Outcome ChannelRelation::outcome_for(double from, double to) const {
  if (may_be_none && from > tolerance.lowest - 1.0 && to < tolerance.highest - 1.0) return Outcome::kPassed;
  return estimation::outcome_between(from, to, tolerance);
}

Outcome ChannelRelation::outcome() const {
  if (!moved()) return Outcome::kPassed;
  // Square of the correlation below which two signals that move are not quite the same motion.
  constexpr double kCommon = 0.6;
  const Outcome by_correlation = unrelated()                           ? Outcome::kFailed
                                 : correlation * correlation < kCommon ? Outcome::kCare
                                                                       : Outcome::kPassed;
  return std::max(outcome_for(low, high), by_correlation);
}

bool Consistency::is_off() const { return std::ranges::any_of(relations, recording::is_off); }

Consistency check_consistency(const DriveMotion& motion, const ConsistencyOptions& options) {
  Consistency result{.relations = drive_relations(motion, options)};
  mark_shown(motion, options, result.relations);
  if (!result.is_off()) return result;
  auto [explanations, cost] = Explainer(motion, result.relations).run();
  result.explanations = std::move(explanations);
  constexpr double kSimple = 2.0;
  if (cost > kSimple && std::ranges::any_of(result.relations, [](const ChannelRelation& r) { return r.unrelated(); }))
    explain_by_exchange(motion, options, result, cost);
  return result;
}

std::string ChannelFault::says(const ChannelNames& called) const {
  std::vector<std::string> names;
  for (const InertialChannel c : channels) names.push_back(called[c]);
  const std::string all = fmt::format("{}", fmt::join(names, ", "));
  const bool one = names.size() == 1;
  switch (cause) {
    case Cause::kUnit:
      if (hand_wheel)
        return fmt::format("{} is the hand wheel's angle in {} ({:.3g} to {:.3g} times that of the road wheels)", all,
                           truly, least, most);
      return fmt::format("{} {} in {}, not {}", all, one ? "is" : "are", truly, taken);
    case Cause::kSign:
      return one ? fmt::format("{} has the wrong sign", all)
                 : fmt::format("{} have the wrong signs: the specific force is the opposite", all);
    case Cause::kFrame:
      return "axes are those of frd (y right, z down), not flu";
    case Cause::kGravity:
      return fmt::format("{} has gravity in it twice", all);
    case Cause::kAxis: {
      std::vector<std::string> truth;
      for (const InertialChannel c : from) truth.push_back(called[c]);
      return fmt::format("{} are exchanged: they are recorded as {}", all, fmt::join(truth, ", "));
    }
    case Cause::kMissingTerm:
      return fmt::format(
          "{} reads {:.3g} times what yaw rate and speed imply: {}the vehicle slides, or its scale is wrong", all,
          factor, factor > 1.0 ? "the body or the road leans, " : "");
    case Cause::kSwap:
      return fmt::format("{} shows another motion", all);
    default:
      return fmt::format("{} reads {:.3g} times the truth", all, factor);
  }
}

std::vector<std::string> correction_of(const ChannelFault& fault, const ChannelNames& names,
                                       std::span<const ChannelOrigin> origins) {
  if (fault.cause == Cause::kFrame) return {"frame = \"frd\""};
  if (fault.cause == Cause::kSwap || fault.cause == Cause::kMissingTerm || fault.cause == Cause::kGravity) return {};
  std::vector<std::string> lines;
  if (fault.hand_wheel) {
    const std::string source = toml_text(source_of(kSteer, names, origins));
    return {"steer = \"none\"", fault.truly == "deg"
                                    ? fmt::format("steering_wheel = {{ channel = {}, unit = \"deg\" }}", source)
                                    : fmt::format("steering_wheel = {}", source)};
  }
  for (std::size_t i = 0; i < fault.channels.size(); ++i) {
    const InertialChannel c = fault.channels[i];
    const InertialChannel recorded = fault.from.empty() ? c : fault.from[i];
    lines.push_back(fmt::format("{} = {{ channel = {}, scale = {:.6g} }}", names[c],
                                toml_text(source_of(recorded, names, origins)), 1.0 / fault.factor));
  }
  return lines;
}

std::string mistaken_unit(const Unit& taken, double factor, double doubt) {
  constexpr double kLeastDoubt = 0.03, kMostDoubt = 0.15;
  const double within = std::clamp(doubt, kLeastDoubt, kMostDoubt);
  std::string nearest;
  double least = within;
  for (const Unit& truly : units_like(taken)) {
    const double ratio = taken.scale / truly.scale;
    const double distance = std::abs(factor / ratio - 1.0);
    if (std::abs(ratio - 1.0) < 1e-6 || !(distance < least)) continue;
    least = distance;
    nearest = truly.name;
  }
  return nearest.empty() ? nearest : fmt::format("{} taken for {}", nearest, taken.name);
}

}  // namespace veridyn::recording
