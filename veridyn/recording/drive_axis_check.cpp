#include "veridyn/recording/drive_axis_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/rank.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::recording {
namespace {

using enum InertialChannel;
using Values = std::vector<double>;

constexpr PerInertialChannel<const char*> kSignalNames = {"accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y",
                                                          "gyro_z",  "roll",    "pitch",   "yaw",    "speed",
                                                          "steer",   "pos_x",   "pos_y"};
constexpr double kSmoothing = 0.4;      // length of each of two moving averages [s]
constexpr double kComparedBlock = 5.0;  // [s]
constexpr double kLongestLag = 1.0;     // between two sensors [s]
constexpr double kCorrelates = 0.6;     // from here on a slope means something
constexpr double kUnrelated = 0.3;      // below this, with much to compare, something else is wrong
constexpr double kShortest = 10.0;      // [s]
constexpr double kFits = 0.4;           // largest logarithm of a slope over the foretold one: mph is 0.8 from m/s
constexpr std::size_t kMostFaults = 3;  // looked for together

Values averaged(const Values& x, double step) {
  const auto half = static_cast<std::ptrdiff_t>(0.5 * kSmoothing / step);
  Values sum(x.size() + 1, 0.0), out(x.size(), kNaN);
  std::vector<std::size_t> bad(x.size() + 1, 0);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const bool ok = std::isfinite(x[k]);
    sum[k + 1] = sum[k] + (ok ? x[k] : 0.0);
    bad[k + 1] = bad[k] + (ok ? 0 : 1);
  }
  const auto n = signed_index(x.size());
  for (std::ptrdiff_t k = half; k + half < n; ++k) {
    const auto from = static_cast<std::size_t>(k - half), to = static_cast<std::size_t>(k + half + 1);
    if (bad[to] == bad[from]) out[at(k)] = (sum[to] - sum[from]) / static_cast<double>(to - from);
  }
  return out;
}

Values smooth(const Values& x, double step) { return averaged(averaged(x, step), step); }

Values change(const Values& x, double step) {
  Values out(x.size(), kNaN);
  for (std::size_t k = 1; k + 1 < x.size(); ++k) out[k] = (x[k + 1] - x[k - 1]) / (2.0 * step);
  return out;
}

Values product(const Values& a, const Values& b) {
  Values out(std::min(a.size(), b.size()));
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = a[k] * b[k];
  return out;
}

/// Sums of two signals over a stretch.
struct Moments {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  void add(double a, double b) {
    n += 1.0;
    x += a;
    y += b;
    xx += a * a;
    yy += b * b;
    xy += a * b;
  }
  void add(const Moments& m, double sign) {
    n += sign * m.n;
    x += sign * m.x;
    y += sign * m.y;
    xx += sign * m.xx;
    yy += sign * m.yy;
    xy += sign * m.xy;
  }
  [[nodiscard]] double variance_x() const { return n > 1.0 ? std::max(0.0, xx / n - x * x / (n * n)) : 0.0; }
  [[nodiscard]] double variance_y() const { return n > 1.0 ? std::max(0.0, yy / n - y * y / (n * n)) : 0.0; }
  [[nodiscard]] double correlation() const {
    const double v = variance_x() * variance_y();
    return v > 0.0 ? (xy / n - x * y / (n * n)) / std::sqrt(v) : 0.0;
  }
  /// Of the line that treats both alike: noise in one hardly makes it smaller (reduced major axis).
  [[nodiscard]] double slope() const {
    return variance_x() > 0.0 ? std::copysign(std::sqrt(variance_y() / variance_x()), correlation()) : 0.0;
  }
};

std::vector<Moments> blocks_of(const Values& y, const Values& x, double step, std::ptrdiff_t lag) {
  const auto length = static_cast<std::size_t>(kComparedBlock / step);
  std::vector<Moments> blocks;
  for (std::size_t k = 0; k < y.size(); ++k) {
    const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(k) - lag;
    if (i < 0 || i >= signed_index(x.size())) continue;
    const double a = x[at(i)], b = y[k];
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    if (k / length >= blocks.size()) blocks.resize(k / length + 1);
    blocks[k / length].add(a, b);
  }
  return blocks;
}

