#include "tests/report/sample_document.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "veridyn/core/constants.hpp"

namespace veridyn::report {

namespace {

using std::numbers::pi;

struct Parameter {
  const char* name;
  const char* unit;
  double truth;
  double sigma;
  Status status;
};

constexpr std::array<Parameter, 12> kParameters = {{
    {"CL_0", "", 0.2843, 0.0061, Status::kIdentified},
    {"CL_alpha", "1/rad", 4.9731, 0.0521, Status::kIdentified},
    {"CL_q", "", 6.21, 1.94, Status::kIdentified},
    {"CL_de", "1/rad", 0.3987, 0.0273, Status::kIdentified},
    {"CD_0", "", 0.03113, 0.00048, Status::kIdentified},
    {"CD_k", "", 0.0571, 0.0041, Status::kIdentified},
    {"Cm_0", "", -0.01132, 0.00102, Status::kIdentified},
    {"Cm_alpha", "1/rad", -0.7214, 0.0128, Status::kIdentified},
    {"Cm_q", "", -14.81, 0.731, Status::kIdentified},
    {"Cm_de", "1/rad", -1.1032, 0.0152, Status::kIdentified},
    {"CY_p", "", 0.021, 0.118, Status::kInsignificant},
    {"Cn_p", "", kNaN, kNaN, Status::kNotExcited},
}};

const std::array<const char*, 4> kMethods = {"OLS", "TLS", "GTLS", "PCA-GTLS"};

struct Samples {
  std::mt19937_64 engine{20260501};
  std::normal_distribution<double> normal{0.0, 1.0};
  double operator()() { return normal(engine); }
};

double doublet(double t, double start, double width) {
  if (t < start || t > start + 2.0 * width) return 0.0;
  return t < start + width ? 1.0 : -1.0;
}

std::vector<Span> segments() {
  return {{.from = 20.0, .to = 96.0, .label = "identification", .tone = SpanTone::kPrimary},
          {.from = 108.0, .to = 150.0, .label = "hold-out", .tone = SpanTone::kSecondary}};
}

std::vector<double> seconds(double end, double step) {
  std::vector<double> t;
  for (int k = 0; k * step < end; ++k) t.push_back(k * step);
  return t;
}

Band band_of(const std::vector<double>& centre, const std::vector<double>& half_width) {
  Band band;
  for (std::size_t k = 0; k < centre.size(); ++k) {
    band.low.push_back(centre[k] - half_width[k]);
    band.high.push_back(centre[k] + half_width[k]);
  }
  return band;
}

TimeSeries states() {
  Samples noise;
  const std::vector<double> t = seconds(180.0, 0.02);
  std::vector<double> speed(t.size()), speed_half(t.size()), pitot(t.size()), alpha(t.size()), alpha_half(t.size());
  std::vector<double> vane(t.size()), beta(t.size()), beta_half(t.size()), wind_north(t.size()), wind_east(t.size());
  std::vector<double> wind_half(t.size());
  double gust = 0.0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    gust += 0.02 * (-gust / 2.0) + 0.25 * std::sqrt(0.02) * noise();
    const double excitation =
        doublet(t[k], 24, 1.2) + doublet(t[k], 44, 0.8) + doublet(t[k], 66, 1.6) + doublet(t[k], 114, 1.0);
    const double start_up = std::exp(-t[k] / 4.0);
    speed[k] = 18.2 + 1.4 * std::sin(0.11 * t[k]) + gust - 0.9 * excitation;
    speed_half[k] = 0.32 + 2.6 * start_up;
    pitot[k] = t[k] > 131.0 && t[k] < 139.0 ? kNaN : speed[k] + 0.35 * noise();
    alpha[k] = 4.1 + 1.1 * std::cos(0.11 * t[k]) + 2.6 * excitation + 0.5 * gust;
    alpha_half[k] = 0.55 + 6.0 * start_up;
    vane[k] = alpha[k] + 0.4 * noise();
    beta[k] = 0.8 * std::sin(0.4 * t[k]) + 0.7 * gust;
    beta_half[k] = 0.9 + 7.0 * start_up;
    wind_north[k] = 3.2 + 0.4 * std::sin(0.02 * t[k]);
    wind_east[k] = -1.6 + 0.5 * std::cos(0.017 * t[k]);
    wind_half[k] = 0.28 + 3.0 * start_up;
  }
  return {.title = "Reconstructed flight state",
          .caption =
              "RTS smoother with its 95 % band. The filter learns the wind in the first turn; until then the bands are "
              "wide.",
          .samples = t,
          .panels = {{.label = "airspeed",
                      .unit = "m/s",
                      .lines = {{.name = "pitot", .y = pitot, .role = Role::kMeasured},
                                {.name = "smoother", .y = speed, .band = band_of(speed, speed_half)}}},
                     {.label = "angle of attack",
                      .unit = "deg",
                      .lines = {{.name = "vane", .y = vane, .role = Role::kMeasured},
                                {.name = "smoother", .y = alpha, .band = band_of(alpha, alpha_half)}}},
                     {.label = "sideslip",
                      .unit = "deg",
                      .lines = {{.name = "smoother", .y = beta, .band = band_of(beta, beta_half)}}},
                     {.label = "wind",
                      .unit = "m/s",
                      .lines = {{.name = "north", .y = wind_north, .band = band_of(wind_north, wind_half)},
                                {.name = "east", .y = wind_east, .band = band_of(wind_east, wind_half)}}}},
          .spans = segments()};
}

TimeSeries inputs() {
  const std::vector<double> t = seconds(180.0, 0.04);
  Line elevator{.name = "elevator"};
  Line aileron{.name = "aileron"};
  Line throttle{.name = "throttle"};
  for (const double at : t) {
    elevator.y.push_back(
        -1.2 - 5.0 * (doublet(at, 24, 1.2) + doublet(at, 44, 0.8) + doublet(at, 66, 1.6) + doublet(at, 114, 1.0)));
    aileron.y.push_back(0.4 * std::sin(0.3 * at) + 6.0 * (doublet(at, 80, 0.9) + doublet(at, 128, 0.9)));
    throttle.y.push_back(0.52 + 0.08 * std::sin(0.05 * at));
  }
  return {.title = "Control inputs",
          .samples = t,
          .panels = {{.label = "deflection", .unit = "deg", .lines = {elevator, aileron}},
                     {.label = "throttle", .unit = "", .lines = {throttle}, .height = 90}},
          .spans = segments()};
}

TimeSeries coefficients() {
  Samples noise;
  const std::vector<double> t = seconds(180.0, 0.02);
  TimeSeries figure{.title = "Coefficients, measured and modelled",
                    .caption = "The model was fitted on the blue span only.",
                    .samples = t,
                    .spans = segments()};
  for (const char* name : {"CL", "CD", "Cm"}) {
    Line measured{.name = "measured", .role = Role::kMeasured};
    Line model{.name = "PCA-GTLS"};
    const double scale = name[1] == 'L' ? 1.0 : name[1] == 'D' ? 0.09 : 0.12;
    for (const double at : t) {
      const double value =
          scale * (0.6 + 0.1 * std::cos(0.11 * at) +
                   0.25 * (doublet(at, 24, 1.2) + doublet(at, 44, 0.8) + doublet(at, 66, 1.6) + doublet(at, 114, 1.0)));
      const bool used = (at >= 20.0 && at <= 96.0) || (at >= 108.0 && at <= 150.0);
      measured.y.push_back(used ? value + 0.025 * scale * noise() : kNaN);
      model.y.push_back(used ? value : kNaN);
    }
    figure.panels.push_back({.label = name, .lines = {measured, model}, .height = 130});
  }
  return figure;
}

TimeSeries whole_log() {
  Samples noise;
  const std::vector<double> t = seconds(3600.0, 0.02);
  Line altitude{.name = "altitude", .band = Band{}};
  Line vibration{.name = "vibration", .role = Role::kMeasured};
  for (const double at : t) {
    altitude.y.push_back(120.0 + 80.0 * std::sin(2.0 * pi * at / 1800.0) + 0.3 * noise());
    altitude.band->low.push_back(altitude.y.back() - 3.0);
    altitude.band->high.push_back(altitude.y.back() + 3.0);
    vibration.y.push_back(0.4 * noise() + (std::abs(at - 2000.0) < 0.01 ? 9.0 : 0.0));
  }
  return {.title = "The whole log",
          .caption = "An hour at 50 Hz; the spike at 2000 s is a single sample.",
          .x = {.label = "time since power-up", .unit = "s"},
          .samples = t,
          .panels = {{.label = "altitude", .unit = "m", .lines = {altitude}, .height = 110},
                     {.label = "vertical acceleration", .unit = "m/s²", .lines = {vibration}, .height = 110}},
          .axis = "log"};
}

Table parameter_table() {
  Table table{.title = "Parameters by PCA-GTLS",
              .caption = "Sigma and interval include the noise in the regressors and its correlation in time.",
              .columns = {{.name = "parameter"},
                          {.name = "value"},
                          {.name = "sigma"},
                          {.name = "95 % low"},
                          {.name = "95 % high"},
                          {.name = "unit"},
                          {.name = "t", .digits = 3},
                          {.name = "status"}}};
  Samples noise;
  for (const Parameter& each : kParameters) {
    const double value = each.truth + each.sigma * 0.7 * noise();
    table.rows.push_back(
        {.cells = {text_cell(each.name), measured_cell(value, each.sigma), measured_cell(each.sigma, each.sigma),
                   measured_cell(value - 1.96 * each.sigma, each.sigma),
                   measured_cell(value + 1.96 * each.sigma, each.sigma), text_cell(each.unit),
                   number_cell(std::abs(value) / each.sigma), status_cell(each.status)},
         .status = each.status});
  }
  table.rows.push_back({.cells = {text_cell("Cl_r"), measured_cell(0.412, 0.031), measured_cell(0.031, 0.031),
                                  measured_cell(0.351, 0.031), measured_cell(0.473, 0.031), text_cell(""),
                                  number_cell(13.3), status_cell(Status::kRejected)},
                        .status = Status::kRejected});
  table.rows.push_back({.cells = {text_cell("Oswald e"), number_cell(0.82, 2), text_cell("–"), text_cell("–"),
                                  text_cell("–"), text_cell(""), text_cell("–"), status_cell(Status::kFixed)},
                        .status = Status::kFixed});
  return table;
}

Table method_table() {
  Table table{.title = "Methods side by side",
              .caption = "OLS is biased towards zero where the regressors are noisy (Cm_q); the others allow for that.",
              .columns = {{.name = "parameter"}}};
  for (const char* method : kMethods) {
    table.columns.push_back({.name = "value", .group = method});
    table.columns.push_back({.name = "sigma", .group = method});
  }
  Samples noise;
  for (const Parameter& each : kParameters) {
    Row row{.cells = {text_cell(each.name)}};
    for (std::size_t k = 0; k < kMethods.size(); ++k) {
      row.cells.push_back(measured_cell(each.truth * (k == 0 ? 0.93 : 1.0) + 0.6 * each.sigma * noise(), each.sigma));
      row.cells.push_back(measured_cell(each.sigma, each.sigma));
    }
    table.rows.push_back(row);
  }
  return table;
}

IntervalPlot interval_plot() {
  IntervalPlot plot{.title = "Estimates with 95 % intervals",
                    .caption = "Each row has its own scale. Hollow: not to be used.",
                    .methods = {kMethods.begin(), kMethods.end()},
                    .reference_name = "truth"};
  Samples noise;
  for (const Parameter& each : kParameters) {
    if (!std::isfinite(each.truth)) continue;
    IntervalRow row{.name = each.name, .unit = each.unit, .reference = each.truth};
    for (std::size_t k = 0; k < kMethods.size(); ++k) {
      const double value = each.truth * (k == 0 ? 0.95 : 1.0) + 0.8 * each.sigma * noise();
      const double half = 1.96 * each.sigma * (k == 0 ? 0.5 : k == 1 && each.name[1] == 'D' ? 12.0 : 1.0);
      row.estimates.push_back(
          {value, value - half, value + half, k == 1 && each.name[1] == 'D' ? Status::kRejected : each.status});
    }
    plot.rows.push_back(row);
  }
  return plot;
}

XYPlot normal_plot(const char* name, unsigned skip) {
  Samples noise;
  for (unsigned k = 0; k < skip; ++k) static_cast<void>(noise());
  std::vector<double> residuals(400);
  for (double& each : residuals) each = noise() * (skip > 10 && std::abs(noise()) > 2.0 ? 2.2 : 1.0);
  std::sort(residuals.begin(), residuals.end());
  std::vector<double> quantiles;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    // Inverse of the logistic distribution, scaled: close to the normal one and enough for a picture.
    const double p = (static_cast<double>(k) + 0.5) / 400.0;
    quantiles.push_back(0.59 * std::log(p / (1.0 - p)));
  }
  return {.title = std::string("Normal plot, ") + name,
          .caption = "Points on the line: normal residuals.",
          .x = {.label = "standard normal quantile"},
          .y = {.label = "residual / sigma"},
          .series = {
              {.name = "normal", .x = {-3.5, 3.5}, .y = {-3.5, 3.5}, .role = Role::kReference, .style = Style::kLine},
              {.name = "residuals", .x = quantiles, .y = residuals}}};
}

