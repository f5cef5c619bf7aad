#include "veridyn/report/drive_tracking_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "veridyn/report/document/number_format.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/report/parts/analysis_sections.hpp"
#include "veridyn/report/parts/estimate_tables.hpp"
#include "veridyn/report/parts/remarks.hpp"
#include "veridyn/report/vehicle_report.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::vehicle;

std::string name_of(TrackedAxle axle) { return std::string(kTrackedAxleNames[axle]); }

TimeSeries axle_figure(const DriveTracker& tracker, TrackedAxle axle, std::optional<double> truth) {
  const DriveTrackHistory& h = tracker.history(axle);
  const std::string name = name_of(axle);
  const ReadableNumber unit = readable(1.0, std::string(kTrackedAxleUnits[axle]));
  TimeSeries figure{.title = fmt::format("{} over time", name),
                    .caption = "Bands are 95 %. Grey: not excited, the last value is held.",
                    .samples = h.time};
  Panel value{.label = name, .unit = unit.unit};
  const std::vector<double> shown = scaled(h.value, unit.value);
  value.lines.push_back(followed_line(shown, scaled(h.sigma, unit.value), std::max(std::abs(shown.back()), 1e-12)));
  if (truth) {
    value.lines.push_back({.name = "truth at the start",
                           .y = std::vector<double>(h.time.size(), *truth * unit.value),
                           .role = Role::kReference});
  }
  figure.panels.push_back(std::move(value));
  figure.panels.push_back(
      {.label = "suspicion (1: alarm)", .unit = "1", .lines = {{.name = "suspicion", .y = h.suspicion}}, .height = 80});
  figure.spans = spans_where(h.time, h.held, "held", SpanTone::kMuted);
  for (const DriveChange& c : tracker.changes()) {
    if (c.axle == axle) {
      figure.spans.push_back(
          {.from = c.change.began_s, .to = c.change.detected_s, .label = "change", .tone = SpanTone::kBad});
    }
  }
  return figure;
}

}  // namespace

Document drive_tracking_report(const VehicleStudy& study, const TrackedDrive& drive,
                               const DriveReportContext& context) {
  Document document = started_document(study.name, "Cornering stiffness followed on line", context.program);
  const estimation::Estimate estimate = drive.estimate();
  document.facts = {{"Vehicle", study.subject_name}, {"Log", study.log.mapped.recording.source}};
  const DriveTracker* tracker = drive.tracker();
  document.verdict.headline = estimate.verdict;
  if (tracker != nullptr && !estimate.evidence.empty()) {
    document.verdict = verdict_of(estimate);
    document.verdict.lines.insert(document.verdict.lines.begin(), estimate.verdict);
  }
  if (tracker == nullptr) {
    document.verdict.level = Level::kBad;
    return document;
  }
  const auto& changes = tracker->changes();
  if (!changes.empty() && document.verdict.level == Level::kGood) document.verdict.level = Level::kCaution;
  document.verdict.word = changes.empty() ? "No change" : "Changed";
  document.facts.push_back({"Rows", fmt::format("{} at {:g} Hz", tracker->rows(), tracker->row_rate_Hz())});
  document.facts.push_back({"Latency", fmt::format("{:.2f} s", tracker->latency_s())});

  Table table{.title = "Changes found", .columns = change_columns("what", "how")};
  for (const DriveChange& c : changes) table.rows.push_back(change_row(name_of(c.axle), c.change));
  Section found{.title = "Changes"};
  if (changes.empty()) {
    found.blocks.emplace_back(Paragraph{"None."});
  } else {
    found.blocks.emplace_back(std::move(table));
  }
  document.sections.push_back(std::move(found));

  Section section{.title = "Over time"};
  for (const TrackedAxle axle : kAllTrackedAxles) {
    if (tracker->history(axle).time.empty()) continue;
    const auto truth = study.truth.find(name_of(axle));
    section.blocks.emplace_back(
        axle_figure(*tracker, axle, truth == study.truth.end() ? std::nullopt : std::optional(truth->second)));
  }
  document.sections.push_back(std::move(section));
  if (!estimate.evidence.empty()) document.sections.push_back(evidence_section(estimate));
  add_notes(document, drive.notes());
  add_warnings(document, estimate.warnings);
  return document;
}

}  // namespace veridyn::report