Moments total(const std::vector<Moments>& blocks) {
  Moments all;
  for (const Moments& m : blocks) all.add(m, 1.0);
  return all;
}

/// Compares at the lag where they correlate best. @param least RMS of x that there has to be
/// @param from_zero the line goes through zero: of signals that hardly change but are large
AxisRelation related(std::string text, const Values& y_raw, const Values& x_raw, double step, double least,
                     bool from_zero = false) {
  const Values y = smooth(y_raw, step), x = smooth(x_raw, step);
  AxisRelation r{.text = std::move(text)};
  const auto with_lag = [&](std::ptrdiff_t lag) {
    std::vector<Moments> blocks = blocks_of(y, x, step, lag);
    for (Moments& m : blocks) {
      if (from_zero) m.x = m.y = 0.0;
    }
    return blocks;
  };
  std::vector<Moments> best = with_lag(0);
  const auto most = static_cast<std::ptrdiff_t>(kLongestLag / step), stride = std::max<std::ptrdiff_t>(1, most / 10);
  for (std::ptrdiff_t lag = -most; lag <= most; lag += stride) {
    std::vector<Moments> blocks = with_lag(lag);
    if (std::abs(total(blocks).correlation()) > std::abs(total(best).correlation()) + 0.02) best = std::move(blocks);
  }
  const Moments all = total(best);
  r.correlation = all.correlation();
  r.slope = all.slope();
  for (const Moments& m : best) r.seconds += std::sqrt(m.variance_x()) > 0.5 * least ? m.n * step : 0.0;
  // Jackknife over blocks.
  double squares = 0.0, used = 0.0;
  for (const Moments& m : best) {
    if (m.n == 0.0) continue;
    Moments rest = all;
    rest.add(m, -1.0);
    squares += (rest.slope() - r.slope) * (rest.slope() - r.slope);
    used += 1.0;
  }
  const double half = used > 1.0 ? numerics::kNormal95 * std::sqrt(squares * (used - 1.0) / used) : kNaN;
  r.low = r.slope - half;
  r.high = r.slope + half;
  const bool enough = r.seconds >= kShortest && std::sqrt(all.variance_x()) > least;
  r.judged = enough && std::abs(r.correlation) >= kCorrelates;
  if (!enough) r.seconds = std::min(r.seconds, kShortest - 1e-9);
  return r;
}

/// Factors by which signals are wrong.
using Factors = PerInertialChannel<double>;

/// A relation with what factors of the signals do to its slope.
struct Compared {
  AxisRelation relation;
  std::vector<InertialChannel> over, under;  ///< slope = factors of `over` / those of `under`
  bool sign_only = false;
  [[nodiscard]] double foretold(const Factors& f) const {
    double slope = 1.0;
    for (const InertialChannel s : over) slope *= f[s];
    for (const InertialChannel s : under) slope /= f[s];
    return slope;
  }
  [[nodiscard]] bool agrees(const Factors& f) const {
    const double ratio = relation.slope / foretold(f);
    return ratio > 0.0 && (sign_only || std::abs(std::log(ratio)) < kFits);
  }
};

/// Something that may be wrong.
struct Suspect {
  std::string text;
  std::vector<InertialChannel> signals;
  double factor = -1.0;
  bool frame = false;
};