XYPlot autocorrelation() {
  Samples noise;
  XYSeries series{.name = "CL residual", .style = Style::kStems};
  for (int lag = 0; lag <= 40; ++lag) {
    series.x.push_back(lag * 0.02);
    series.y.push_back(lag == 0 ? 1.0 : 0.55 * std::exp(-lag / 6.0) + 0.03 * noise());
  }
  return {.title = "Residual autocorrelation",
          .caption = "White residuals stay between the dashed lines at 95 % of the lags.",
          .x = {.label = "lag", .unit = "s"},
          .y = {.label = "autocorrelation"},
          .series = {series},
          .guides = {{.value = 0.07, .label = "+95 %"}, {.value = -0.07}}};
}

XYPlot fit_plot() {
  Samples noise;
  XYSeries points{.name = "hold-out samples"};
  for (int k = 0; k < 20000; ++k) {
    const double model = 0.6 + 0.2 * noise();
    points.x.push_back(model);
    points.y.push_back(model + 0.025 * noise());
  }
  return {.title = "CL, model against measured",
          .x = {.label = "CL modelled"},
          .y = {.label = "CL measured"},
          .series =
              {points,
               {.name = "equal", .x = {-0.3, 1.5}, .y = {-0.3, 1.5}, .role = Role::kReference, .style = Style::kLine}},
          .equal_axes = true};
}

