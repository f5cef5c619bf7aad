#include "veridyn/cueing/score/frequency_response.hpp"

#include <Eigen/LU>
#include <cmath>

namespace veridyn::cueing {
namespace {

recording::MotionSample moved(Cue cue, double value) {
  recording::MotionSample s;
  s.frame = Frame::kFrd;
  s.force = recording::force_at_rest(Frame::kFrd);
  const auto axis = static_cast<Eigen::Index>(cue) % 3;
  (cue < Cue::kRoll ? s.force : s.rate)(axis) += value;
  return s;
}

double felt(const recording::MotionSample& s, Cue cue) {
  const auto axis = static_cast<Eigen::Index>(cue) % 3;
  return cue < Cue::kRoll ? (s.force - recording::force_at_rest(Frame::kFrd))(axis) : s.rate(axis);
}

ResponsePoint at_frequency(const Washout& washout, const Platform& platform, Cue cue, const ResponseOptions& o,
                           double omega) {
  CueingChain chain(washout.clone(), platform);
  chain.reset(moved(cue, 0.0));
  const double size = cue < Cue::kRoll ? o.force : o.rate;
  const double period = 2.0 * kPi / omega;
  const double measured = period * std::max(1.0, std::ceil(2.0 / period));
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Eigen::Vector3d products = Eigen::Vector3d::Zero();
  for (long k = 1; static_cast<double>(k) * o.step <= o.settling + measured; ++k) {
    const double t = static_cast<double>(k) * o.step;
    const CueingStep step = chain.step(moved(cue, size * std::sin(omega * t)), o.step);
    if (t < o.settling) continue;
    const Eigen::Vector3d wave(std::sin(omega * t), std::cos(omega * t), 1.0);
    squares += wave * wave.transpose();
    products += wave * felt(rider_motion(step.reached, platform.rider), cue);
  }
  const Eigen::Vector3d fit = squares.inverse() * products;
  return {omega, std::hypot(fit(0), fit(1)) / size, std::atan2(fit(1), fit(0))};
}

}  // namespace

std::vector<double> omct_frequencies() {
  return {0.1, 0.158, 0.251, 0.398, 0.631, 1.0, 1.585, 2.512, 3.981, 6.31, 10.0, 15.849};
}

std::vector<ResponsePoint> frequency_response(const Washout& washout, const Platform& platform, Cue cue,
                                              const ResponseOptions& options, const Progress& progress) {
  std::vector<ResponsePoint> points;
  for (const double omega : options.frequencies) {
    if (progress.interrupted()) break;
    points.push_back(at_frequency(washout, platform, cue, options, omega));
  }
  return points;
}

std::vector<ResponsePoint> outside(const std::vector<ResponsePoint>& response, const std::vector<MaskPoint>& mask) {
  std::vector<ResponsePoint> found;
  for (const ResponsePoint& p : response) {
    for (std::size_t i = 0; i + 1 < mask.size(); ++i) {
      const MaskPoint &a = mask[i], &b = mask[i + 1];
      if (p.frequency < a.frequency || p.frequency > b.frequency) continue;
      const double part = (p.frequency - a.frequency) / (b.frequency - a.frequency);
      // A limit that is infinite at one end is so in between.
      const auto between = [&](double low, double high) {
        return part == 0.0 ? low : part == 1.0 ? high : low + part * (high - low);
      };
      if (p.gain < between(a.least_gain, b.least_gain) || p.gain > between(a.most_gain, b.most_gain) ||
          p.phase < between(a.least_phase, b.least_phase) || p.phase > between(a.most_phase, b.most_phase))
        found.push_back(p);
      break;
    }
  }
  return found;
}

}  // namespace veridyn::cueing