std::vector<Suspect> suspects() {
  std::vector<Suspect> all;
  all.push_back({"axes are those of frd (y right, z down), not flu",
                 {kAccelY, kAccelZ, kGyroY, kGyroZ, kPitch, kYaw, kSteer},
                 -1.0,
                 true});
  for (const InertialChannel s : {kAccelX, kAccelY, kAccelZ, kGyroX, kGyroY, kGyroZ, kRoll, kPitch, kYaw, kSteer})
    all.push_back({fmt::format("{} has the wrong sign", kSignalNames[s]), {s}});
  const std::vector<InertialChannel> accels = {kAccelX, kAccelY, kAccelZ}, gyros = {kGyroX, kGyroY, kGyroZ},
                                     angles = {kRoll, kPitch, kYaw};
  all.push_back({"accelerations point where one is pushed: the specific force is the opposite", accels, -1.0});
  all.push_back({"accelerations are in g, not m/s^2", accels, 1.0 / kGravity});
  all.push_back({"accelerations are in m/s^2, not g", accels, kGravity});
  all.push_back({"angular rates are in deg/s, not rad/s", gyros, 1.0 / kDegree});
  all.push_back({"angular rates are in rad/s, not deg/s", gyros, kDegree});
  all.push_back({"angles are in deg, not rad", angles, 1.0 / kDegree});
  all.push_back({"angles are in rad, not deg", angles, kDegree});
  all.push_back({"speed is in km/h, not m/s", {kSpeed}, 3.6});
  all.push_back({"speed is in m/s, not km/h", {kSpeed}, 1.0 / 3.6});
  all.push_back({"speed is in mph, not m/s", {kSpeed}, 2.2369});
  return all;
}

std::string source_of(InertialChannel s, std::span<const ChannelOrigin> origins) {
  for (const ChannelOrigin& o : origins) {
    if (o.channel == kSignalNames[s] || (s == kGyroZ && o.channel == "yaw_rate") ||
        (s == kGyroX && o.channel == "roll_rate"))
      return o.source;
  }
  return kSignalNames[s];
}

/// Standard name that the drive has for it.
std::string name_of(InertialChannel s, std::span<const ChannelOrigin> origins) {
  for (const ChannelOrigin& o : origins) {
    if (s == kGyroZ && o.channel == "yaw_rate") return "yaw_rate";
    if (s == kGyroX && o.channel == "roll_rate") return "roll_rate";
    if (s == kSteer && o.channel == "steering_wheel") return "steering_wheel";
  }
  return kSignalNames[s];
}

std::string line(InertialChannel s, const std::string& source, double scale, std::span<const ChannelOrigin> origins) {
  return fmt::format("{} = {{ channel = {}, scale = {:.6g} }}", name_of(s, origins), toml_text(source), scale);
}

constexpr std::array kAccelAxes = {kAccelX, kAccelY, kAccelZ};

/// How an accelerometer's axis is led where it belongs.
struct Exchange {
  std::array<InertialChannel, 3> from = kAccelAxes;
  [[nodiscard]] bool any() const { return from != kAccelAxes; }
};

/// The accelerometer's axes by what they correlate with, where their own hardly do and others clearly do.
Exchange exchanged(const DriveMotion& m, const Values& speed_change, const Values& turning) {
  Exchange e;
  const auto& s = m.signals;
  if (s[kAccelX].empty() || s[kAccelY].empty()) return e;
  const auto strength = [&](InertialChannel axis, const Values& x, double least) {
    const Values& y = s[axis];
    if (y.empty() || x.empty()) return 0.0;
    const AxisRelation r = related("", y, x, m.step, least);
    return r.seconds >= kShortest ? std::abs(r.correlation) : 0.0;
  };
  constexpr double kSure = 0.4, kOther = 0.7;
  const auto belongs = [&](InertialChannel axis, const Values& x, double least) {
    InertialChannel best = axis;
    if (strength(axis, x, least) > kSure) return best;
    for (const InertialChannel other : kAccelAxes) {
      if (other != axis && strength(other, x, least) > kOther) best = other;
    }
    return best;
  };
  InertialChannel x = belongs(kAccelX, speed_change, 0.15), y = belongs(kAccelY, turning, 0.2);
  // Of two that want the same axis the one that is sure of it keeps it.
  if (x == kAccelY && y == kAccelY && strength(kAccelY, turning, 0.2) <= kSure) y = kAccelX;
  if (x == kAccelX && y == kAccelX && strength(kAccelX, speed_change, 0.15) <= kSure) x = kAccelY;
  if (x == y) return e;
  const auto left =
      std::find_if(kAccelAxes.begin(), kAccelAxes.end(), [&](InertialChannel axis) { return axis != x && axis != y; });
  e.from = {x, y, *left};
  return e;
}