/// A ground track of 60 m by 20 m, drawn to scale.
XYPlot ground_track() {
  return {.title = "Ground track of a turn",
          .x = {.label = "east", .unit = "m"},
          .y = {.label = "north", .unit = "m"},
          .series = {{.name = "runway",
                      .x = {0.0, 60.0, 60.0, 0.0, 0.0},
                      .y = {0.0, 0.0, 20.0, 20.0, 0.0},
                      .role = Role::kMeasured,
                      .style = Style::kLine,
                      .width = 6.0,
                      .opacity = 0.5},
                     {.name = "touch-down", .x = {20.0}, .y = {10.0}, .width = 12.0}},
          .equal_scale = true,
          .height = 320};
}

Matrix correlation() {
  Matrix matrix{.title = "Correlation of the estimates",
                .caption = "Above 0.9 in size, two parameters are hardly distinguishable."};
  Samples noise;
  constexpr std::size_t kCount = 10;
  for (std::size_t i = 0; i < kCount; ++i) {
    matrix.row_names.emplace_back(kParameters[i].name);
    matrix.values.emplace_back(kCount, 1.0);
  }
  matrix.column_names = matrix.row_names;
  for (std::size_t i = 0; i < kCount; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      matrix.values[i][j] = matrix.values[j][i] = std::clamp(0.5 * noise(), -0.97, 0.97);
    }
  }
  return matrix;
}

