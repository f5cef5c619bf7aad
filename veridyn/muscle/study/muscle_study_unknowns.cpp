#include "veridyn/muscle/study/muscle_study_unknowns.hpp"

#include <fmt/format.h>

#include <string>

#include "veridyn/core/study_keys.hpp"

namespace veridyn::muscle {
namespace {

bool in_percent(const StudyTable& table, std::string_view key) {
  return table.is_text(key) && table.text(key).find('%') != std::string::npos;
}

Extent extent(const StudyTable& table, std::string_view key, std::string_view unit) {
  if (in_percent(table, key)) return {100.0 * table.number(key, "1"), true};
  return {table.number(key, unit), false};
}

MuscleUnknown read_unknown(const StudyTable& table, const Model& model) {
  MuscleUnknownSpec spec = parameter_keys().read(table);
  // Names first, and the unit that the numbers below are in.
  std::string unit = "1";
  if (!spec.factor) {
    for (std::size_t f = 0; f < MuscleParameterName::kCount && !spec.fields.empty(); ++f) {
      if (spec.fields.front() == parameter_field(f).name) unit = parameter_field(f).unit;
    }
  }
  std::string place = table.place("fields");
  if (table.has("start")) {
    spec.start = table.number("start", unit);
    place = table.place("start");
  }
  static_cast<void>(make_unknown(model, spec, place));
  if (table.has("bounds")) {
    place = table.place("bounds");
    for (const char* key : {"low", "high"}) {
      if (table.has(key)) table.fail(key, "and bounds are both given; one of them has to go");
    }
    const double percent = in_percent(table, "bounds") ? 100.0 * table.number("bounds", "1") : -1.0;
    if (!(percent > 0.0))
      table.fail("bounds", "must be a share of the start such as \"20 %\"; low and high take units");
    spec.low = Extent{-percent, true};
    spec.high = Extent{percent, true};
  }
  for (const char* key : {"low", "high"}) {
    if (!table.has(key)) continue;
    place = table.place(key);
    (std::string_view(key) == "low" ? spec.low : spec.high) = extent(table, key, unit);
  }
  static_cast<void>(make_unknown(model, spec, place));
  if (table.has("prior")) {
    place = table.place("prior");
    spec.prior = extent(table, "prior", unit);
  }
  return make_unknown(model, spec, place);
}

}  // namespace

const KeyTable<MuscleUnknownSpec>& parameter_keys() {
  using S = MuscleUnknownSpec;
  static const auto table =
      KeyTable<S>("parameter", "An unknown: one number that one or several parameters of muscles follow.")
          .repeated()
          .text("name", &S::name, "for messages and results")
          .otherwise("`MUSCLE.FIELD`")
          .texts("muscles", &S::muscles, "muscles it applies to; `[\"all\"]`: every one")
          .required()
          .texts("fields", &S::fields,
                 "of `[subject.parameters]`, or `tendon_strain_factor`, `excitation_gain`, `excitation_delay`")
          .required()
          .flag("factor", &S::factor, "it multiplies the model's values; else it is the value of all")
          .elsewhere({"start", "the field's", "", "the model's value, or 1", "where it begins", true})
          .elsewhere({"bounds", "%", "", "50 %", "below and above the start", true})
          .elsewhere(
              {"low", "% or the field's", "", "of `bounds`", "instead: in percent from the start, or a value", true})
          .elsewhere({"high", "% or the field's", "", "of `bounds`", "the same", true})
          .elsewhere({"prior", "% or the field's", "", "that of a value anywhere within the bounds",
                      "standard deviation of what is known before", true})
          .flag("fixed", &S::fixed, "it stays at its start");
  return table;
}

const KeyTable<MuscleOutput>& output_keys() {
  static const auto table =
      KeyTable<MuscleOutput>("output", "What is compared with the recordings.")
          .repeated()
          .elsewhere({"name", "", "", "",
                      "`COORDINATE`, `COORDINATE.speed`, `COORDINATE.moment` (of the muscles), `MUSCLE.fiber_length`, "
                      "`MUSCLE.tendon_force`"})
          .required()
          .elsewhere({"noise", "the output's", "> 0", "estimated", "standard deviation of its measurement", true});
  return table;
}

std::vector<MuscleUnknown> read_unknowns(const StudyTable& root, const Model& model) {
  std::vector<MuscleUnknown> unknowns;
  for (const StudyTable& table : root.tables("parameter")) {
    unknowns.push_back(read_unknown(table, model));
    check_unknowns(model, unknowns, table.place("fields"));
  }
  return unknowns;
}

std::vector<MuscleOutput> read_outputs(const StudyTable& root, const Model& model) {
  std::vector<MuscleOutput> outputs;
  for (const StudyTable& table : root.tables("output")) {
    static_cast<void>(output_keys().read(table));
    MuscleOutput output = parse_output(model, table.text("name"), table.place("name"));
    if (table.has("noise")) output.noise_sd = table.positive("noise", output_unit(model, output));
    for (const MuscleOutput& other : outputs) {
      if (other.kind == output.kind && other.index == output.index)
        table.fail("name", fmt::format("names '{}' a second time", output_name(model, output)));
    }
    outputs.push_back(output);
  }
  return outputs;
}

}  // namespace veridyn::muscle