double median_of(Values values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  return values.empty() ? kNaN : upper_median(values);
}

std::vector<Compared> compare(const DriveMotion& m) {
  const auto& s = m.signals;
  std::vector<Compared> all;
  const auto there = [&](std::initializer_list<InertialChannel> of) {
    return std::all_of(of.begin(), of.end(), [&](InertialChannel x) { return !s[x].empty(); });
  };
  const auto add = [&](const char* text, InertialChannel y, const Values& x, double least,
                       std::vector<InertialChannel> under) {
    all.push_back({related(text, s[y], x, m.step, least), {y}, std::move(under)});
    all.back().relation.channel = y;
  };
  if (there({kAccelX, kSpeed}))
    add("accel_x against the change of speed", kAccelX, change(s[kSpeed], m.step), 0.15, {kSpeed});
  if (there({kAccelY, kSpeed, kGyroZ}))
    add("accel_y against speed times gyro_z", kAccelY, product(s[kSpeed], s[kGyroZ]), 0.2, {kSpeed, kGyroZ});
  if (there({kGyroZ, kYaw})) add("gyro_z against the change of yaw", kGyroZ, change(s[kYaw], m.step), 0.02, {kYaw});
  if (there({kGyroX, kRoll}))
    add("gyro_x against the change of roll", kGyroX, change(s[kRoll], m.step), 0.005, {kRoll});
  if (there({kGyroY, kPitch}))
    add("gyro_y against the change of pitch", kGyroY, change(s[kPitch], m.step), 0.005, {kPitch});
  if (there({kSpeed, kPosX, kPosY})) {
    const Values x = change(smooth(s[kPosX], m.step), m.step), y = change(smooth(s[kPosY], m.step), m.step);
    Values over_ground(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) over_ground[k] = std::hypot(x[k], y[k]);
    const double most = 5.0 * median_of(over_ground);  // where one run ends and another one begins it jumps
    for (double& v : over_ground) v = v > most ? kNaN : v;
    all.push_back(
        {related("speed against the change of position", s[kSpeed], over_ground, m.step, 0.5, true), {kSpeed}, {}});
    all.back().relation.channel = kSpeed;
  }
  if (there({kSteer, kSpeed, kGyroZ})) {
    add("gyro_z against speed times steer", kGyroZ, product(s[kSpeed], s[kSteer]), 0.02, {kSteer});
    all.back().sign_only = true;
  }
  return all;
}

/// All sets of `count` suspects that explain what was compared.
void explain(const std::vector<Compared>& compared, const std::vector<Suspect>& all, std::size_t count,
             std::size_t from, std::vector<std::size_t>& chosen, const Factors& factors, double vertical,
             std::vector<std::vector<std::size_t>>& found) {
  if (chosen.size() == count) {
    const bool agrees = std::all_of(compared.begin(), compared.end(),
                                    [&](const Compared& c) { return !c.relation.judged || c.agrees(factors); });
    // Level at rest: gravity is in, or it is not.
    const double level = vertical / factors[kAccelZ];
    const bool upright = !std::isfinite(vertical) || std::abs(level) < 0.35 * kGravity ||
                         std::abs(level / kGravity - 1.0) < 0.3 || std::abs(level / kGravity - 2.0) < 0.3;
    if (agrees && upright) found.push_back(chosen);
    return;
  }
  for (std::size_t i = from; i < all.size(); ++i) {
    Factors changed = factors;
    for (const InertialChannel s : all[i].signals) changed[s] *= all[i].factor;
    chosen.push_back(i);
    explain(compared, all, count, i + 1, chosen, changed, vertical, found);
    chosen.pop_back();
  }
}

/// Whether the signals of a suspect are there and something was said of one of them.
bool concerns(const Suspect& suspect, const std::vector<Compared>& compared, double vertical) {
  return std::any_of(suspect.signals.begin(), suspect.signals.end(), [&](InertialChannel s) {
    if (s == kAccelZ && std::isfinite(vertical)) return true;
    return std::any_of(compared.begin(), compared.end(), [&](const Compared& c) {
      const auto in = [&](const std::vector<InertialChannel>& of) {
        return std::find(of.begin(), of.end(), s) != of.end();
      };
      return c.relation.judged && (in(c.over) || in(c.under));
    });
  });
}