Table validation() {
  return {.title = "Validation on the hold-out",
          .caption = "Theil's inequality coefficient: 0 is perfect, below 0.3 is usually taken as good.",
          .columns = {{.name = "quantity"},
                      {.name = "MAE"},
                      {.name = "RMSE"},
                      {.name = "R²", .digits = 3},
                      {.name = "Theil", .digits = 3},
                      {.name = "verdict"}},
          .rows = {{.cells = {text_cell("CL"), number_cell(0.0181), number_cell(0.0247), number_cell(0.974),
                              number_cell(0.021), status_cell(Status::kGood)}},
                   {.cells = {text_cell("CD"), number_cell(0.00163), number_cell(0.00231), number_cell(0.912),
                              number_cell(0.038), status_cell(Status::kGood)}},
                   {.cells = {text_cell("Cm"), number_cell(0.0029), number_cell(0.0041), number_cell(0.871),
                              number_cell(0.18), status_cell(Status::kCaution)}},
                   {.cells = {text_cell("Cn"), number_cell(3.1e-5), number_cell(4.4e-5), number_cell(-0.31),
                              number_cell(0.74), status_cell(Status::kBad)},
                    .status = Status::kBad}}};
}

/// A box on a pole that turns and rises over the time of the flight.
Scene scene() {
  Scene figure{.title = "A box on a pole",
               .caption = "Drag to turn the view.",
               .joints = {{.name = "height", .unit = "m", .direction = {0.0, 0.0, 1.0}},
                          {.name = "roll", .unit = "deg", .turns = true, .scale = kDegree}},
               .choice = "variant"};
  using Kind = SceneShape::Kind;
  const auto square = [](double half, double z, bool moves) -> std::vector<ScenePoint> {
    return {{-half, -half, z, moves}, {half, -half, z, moves}, {half, half, z, moves}, {-half, half, z, moves}};
  };
  figure.shapes = {{.kind = Kind::kFace, .tone = SceneTone::kGround, .points = square(1.0, 0.0, false)},
                   {.kind = Kind::kActuator,
                    .tone = SceneTone::kLink,
                    .points = {{0.0, 0.0, 0.0, false}, {0.0, 0.0, 1.0, true}},
                    .size = 0.5},
                   {.kind = Kind::kFace, .tone = SceneTone::kBody, .points = square(0.5, 1.0, true)},
                   {.kind = Kind::kBall, .tone = SceneTone::kPerson, .points = {{0.0, 0.0, 1.2, true}}, .size = 0.1},
                   {.kind = Kind::kLabel, .points = {{1.2, 0.0, 0.0, false}}, .text = kHostileText}};
  figure.motions = {{.name = "slow", .values = {{}, {}}}, {.name = "fast", .values = {{}, {}}}};
  for (int k = 0; k <= 90; ++k) {
    figure.samples.push_back(2.0 * k - (k == 90 ? 0.02 : 0.0));
    for (std::size_t m = 0; m < 2; ++m) {
      figure.motions[m].values[0].push_back(0.2 * std::sin(0.1 * k));
      figure.motions[m].values[1].push_back(20.0 * std::sin((m == 0 ? 0.05 : 0.3) * k));
    }
  }
  return figure;
}

}  // namespace

