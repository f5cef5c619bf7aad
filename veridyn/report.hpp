#pragma once

/// Results as one self-contained HTML file.
///
///     report::identification_report(study, analysis, context)  // of a flight, as a Document
///     report::drive_report(study, analysis, context)           // of a drive; muscle_report, cueing_report ...
///     report::to_html(document)                                // the page; also of a Document of your own
///
/// Component `report`.

#include "veridyn/report/aircraft_report.hpp"
#include "veridyn/report/comparison_report.hpp"
#include "veridyn/report/cueing_report.hpp"
#include "veridyn/report/document/document.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/drive_report.hpp"
#include "veridyn/report/drive_tracking_report.hpp"
#include "veridyn/report/ground_report.hpp"
#include "veridyn/report/live_report.hpp"
#include "veridyn/report/muscle_report.hpp"
#include "veridyn/report/muscle_task_report.hpp"
#include "veridyn/report/regression_report.hpp"
#include "veridyn/report/response_report.hpp"
#include "veridyn/report/sensitivity_report.hpp"
#include "veridyn/report/similarity_report.hpp"
#include "veridyn/report/tracking_report.hpp"
#include "veridyn/report/vehicle_report.hpp"
