// veridyn cue STUDY: a drive on a motion platform, by one or several washout algorithms, scored.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "apps/veridyn/live/cue_live.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/cueing/cueing_study.hpp"
#include "veridyn/report/cueing_report.hpp"
#include "veridyn/report/document/html.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::cueing;

/// Where the platform is commanded to be and where it is, sample by sample.
std::string motion_csv(const CueingRun& run, const Platform& platform) {
  std::string text = "time[s]";
  const std::vector<PlatformAxis> axes = platform.limits.moving_axes();
  for (const char* what : {"ordered", "reached"}) {
    for (const PlatformAxis a : axes) text += fmt::format(",{}_{}[{}]", what, name_of(a), turns(a) ? "rad" : "m");
  }
  text += "\n";
  for (std::size_t k = 0; k < run.steps.size(); ++k) {
    text += fmt::format("{}", run.vehicle[k].time);
    for (const PlatformState* s : {&run.steps[k].ordered, &run.steps[k].reached}) {
      for (const PlatformAxis a : axes) text += fmt::format(",{}", axis(*s, a).position);
    }
    text += "\n";
  }
  return text;
}

std::string score_csv(const CueingResult& result, const Platform& platform) {
  std::string text = "algorithm,cue,figure,value,low,high,unit\n";
  for (const AlgorithmResult& a : result.algorithms) {
    for (const Cue cue : kAllCues) {
      const CueScore& s = a.score.cues[cue];
      const auto line = [&](std::string_view figure, const Measured& m, std::string_view unit) {
        text +=
            fmt::format("{},{},{},{},{},{},{}\n", a.run.algorithm, name_of(cue), figure, m.value, m.low, m.high, unit);
      };
      line("rms_error", s.rmse, unit_of(cue));
      line("pearson", s.pearson, "1");
      line("lag", s.lag, "s");
      line("correlation_at_lag", s.at_lag, "1");
      line("time_above_threshold", s.above, "1");
      line("physical_pearson", s.physical_pearson, "1");
      line("physical_lag", s.physical_lag, "s");
      const AlgorithmResult& first = result.algorithms.front();
      if (&a == &first) continue;
      line(fmt::format("pearson_minus_{}", first.run.algorithm),
           difference(a.score, first.score, cue, CueFigure::kPearson), "1");
      line(fmt::format("lag_minus_{}", first.run.algorithm), difference(a.score, first.score, cue, CueFigure::kLag),
           "s");
    }
    const auto plain = [&](std::string_view of, const char* figure, double value, std::string_view unit) {
      text += fmt::format("{},{},{},{},,,{}\n", a.run.algorithm, of, figure, value, unit);
    };
    plain("platform", "turns_felt_at_rest", a.score.felt_return, "1");
    if (a.score.leg_speed > 0.0) plain("legs", "rate_used", a.score.leg_speed, "1");
    for (const PlatformAxis which : platform.limits.moving_axes()) {
      const AxisScore& score = a.score.axes[which];
      plain(name_of(which), "range_used", score.used, "1");
      plain(name_of(which), "held_back", score.limited, "1");
      plain(name_of(which), "rate_used", score.rate, "1");
      plain(name_of(which), "rms_jerk", score.rms_jerk, turns(which) ? "rad/s^3" : "m/s^3");
    }
    for (const std::size_t pair : {1U, 0U}) {
      const Measured& e = a.score.pairs[pair];
      text += fmt::format("{},{},perceived_error,{},{},{},1\n", a.run.algorithm,
                          pair == 0 ? "sway and roll" : "surge and pitch", e.value, e.low, e.high);
    }
  }
  return text;
}

std::string false_cues_csv(const CueingResult& result) {
  std::string text = "algorithm,cue,kind,begin[s],end[s],size,unit\n";
  for (const AlgorithmResult& a : result.algorithms) {
    for (const FalseCue& f : a.score.false_cues)
      text += fmt::format("{},{},{},{:.2f},{:.2f},{},{}\n", a.run.algorithm, name_of(f.cue), name_of(f.kind), f.begin,
                          f.end, f.size, unit_of(f.cue));
  }
  return text;
}

std::string response_csv(const CueingResult& result) {
  std::string text = "algorithm,cue,frequency[rad/s],gain,phase[rad]\n";
  for (const AlgorithmResult& a : result.algorithms) {
    for (const auto& [cue, points] : a.response) {
      for (const ResponsePoint& p : points)
        text += fmt::format("{},{},{},{},{}\n", a.run.algorithm, name_of(cue), p.frequency, p.gain, p.phase);
    }
  }
  return text;
}

Summary measured(const Measured& m) { return Summary::object({{"value", m.value}, {"low", m.low}, {"high", m.high}}); }