Document sample_document() {
  return {
      .title = "Sample aircraft, flight 12",
      .subtitle = "Aerodynamic model from a recorded flight, 3 min at 50 Hz",
      .verdict =
          {.level = Level::kCaution,
           .headline = "The pitch model is good to fly with; the yaw model is not.",
           .lines =
               {"10 of 14 coefficients are identified: lift, drag and pitching moment, each from its own doublets.",
                "One is rejected and one was not excited: there was no rudder manoeuvre in this flight.",
                "On the part of the flight that the fit never saw, lift is predicted within 3 %."}},
      .facts = {{.name = "Log", .value = "flight_12.bin"},
                {.name = "Span", .value = "0 – 180 s"},
                {.name = "Aircraft", .value = "2.1 m flying wing, 3.36 kg"},
                {.name = "Sensors", .value = "IMU, GNSS, pitot, alpha vane"},
                {.name = "Identification", .value = "20 – 96 s, 3 800 samples"},
                {.name = "Hold-out", .value = "108 – 150 s, 2 100 samples"}},
      .sections = {
          {.title = "What was flown", .blocks = {states(), inputs()}},
          {.title = "The model",
           .blocks = {Paragraph{.text = "A parameter is identified when its interval excludes zero, the flight excited "
                                        "its direction, and the "
                                        "hold-out confirms it."},
                      parameter_table(), interval_plot(), method_table()}},
          {.title = "Does it predict?", .blocks = {validation(), coefficients(), fit_plot(), normal_plot("Cm", 30)}},
          {.title = "Residuals", .blocks = {autocorrelation(), normal_plot("CL", 0), correlation(), ground_track()}},
          {.title = "Warnings",
           .blocks = {List{.items = {"The pitot was silent from 131 s to 139 s.",
                                     "Closed-loop flight from 96 s on: inputs are correlated with the state."},
                           .tone = Tone::kWarning},
                      Paragraph{.text = std::string("A text from a log: ") + kHostileText, .tone = Tone::kNote}}},
          {.title = "The whole log", .blocks = {whole_log()}},
          {.title = "In space", .blocks = {scene()}},
          {.title = "How it was done",
           .blocks = {FactList{.facts = {{.name = "Program", .value = "veridyn 0.1.0"},
                                         {.name = "Seed", .value = "1"},
                                         {.name = "Filter", .value = "EKF + RTS smoother"}}},
                      List{.items = {"Delays aligned by cross-correlation.",
                                     "Derivatives by a Savitzky-Golay filter of order 3."}}},
           .folded = true}}};
}

}  // namespace veridyn::report