DriveFault described(const Suspect& suspect, const DriveMotion& m, const std::vector<Compared>& compared,
                     const Exchange& exchange, std::span<const ChannelOrigin> origins) {
  DriveFault f{.text = suspect.text, .correlation = 1.0, .lines = {}};
  for (const Compared& c : compared) {
    const auto of = [&](InertialChannel s) {
      return std::find(c.over.begin(), c.over.end(), s) != c.over.end() ||
             std::find(c.under.begin(), c.under.end(), s) != c.under.end();
    };
    if (c.relation.judged && std::any_of(suspect.signals.begin(), suspect.signals.end(), of))
      f.correlation = std::min(f.correlation, std::abs(c.relation.correlation));
  }
  if (suspect.frame) {
    f.lines.emplace_back("frame = \"frd\"");
    return f;
  }
  for (const InertialChannel s : suspect.signals) {
    if (m.signals[s].empty()) continue;
    const InertialChannel from = s <= kAccelZ ? exchange.from[static_cast<std::size_t>(s)] : s;
    f.lines.push_back(line(s, source_of(from, origins), 1.0 / suspect.factor, origins));
  }
  return f;
}

/// The angle of the road wheels by the bend that is driven: a wheelbase that no vehicle has says that it is another
/// one.
/// @param factors of what else is wrong
std::optional<DriveFault> steering_fault(const DriveMotion& m, const Compared& c, const Factors& factors,
                                         std::span<const ChannelOrigin> origins) {
  constexpr double kLongestWheelbase = 10.0, kLongestWithHandWheel = 100.0;  // [m], understeer included
  if (!c.sign_only || !c.relation.judged || m.hand_wheel) return std::nullopt;
  const double wheelbase = std::abs(factors[kGyroZ] / (c.relation.slope * factors[kSpeed]));
  if (wheelbase < kLongestWheelbase) return std::nullopt;
  const bool hand_wheel = wheelbase < kLongestWithHandWheel;
  DriveFault f{.text = fmt::format("steer would need a wheelbase of {:.0f} m: {}", wheelbase,
                                   hand_wheel ? "it is the hand wheel's angle" : "it is in deg, not rad"),
               .correlation = std::abs(c.relation.correlation),
               .lines = {}};
  const std::string source = source_of(kSteer, origins);
  if (hand_wheel) {
    f.lines = {"steer = \"none\"", fmt::format("steering_wheel = {}", toml_text(source))};
  } else {
    f.lines = {line(kSteer, source, kDegree, origins)};
  }
  return f;
}

/// What was compared and does not fit, or could not be.
std::vector<std::string> notes_on(const std::vector<Compared>& compared, bool explained) {
  std::vector<std::string> notes;
  for (const Compared& c : compared) {
    const AxisRelation& r = c.relation;
    if (r.seconds < kShortest) {
      notes.push_back(fmt::format("{}: too little of it to compare", r.text));
    } else if (!r.judged && std::abs(r.correlation) < kUnrelated) {
      notes.push_back(fmt::format("{}: they have nothing to do with each other (correlation {:.2f} in {:.0f} s)",
                                  r.text, r.correlation, r.seconds));
    } else if (!r.judged) {
      notes.push_back(fmt::format("{}: correlation {:.2f}, too weak to say anything", r.text, r.correlation));
    } else if (!explained && !r.fits) {
      notes.push_back(fmt::format("{}: does not fit, slope {:.3g} ({:.3g} to {:.3g}), correlation {:.2f}", r.text,
                                  r.slope, r.low, r.high, r.correlation));
    }
  }
  return notes;
}

}  // namespace

