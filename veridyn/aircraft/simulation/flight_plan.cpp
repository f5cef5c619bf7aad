#include "veridyn/aircraft/simulation/flight_plan.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

namespace {

constexpr double kPause = 2.0;  ///< between the surfaces of one doublet or 3-2-1-1 [s]

double pulse_count(ManoeuvreKind kind) {
  return kind == ManoeuvreKind::kPulse ? 1.0 : kind == ManoeuvreKind::kDoublet ? 2.0 : 7.0;
}

/// The shape of a doublet or 3-2-1-1 at `u` pulses after its start.
double pulse_shape(ManoeuvreKind kind, double u) {
  if (u < 0.0) return 0.0;
  if (kind == ManoeuvreKind::kPulse) return u < 1.0 ? 1.0 : 0.0;
  if (kind == ManoeuvreKind::kDoublet) return u < 1.0 ? 1.0 : u < 2.0 ? -1.0 : 0.0;
  return u < 3.0 ? 1.0 : u < 5.0 ? -1.0 : u < 6.0 ? 1.0 : u < 7.0 ? -1.0 : 0.0;
}

/// Largest absolute value over one period, on a grid of 16 points a shortest wave.
double peak(const Multisine& m, double duration) {
  const int n = static_cast<int>(std::ceil(16.0 * m.frequency.back() * duration));
  double largest = 0.0;
  for (int i = 0; i < n; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < m.frequency.size(); ++k) {
      sum += std::sin(2.0 * kPi * m.frequency[k] * duration * i / n + m.phase[k]);
    }
    largest = std::max(largest, std::abs(sum));
  }
  return largest;
}

double raw_value(const Multisine& m, double t) {
  double sum = 0.0;
  for (std::size_t k = 0; k < m.frequency.size(); ++k) {
    sum += std::sin(2.0 * kPi * m.frequency[k] * t + m.phase[k]);
  }
  return sum;
}

/// Lowers the peak: first clips the signal and keeps the phases of what is left (Van den Bos 1987), with an ever higher
/// clip; then changes one phase at a time as long as that helps, in ever smaller steps. Sine and cosine of every
/// harmonic are tabled once, so that a trial costs one pass over the grid.
void lower_peak(Multisine& m, double duration) {
  const auto n = static_cast<Eigen::Index>(std::ceil(16.0 * m.frequency.back() * duration));
  const auto harmonics = static_cast<Eigen::Index>(m.frequency.size());
  Eigen::ArrayXXd sine(n, harmonics), cosine(n, harmonics);
  const Eigen::ArrayXd time =
      Eigen::ArrayXd::LinSpaced(n, 0.0, duration * static_cast<double>(n - 1) / static_cast<double>(n));
  for (Eigen::Index k = 0; k < harmonics; ++k) {
    const double omega = 2.0 * kPi * m.frequency[k];
    sine.col(k) = (omega * time).sin();
    cosine.col(k) = (omega * time).cos();
  }
  const auto signal = [&](const Eigen::ArrayXd& phase) -> Eigen::ArrayXd {
    return (sine.matrix() * phase.cos().matrix() + cosine.matrix() * phase.sin().matrix()).array();
  };
  Eigen::ArrayXd phase = Eigen::Map<const Eigen::ArrayXd>(m.phase.data(), harmonics);
  Eigen::ArrayXd sum = signal(phase);
  Eigen::ArrayXd best_phase = phase;
  double best = sum.abs().maxCoeff();
  constexpr int kClippings = 300;
  for (int i = 0; i < kClippings; ++i) {
    const double level = (0.8 + 0.19 * i / kClippings) * sum.abs().maxCoeff();
    const Eigen::VectorXd clipped = sum.min(level).max(-level).matrix();
    const Eigen::VectorXd in_phase = sine.matrix().transpose() * clipped;
    const Eigen::VectorXd quadrature = cosine.matrix().transpose() * clipped;
    for (Eigen::Index k = 0; k < harmonics; ++k) phase(k) = std::atan2(quadrature(k), in_phase(k));
    sum = signal(phase);
    const double p = sum.abs().maxCoeff();
    if (p < best) {
      best = p;
      best_phase = phase;
    }
  }
  phase = best_phase;
  sum = signal(phase);
  Eigen::ArrayXd trial(n);
  for (double reach = 0.5; reach > 0.005; reach *= 0.7) {
    for (Eigen::Index k = 0; k < harmonics; ++k) {
      for (const double change : {-reach, reach}) {
        const double next = phase(k) + change;
        trial = sum + (std::cos(next) - std::cos(phase(k))) * sine.col(k) +
                (std::sin(next) - std::sin(phase(k))) * cosine.col(k);
        const double p = trial.abs().maxCoeff();
        if (p >= best) continue;
        best = p;
        phase(k) = next;
        sum = trial;
        break;
      }
    }
  }
  Eigen::Map<Eigen::ArrayXd>(m.phase.data(), harmonics) = phase;
}

