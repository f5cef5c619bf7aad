#include "veridyn/aircraft/tracking/filter_history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/io/tables/csv_text.hpp"
#include "veridyn/numerics/moments.hpp"

namespace veridyn::aircraft {
namespace {

struct HistoryColumn {
  const char* name;    ///< in the history
  const char* source;  ///< in the filter's recording
  const char* unit;
  bool of_model_free = false;
};
constexpr std::size_t kModelBased = 9;
constexpr std::array<HistoryColumn, 14> kHistory{{{"airspeed", "airspeed", "m/s"},
                                                  {"sigma_airspeed", "sigma_airspeed", "m/s"},
                                                  {"alpha", "alpha", "rad"},
                                                  {"sigma_alpha", "sigma_alpha", "rad"},
                                                  {"beta", "beta", "rad"},
                                                  {"sigma_beta", "sigma_beta", "rad"},
                                                  {"wind_north", "wind_north", "m/s"},
                                                  {"wind_east", "wind_east", "m/s"},
                                                  {"wind_down", "wind_down", "m/s"},
                                                  {"model_based", "model_based", "1"},
                                                  {"guard_ratio", "guard_ratio", "1"},
                                                  {"airspeed_model_free", "airspeed", "m/s", true},
                                                  {"alpha_model_free", "alpha", "rad", true},
                                                  {"beta_model_free", "beta", "rad", true}}};

/// The truth at `t` between its samples; NaN outside. `at` is moved along.
double truth_at(const Channel& truth, double t, std::size_t& at) {
  const auto times = truth.times();
  while (at + 2 < times.size() && times[at + 1] <= t) ++at;
  if (times[at] > t || times[at + 1] < t) return kNaN;
  const double share = (t - times[at]) / (times[at + 1] - times[at]);
  return (1.0 - share) * truth.value[at] + share * truth.value[at + 1];
}

}  // namespace

void FilterHistory::append(const Recording& guarded, const Recording& model_free) {
  if (guarded.channels().empty() || model_free.channels().empty()) return;
  const auto times = guarded.at("alpha").times();
  const auto free_times = model_free.at("alpha").times();
  const double last = time_.empty() ? -kInfinity : time_.back();
  std::size_t j = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] <= last) continue;
    while (j < free_times.size() && free_times[j] < times[i]) ++j;
    // The model-free filter ends where a sensor was lost, and with it what can be said.
    if (j == free_times.size()) break;
    if (free_times[j] != times[i]) continue;
    time_.push_back(times[i]);
    for (std::size_t c = 0; c < kColumns; ++c)
      value_[c].push_back(kHistory[c].of_model_free ? model_free.at(kHistory[c].source).value[j]
                                                    : guarded.at(kHistory[c].source).value[i]);
  }
}

const std::vector<double>& FilterHistory::model_based() const { return value_[kModelBased]; }

Recording FilterHistory::recording() const {
  static_assert(kHistory.size() == kColumns);
  Recording out;
  out.source = "filter.csv";
  out.frame = Frame::kFrd;
  const TimeBase time = make_time_base(time_);
  for (std::size_t c = 0; c < kColumns; ++c) out.add(make_channel(kHistory[c].name, kHistory[c].unit, time, value_[c]));
  for (std::size_t i = 0; i < kForceCoefficients.size(); ++i) {
    std::vector<double> source;
    auto next = models_.begin();
    ModelSource now = ModelSource::kNone;
    for (const double t : time_) {
      for (; next != models_.end() && next->from_s <= t; ++next) now = next->source[i];
      source.push_back(static_cast<double>(now));
    }
    out.add(make_channel(fmt::format("model_{}", name_of(kForceCoefficients[i])), "1", time, std::move(source)));
  }
  return out;
}

double FilterHistory::model_based_share() const { return numerics::mean(model_based()); }

std::vector<TimeSpan> FilterHistory::model_free() const {
  std::vector<TimeSpan> spans;
  for (std::size_t k = 0; k < time_.size(); ++k) {
    if (model_based()[k] != 0.0) continue;
    if (k > 0 && model_based()[k - 1] == 0.0) {
      spans.back().end = time_[k];
    } else {
      spans.push_back({time_[k], time_[k]});
    }
  }
  return spans;
}

std::size_t FilterHistory::reverts() const {
  std::size_t count = 0;
  for (std::size_t k = 1; k < time_.size(); ++k)
    if (model_based()[k - 1] != 0.0 && model_based()[k] == 0.0) ++count;
  return count;
}

std::string FilterHistory::statement() const {
  const std::size_t count = reverts();
  return fmt::format(
      "The model-based filter was used {:.0f} % of the time; {}; models given: {}.", 100.0 * model_based_share(),
      count == 0 ? std::string("it was never taken back")
                 : fmt::format("it was taken back {} time{}", count, count > 1 ? "s" : ""),
      std::count_if(models_.begin(), models_.end(), [](const FilterModel& m) { return m.aero.has_value(); }));
}

std::vector<TrackedFilterError> FilterHistory::errors(const Recording& truth) const {
  constexpr double kSettle_s = 10.0;
  std::vector<TrackedFilterError> errors;
  for (const char* quantity : {"airspeed", "alpha", "beta"}) {
    const Channel* channel = truth.find(quantity);
    if (channel == nullptr || channel->size() < 2) continue;
    const std::string free_name = std::string(quantity) + "_model_free";
    const auto column = [&](std::string_view name) -> const std::vector<double>& {
      const auto* found =
          std::find_if(kHistory.begin(), kHistory.end(), [&](const HistoryColumn& c) { return name == c.name; });
      return value_[found - kHistory.begin()];
    };
    const std::vector<double>& guarded = column(quantity);
    const std::vector<double>& free = column(free_name);
    TrackedFilterError error{.quantity = quantity, .unit = std::string(quantity) == "airspeed" ? "m/s" : "rad"};
    double count = 0.0;
    std::size_t at = 0;
    for (std::size_t k = 0; k < time_.size(); ++k) {
      if (time_[k] < time_.front() + kSettle_s) continue;
      const double expected = truth_at(*channel, time_[k], at);
      if (!std::isfinite(expected)) continue;
      error.guarded += std::pow(guarded[k] - expected, 2);
      error.model_free += std::pow(free[k] - expected, 2);
      count += 1.0;
    }
    if (count == 0.0) continue;
    error.guarded = std::sqrt(error.guarded / count);
    error.model_free = std::sqrt(error.model_free / count);
    errors.push_back(std::move(error));
  }
  return errors;
}

std::string models_csv(const std::vector<FilterModel>& models) {
  std::string text = "from[s],coefficient,source,sigma,values,reason\n";
  for (const FilterModel& m : models) {
    for (std::size_t i = 0; i < kForceCoefficients.size(); ++i) {
      const Coefficient c = kForceCoefficients[i];
      std::string values;
      const CoefficientModel* model = m.aero ? m.aero->find(c) : nullptr;
      if (model != nullptr) {
        const std::vector<std::string> names = model->parameter_names();
        for (std::size_t k = 0; k < names.size(); ++k)
          values += fmt::format("{}{} = {:.6g}", k > 0 ? "; " : "", names[k], model->values[k]);
      }
      text += fmt::format("{},{},{},{},{},{}\n", std::isfinite(m.from_s) ? io::csv_number(m.from_s) : "", name_of(c),
                          to_string(m.source[i]), model != nullptr ? io::csv_number(m.error.initial[i]) : "",
                          io::csv_text(values), io::csv_text(m.reason));
    }
  }
  return text;
}

}  // namespace veridyn::aircraft