Summary summary_of(const OutputFolder& folder, const CueingStudy& study, const CueingResult& result) {
  Summary s;
  s["folder"] = folder.path().string();
  s["platform"] = study.platform.name;
  s["notes"] = study.notes;
  for (const std::size_t pair : {1U, 0U}) {
    if (!result.least[pair]) continue;
    s["least_error"][pair == 0 ? "sway and roll" : "surge and pitch"] =
        Summary::object({{"error", result.least[pair]->error},
                         {"platform_that_stands", result.least[pair]->still},
                         {"residual", result.least[pair]->residual}});
  }
  s["algorithms"] = Summary::array();
  for (const AlgorithmResult& a : result.algorithms) {
    Summary of;
    of["name"] = a.run.algorithm;
    for (const Cue cue : kAllCues) {
      const CueScore& score = a.score.cues[cue];
      Summary& to = of["cues"][std::string(name_of(cue))];
      to["pearson"] = measured(score.pearson);
      to["lag_s"] = measured(score.lag);
      to["rms_error"] = measured(score.rmse);
    }
    of["perceived_error"]["surge and pitch"] = measured(a.score.pairs[1]);
    of["perceived_error"]["sway and roll"] = measured(a.score.pairs[0]);
    of["false_cues"] = a.score.false_cues.size();
    s["algorithms"].push_back(of);
  }
  return s;
}

void print_scores(const CommonOptions& options, const CueingStudy& study, const CueingResult& result) {
  for (const std::string& note : study.notes) print_line(options, "note: " + note);
  for (const std::string& note : result.algorithms.front().score.notes) print_line(options, "note: " + note);
  for (const std::string& note : result.notes) print_line(options, "note: " + note);
  print_line(options, fmt::format("{:<14} {:>18} {:>18} {:>12}  {}", "", "surge r / lag [s]", "sway r / lag [s]",
                                  "false cues", "perceived error, surge / sway"));
  for (const AlgorithmResult& a : result.algorithms) {
    const auto cell = [&](Cue cue) {
      const CueScore& s = a.score.cues[cue];
      return std::isfinite(s.pearson.value) ? fmt::format("{:.3f} / {:.2f}", s.pearson.value, s.lag.value) : "-";
    };
    print_line(options, fmt::format("{:<14} {:>18} {:>18} {:>12}  {:.3g} / {:.3g}", a.run.algorithm, cell(Cue::kSurge),
                                    cell(Cue::kSway), a.score.false_cues.size(), a.score.pairs[1].value,
                                    a.score.pairs[0].value));
  }
  const auto& [sway, surge] = result.least;
  if (surge && sway) {
    print_line(options, fmt::format("{:<14} {:>18} {:>18} {:>12}  {:.3g} / {:.3g}", "(stands still)", "", "", "",
                                    surge->still, sway->still));
    print_line(options, fmt::format("{:<14} {:>18} {:>18} {:>12}  {:.3g} / {:.3g}", "(least)", "", "", "", surge->error,
                                    sway->error));
  }
}

}  // namespace

int cue_platform(const StudyRun& run) {
  if (run.arguments.given("--live")) return cue_live(run);
  OutputFolder folder(run.options().out);
  TerminalProgress progress = progress_of(run.options());
  const CueingStudy study = cueing::read_study(run.study, progress);
  run.study.root().finish();
  const CueingResult result = cueing::cue(study, progress);
  if (result.interrupted) throw Interrupted();
  for (const AlgorithmResult& a : result.algorithms)
    folder.write(fmt::format("platform_{}.csv", a.run.algorithm), motion_csv(a.run, study.platform));
  folder.write("score.csv", score_csv(result, study.platform));
  folder.write("false_cues.csv", false_cues_csv(result));
  if (study.response) folder.write("omct.csv", response_csv(result));
  folder.write("report.html", report::to_html(report::cueing_report(study, result, program_name())));
  if (study.knobs) folder.write("knobs.html", report::to_html(report::knob_report(study, result, program_name())));
  const std::string files = fmt::format("{}", fmt::join(folder.files(), ", "));
  folder.publish(run.record(study.seed, study.inputs), run.options(), summary_of(folder, study, result));
  print_scores(run.options(), study, result);
  print_line(run.options(), fmt::format("wrote {} in {}", files, folder.path().string()));
  return kDone;
}

Command cue_command() {
  return {.name = "cue",
          .summary = "a drive on a motion platform: washout algorithms, limits, and how it feels",
          .arguments =
              {{.name = "STUDY", .help = "study file; its table [cue] names the algorithms"},
               {.name = "--live", .help = "follow telemetry as it comes, by the study's [live]", .value = false},
               {.name = "--start", .help = "with --live: start as soon as all is ready", .value = false},
               {.name = "--seconds", .help = "with --live: park and end after this time; 0: with Ctrl-C", .value = 0.0},
               {.name = "--replay", .help = "a recorded live run, computed again and compared", .type = "FILE"}},
          .default_out = "out/cue",
          .example = "veridyn cue examples/studies/cueing/double_lane_change.toml --out out/cue",
          .run = [](const Arguments& arguments) {
            const bool replayed = !arguments.text("--replay").empty(), of_study = !arguments.text("STUDY").empty();
            if (replayed == of_study)
              throw InputError("cue", "takes a study, or --replay and a recorded run: either, not both");
            return replayed ? cue_replay(arguments) : run_on_study("cue", arguments);
          }};
}

}  // namespace veridyn::app