/// Shifts the time origin to a zero crossing, so that the signal begins without a step.
void start_at_zero(Multisine& m, double duration) {
  const int n = static_cast<int>(std::ceil(16.0 * m.frequency.back() * duration));
  for (int i = 0; i < n; ++i) {
    double a = duration * i / n, b = duration * (i + 1) / n;
    double va = raw_value(m, a);
    const double vb = raw_value(m, b);
    if (!(va <= 0.0 && vb > 0.0)) continue;
    for (int halving = 0; halving < 60; ++halving) {
      const double c = 0.5 * (a + b);
      (raw_value(m, c) <= 0.0 ? a : b) = c;
    }
    for (std::size_t k = 0; k < m.frequency.size(); ++k) {
      m.phase[k] = std::remainder(m.phase[k] + 2.0 * kPi * m.frequency[k] * a, kFullTurn);
    }
    return;
  }
}

}  // namespace

std::string_view name_of(ManoeuvreKind kind) {
  switch (kind) {
    case ManoeuvreKind::kDoublet:
      return "doublet";
    case ManoeuvreKind::k3211:
      return "3211";
    case ManoeuvreKind::kMultisine:
      return "multisine";
    case ManoeuvreKind::kTurn:
      return "turn";
    case ManoeuvreKind::kPulse:
      return "pulse";
  }
  return {};
}

double Manoeuvre::end() const {
  if (kind == ManoeuvreKind::kMultisine || kind == ManoeuvreKind::kTurn) return start + duration;
  const double n = static_cast<double>(surfaces.size());
  return start + n * pulse_count(kind) * pulse + std::max(0.0, n - 1.0) * kPause;
}

PerSurface<double> default_amplitudes(const Subject& s, const Trim& trim, const LinearModel& m) {
  // Steady state of the fast modes under one surface: w and q for the elevator, v and r for the rudder.
  const auto steady = [&m](int i, int j, int control) {
    Eigen::Matrix2d A;
    A << m.A(i, i), m.A(i, j), m.A(j, i), m.A(j, j);
    const Eigen::Vector2d b(m.B(i, control), m.B(j, control));
    return Eigen::Vector2d(-A.fullPivLu().solve(b));
  };
  const double Va = trim.condition.airspeed;
  const double alpha_per_de = std::abs(steady(2, 4, 0)(0)) / Va;
  const double p_per_da = std::abs(m.B(3, 1) / m.A(3, 3));
  const double beta_per_dr = std::abs(steady(1, 5, 2)(0)) / Va;
  const auto limited = [](double target, double gain, const Actuator& a, double trimmed) {
    const double travel = 0.5 * std::min(a.upper - trimmed, trimmed - a.lower);
    return gain > 1e-9 ? std::clamp(target / gain, 0.0, std::max(0.0, travel)) : 0.0;
  };
  return {{limited(3.0 * kDegree, alpha_per_de, s.elevator, trim.controls.de),
           limited(20.0 * kDegree, p_per_da, s.aileron, trim.controls.da),
           limited(4.0 * kDegree, beta_per_dr, s.rudder, trim.controls.dr), 0.15}};
}