DriveMotion drive_motion(const Recording& recording) {
  DriveMotion m;
  const TimeSpan span = recording.span();
  const auto count = static_cast<std::size_t>(std::max(0.0, span.duration() / m.step)) + 1;
  std::vector<double> grid(count);
  for (std::size_t k = 0; k < count; ++k) grid[k] = span.begin + m.step * static_cast<double>(k);
  const auto take = [&](InertialChannel to, const char* name) {
    const Channel* channel = recording.find(name);
    if (!m.signals[to].empty() || channel == nullptr || channel->size() < 2) return;
    Channel whole = *channel;
    if (to == kRoll || to == kPitch || to == kYaw) {  // angles may go round
      for (std::size_t k = 1; k < whole.value.size(); ++k) {
        const double turn = std::round((whole.value[k] - whole.value[k - 1]) / kFullTurn);
        if (std::isfinite(turn)) whole.value[k] -= kFullTurn * turn;
      }
    }
    m.signals[to] = interpolated(whole, grid);
  };
  for (const InertialChannel channel : enumerators<InertialChannel, kInertialChannels>())
    take(channel, kSignalNames[channel]);
  take(kGyroZ, "yaw_rate");
  take(kGyroX, "roll_rate");
  m.hand_wheel = m.signals[kSteer].empty();
  take(kSteer, "steering_wheel");
  return m;
}

DriveAxisCheck check_drive_axes(const DriveMotion& given, std::span<const ChannelOrigin> origins) {
  DriveAxisCheck check;
  DriveMotion m = given;
  const auto& s = given.signals;
  const Values speed_change = s[kSpeed].empty() ? Values() : change(s[kSpeed], m.step);
  const Values turning = s[kSpeed].empty() || s[kGyroZ].empty() ? Values() : product(s[kSpeed], s[kGyroZ]);
  const Exchange exchange = exchanged(given, speed_change, turning);
  for (std::size_t i = 0; i < 3; ++i) m.signals[kAccelAxes[i]] = s[exchange.from[i]];

  std::vector<Compared> compared = compare(m);
  const double vertical = median_of(m.signals[kAccelZ]);
  Factors right;
  right.fill(1.0);
  for (Compared& c : compared) c.relation.fits = c.relation.judged && c.agrees(right);

  std::vector<Suspect> all = suspects();
  std::erase_if(all, [&](const Suspect& x) { return !concerns(x, compared, vertical); });
  std::vector<std::vector<std::size_t>> found;
  std::vector<std::size_t> chosen;
  for (std::size_t count = 0; count <= kMostFaults && found.empty(); ++count)
    explain(compared, all, count, 0, chosen, right, vertical, found);
  Factors wrong = right;
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::vector<DriveFault> faults;
    for (const std::size_t k : found[i]) faults.push_back(described(all[k], m, compared, exchange, origins));
    if (i == 0) {
      check.faults = std::move(faults);
      for (const std::size_t k : found[i]) {
        for (const InertialChannel x : all[k].signals) wrong[x] *= all[k].factor;
      }
    } else {
      check.or_else.push_back(std::move(faults));
    }
  }
  for (const Compared& c : compared) {
    if (auto f = steering_fault(m, c, wrong, origins)) check.faults.push_back(std::move(*f));
  }
  if (exchange.any()) {
    DriveFault f{.text = "axes of the accelerometer are exchanged", .correlation = 1.0, .lines = {}};
    for (std::size_t i = 0; i < 3; ++i) {
      const InertialChannel to = kAccelAxes[i], from = exchange.from[i];
      if (to != from && !s[from].empty()) f.lines.push_back(line(to, source_of(from, origins), 1.0, origins));
    }
    for (const Compared& c : compared) {
      if (c.relation.judged && (c.over.front() == kAccelX || c.over.front() == kAccelY))
        f.correlation = std::min(f.correlation, std::abs(c.relation.correlation));
    }
    check.faults.insert(check.faults.begin(), std::move(f));
  }
  if (std::isfinite(vertical) && std::abs(vertical / kGravity - 2.0) < 0.3)
    check.notes.push_back(fmt::format("accel_z is {:.2f} m/s^2 in the median: gravity is counted twice", vertical));
  std::ranges::move(notes_on(compared, !found.empty()), std::back_inserter(check.notes));
  for (Compared& c : compared) check.relations.push_back(std::move(c.relation));
  return check;
}

}  // namespace veridyn::recording