std::vector<Manoeuvre> default_plan(double duration, const PerSurface<double>& amplitudes) {
  using enum Surface;
  using enum ManoeuvreKind;
  const auto amplitude = [&amplitudes](Surface s) { return amplitudes[s]; };
  std::vector<Manoeuvre> plan;
  const auto add = [&](ManoeuvreKind kind, double start, double length, const std::vector<Surface>& surfaces,
                       double pulse, double bank) {
    Manoeuvre m;
    m.kind = kind;
    m.start = start;
    m.duration = length;
    m.pulse = pulse;
    m.bank = bank;
    for (const Surface s : surfaces) {
      if (amplitude(s) <= 0.0) continue;  // no such surface, or one without effect
      m.surfaces.push_back(s);
      m.amplitude.push_back(amplitude(s));
    }
    if ((kind == kTurn || !m.surfaces.empty()) && m.end() <= duration) plan.push_back(m);
  };
  for (double t = 0.0; t < duration; t += 300.0) {
    add(kMultisine, t + 10, 30, {kElevator}, 0.5, 0);
    add(k3211, t + 45, 0, {kElevator}, 0.5, 0);
    add(kDoublet, t + 53, 0, {kElevator}, 1.0, 0);
    add(kMultisine, t + 60, 30, {kAileron, kRudder}, 0.5, 0);
    add(k3211, t + 95, 0, {kAileron, kRudder}, 0.4, 0);
    add(kDoublet, t + 106, 0, {kAileron, kRudder}, 0.7, 0);
    add(kDoublet, t + 114, 0, {kThrottle}, 2.0, 0);
    add(kTurn, t + 122, 15, {}, 0.5, 25 * kDegree);
    add(kMultisine, t + 145, 30, {kElevator}, 0.5, 0);
    add(k3211, t + 180, 0, {kElevator}, 0.7, 0);
    add(kDoublet, t + 189, 0, {kElevator}, 0.5, 0);
    add(kMultisine, t + 195, 30, {kAileron, kRudder}, 0.5, 0);
    add(k3211, t + 230, 0, {kAileron, kRudder}, 0.5, 0);
    add(kDoublet, t + 242, 0, {kAileron, kRudder}, 0.5, 0);
    add(kDoublet, t + 250, 0, {kThrottle}, 2.0, 0);
    add(kTurn, t + 258, 15, {}, 0.5, -25 * kDegree);
    add(k3211, t + 280, 0, {kElevator}, 0.6, 0);
    add(k3211, t + 288, 0, {kAileron, kRudder}, 0.35, 0);
  }
  return plan;
}

namespace {

/// Refuses keys that its kind has not, and wants those that it needs.
void check_keys_of_kind(const StudyTable& table, const Manoeuvre& m) {
  const bool turn = m.kind == ManoeuvreKind::kTurn, multisine = m.kind == ManoeuvreKind::kMultisine;
  const std::tuple<const char*, bool, bool> uses[] = {{"duration", turn || multisine, true},
                                                      {"bank", turn, true},
                                                      {"surfaces", !turn, true},
                                                      {"amplitude", !turn, false},
                                                      {"pulse", !turn && !multisine, false},
                                                      {"band", multisine, false}};
  std::vector<std::string> missing;
  for (const auto& [key, belongs, needed] : uses) {
    if (!belongs && table.has(key)) table.fail(key, fmt::format("is no key of a {}", table.text("kind")));
    if (belongs && needed && !table.has(key)) missing.emplace_back(key);
  }
  refuse_missing(table, missing);
}

void check_manoeuvre(const StudyTable& table, Manoeuvre& m) {
  check_keys_of_kind(table, m);
  if (!(std::abs(m.bank) <= 60 * kDegree)) table.fail("bank", "is more than 60 deg");
  if (m.kind == ManoeuvreKind::kTurn) return;
  if (m.surfaces.empty()) table.fail("surfaces", "names no surface");
  if (m.amplitude.size() == 1) m.amplitude.resize(m.surfaces.size(), m.amplitude[0]);
  if (!m.amplitude.empty() && m.amplitude.size() != m.surfaces.size())
    table.fail("amplitude", fmt::format("has {} numbers, expected 1 or {}", m.amplitude.size(), m.surfaces.size()));
  if (m.kind != ManoeuvreKind::kMultisine) return;
  const double first = std::ceil(m.f_min * m.duration - 1e-9), last = std::floor(m.f_max * m.duration + 1e-9);
  if (last - first + 1.0 < static_cast<double>(m.surfaces.size()))
    table.fail("duration", fmt::format("of {:g} s is too short for {} orthogonal signals between {:g} and {:g} Hz",
                                       m.duration, m.surfaces.size(), m.f_min, m.f_max));
}

void read_amplitude(const StudyTable& table, const std::string& key, Manoeuvre& m) {
  m.amplitude = table.numbers(key, m.surfaces == std::vector<Surface>{Surface::kThrottle} ? "1" : "rad");
}

void read_band(const StudyTable& table, const std::string& key, Manoeuvre& m) {
  const std::vector<double> band = table.numbers(key, "1/s");
  if (band.size() != 2 || !(band[0] > 0.0 && band[1] > band[0]))
    table.fail(key, "is not [lowest, highest] in Hz with 0 < lowest < highest");
  m.f_min = band[0];
  m.f_max = band[1];
}

}  // namespace

const KeyTable<Manoeuvre>& Manoeuvre::keys() {
  using M = Manoeuvre;
  using enum ManoeuvreKind;
  static const auto table =
      KeyTable<M>("manoeuvre", "What the pilot does beside keeping the aircraft straight and level.")
          .choice(
              "kind", &M::kind,
              {{"doublet", kDoublet}, {"3211", k3211}, {"multisine", kMultisine}, {"turn", kTurn}, {"pulse", kPulse}},
              "`multisine`: sums of sines on several surfaces at once that are orthogonal to each other; `pulse`: one, "
              "held")
          .required()
          .number("start", &M::start, "s", kNotNegative, "when it begins")
          .required()
          .number("duration", &M::duration, "s", kPositive, "of multisines and turns")
          .otherwise("required for multisines and turns")
          .choices("surfaces", &M::surfaces, choices_of<Surface>(kSurfaceNames),
                   "all but turns; in doublets and 3-2-1-1 one after another, with two seconds between")
          .otherwise("required except for turns")
          .other({"amplitude", "rad", "one number, or one for each surface",
                  "alpha by about 3 deg, a roll rate of 20 deg/s, sideslip of 4 deg; at most half of the travel",
                  "largest deflection; of the throttle alone without unit", true},
                 read_amplitude)
          .number("pulse", &M::pulse, "s", kPositive, "length of one unit of a doublet, 3-2-1-1 or pulse")
          .other({"band", "Hz", "two frequencies", "[0.1, 2]", "of a multisine"}, read_band)
          .number("bank", &M::bank, "rad", kAnyNumber, "of a turn, positive to the right; at most 60 deg")
          .otherwise("required for turns")
          .check(check_manoeuvre);
  return table;
}

double Multisine::value(double t) const { return gain * raw_value(*this, t); }

std::vector<Multisine> make_multisines(std::size_t count, double duration, double f_min, double f_max) {
  std::vector<Multisine> out(count);
  const int first = std::max(1, static_cast<int>(std::ceil(f_min * duration - 1e-9)));
  const int last = static_cast<int>(std::floor(f_max * duration + 1e-9));
  for (int k = first; k <= last; ++k) {
    out[static_cast<std::size_t>(k - first) % count].frequency.push_back(k / duration);
  }
  for (Multisine& m : out) {
    VERIDYN_ASSERT(!m.frequency.empty());
    const double n = static_cast<double>(m.frequency.size());
    for (std::size_t k = 0; k < m.frequency.size(); ++k) {
      const double j = static_cast<double>(k) + 1.0;
      m.phase.push_back(std::remainder(-kPi * j * (j - 1.0) / n, kFullTurn));
    }
    lower_peak(m, duration);
    start_at_zero(m, duration);
    m.gain = 1.0 / peak(m, duration);
  }
  return out;
}

Excitation::Excitation(std::vector<Manoeuvre> manoeuvres) : manoeuvres_(std::move(manoeuvres)) {
  // The phases of one multisine take 20 ms: equal ones of a long flight are designed once.
  using Design = std::tuple<std::size_t, double, double, double>;
  std::map<Design, std::vector<Multisine>> designs;
  for (const Manoeuvre& m : manoeuvres_) {
    if (m.kind != ManoeuvreKind::kMultisine) {
      sines_.emplace_back();
      continue;
    }
    std::vector<Multisine>& design = designs[{m.surfaces.size(), m.duration, m.f_min, m.f_max}];
    if (design.empty()) design = make_multisines(m.surfaces.size(), m.duration, m.f_min, m.f_max);
    sines_.push_back(design);
  }
}

PerSurface<double> Excitation::at(double t) const {
  PerSurface<double> out{};
  for (std::size_t i = 0; i < manoeuvres_.size(); ++i) {
    const Manoeuvre& m = manoeuvres_[i];
    if (m.kind == ManoeuvreKind::kTurn || t < m.start || t >= m.end()) continue;
    for (std::size_t k = 0; k < m.surfaces.size(); ++k) {
      double shape = 0.0;
      if (m.kind == ManoeuvreKind::kMultisine) {
        shape = sines_[i][k].value(t - m.start);
      } else {
        const double begin = m.start + static_cast<double>(k) * (pulse_count(m.kind) * m.pulse + kPause);
        shape = pulse_shape(m.kind, (t - begin) / m.pulse);
      }
      out[m.surfaces[k]] += m.amplitude[k] * shape;
    }
  }
  return out;
}

PerSurface<bool> Excitation::excited(double t) const {
  PerSurface<bool> out{};
  for (const Manoeuvre& m : manoeuvres_) {
    if (m.kind == ManoeuvreKind::kTurn || t < m.start || t >= m.end()) continue;
    for (const Surface s : m.surfaces) out[s] = true;
  }
  return out;
}

double Excitation::bank(double t) const {
  for (const Manoeuvre& m : manoeuvres_) {
    if (m.kind == ManoeuvreKind::kTurn && t >= m.start && t < m.end()) return m.bank;
  }
  return kNaN;
}

}  // namespace veridyn::aircraft
