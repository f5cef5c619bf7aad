#include "veridyn/muscle/study/motion_table.hpp"

#include <fmt/format.h>

namespace veridyn::muscle {
namespace internal {

std::vector<std::pair<std::string, Interpolation>> interpolations() {
  return {{"linear", Interpolation::kLinear}, {"hold", Interpolation::kHold}};
}

const KeyTable<ControlOptions>& control_keys() {
  using O = ControlOptions;
  static const auto table =
      KeyTable<O>("motion.control", "Computed muscle control.")
          .number("window", &O::window, "s", kPositive, "controls are held over windows of this length")
          .number("kp", &O::kp, "1/s^2", kNotNegative, "gain on the error of position")
          .number("kv", &O::kv, "1/s", kNotNegative, "gain on the error of speed")
          .number("min_control", &O::min_control, "1", kBelowOne, "least excitation, in addition to the muscles' own")
          .number("max_control", &O::max_control, "1", share_up_to(1.0), "greatest excitation, above `min_control`")
          .check([](const StudyTable& t, O& o) {
            if (!(o.max_control > o.min_control))
              t.fail("max_control",
                     fmt::format("= {:g} must be above min_control = {:g}", o.max_control, o.min_control));
          });
  return table;
}

const KeyTable<Ramp>& ramp_keys() {
  static const auto table = KeyTable<Ramp>("motion.ramp", "A coordinate that goes from one value to another.")
                                .repeated()
                                .elsewhere({"coordinate", "", "", "", "what moves"})
                                .required()
                                .elsewhere({"from", "rad or m", "", "", "where it begins"})
                                .otherwise("the end of the ramp before, or the start")
                                .elsewhere({"to", "rad or m", "", "", "where it ends"})
                                .required()
                                .number("start", &Ramp::start, "s", kAnyNumber, "when it begins")
                                .otherwise("the end of the ramp before, or `begin`")
                                .number("duration", &Ramp::duration, "s", kPositive, "how long it takes")
                                .required()
                                .choice("shape", &Ramp::shape,
                                        {{"minimum jerk", RampShape::kMinimumJerk},
                                         {"half sine", RampShape::kHalfSine},
                                         {"linear", RampShape::kLinear}},
                                        "of the way between");
  return table;
}

}  // namespace internal

namespace {

const KeyTable<StaticOptimizationOptions>& static_optimization_keys() {
  using O = StaticOptimizationOptions;
  static const auto table = KeyTable<O>("motion.static_optimization")
                                .number("exponent", &O::exponent, "1", {.low = 1.0, .high = 100.0, .with_low = false},
                                        "of the activations in the sum that is minimised")
                                .choice("formulation", &O::force,
                                        {{"with passive", StaticForce::kWithPassive},
                                         {"as opensim", StaticForce::kAsOpenSim},
                                         {"without physiology", StaticForce::kIsometric}},
                                        "how a muscle's force follows from its activation");
  return table;
}

/// Keys that several methods have.
KeyTable<MotionTable> shared_keys() {
  using O = MotionTable;
  return KeyTable<O>("motion", "What is computed, and of which motion.")
      .choice("method", &O::method, choices_of<MuscleMethod>(kMuscleMethodNames), "what is computed")
      .number("begin", &O::begin, "s", kAnyNumber, "where the motion begins")
      .otherwise("0, or the beginning of `file`")
      .number("duration", &O::duration, "s", share_up_to(3600.0), "how long it is")
      .otherwise("1 s, or the rest of `file`")
      .number("rate", &O::rate_Hz, "Hz", kPositive, "rows of the results; at most ten million of them")
      .number("accuracy", &O::accuracy, "1", internal::kAccuracies,
              "of the integration: error of a step in units of the states' sizes")
      .number("reserve_force", &O::reserve_force, "N m", kNotNegative,
              "of the actuator that helps each free coordinate, at control 1 (of a translation in N); 0: none")
      .elsewhere({"reserves", "N m or N", ">= 0", "", "a table: the same of single `COORDINATE`s"})
      .otherwise("`reserve_force`")
      .choice("joint_reactions", &O::reactions,
              {{"none", std::nullopt},
               {"child", ReactionFrame::kChild},
               {"parent", ReactionFrame::kParent},
               {"ground", ReactionFrame::kGround}},
              "what joints transmit, in the axes of which body")
      .choice("metabolic_cost", &O::metabolic,
              {{"none", std::nullopt},
               {"umberger", MetabolicModel::kUmberger2003},
               {"bhargava", MetabolicModel::kBhargava2004}},
              "energy that the muscles use, by whose equations")
      .elsewhere({"slow_twitch", "", "from 0 to 1", "0.5 of each", "a table: share of slow fibres by `MUSCLE`", true})
      .number("aerobic_factor", &O::aerobic_factor, "1", kAnyNumber, "Umberger's factor S; 1 for short efforts")
      .flag("induced_accelerations", &O::induced_accelerations, "what each force contributes to each acceleration")
      .check([](const StudyTable& t, O& o) {
        if (!t.has("file")) refuse_keys(t, {"low_pass"}, "is of the samples of `file`, and there is none");
        if (!t.has("excitation_file")) refuse_keys(t, {"interpolation"}, "is of `excitation_file`, and there is none");
        if (!o.metabolic) refuse_keys(t, {"aerobic_factor"}, "is of metabolic_cost, which is none");
      });
}

}  // namespace

const KeyTable<MotionTable>& MotionTable::keys() {
  using O = MotionTable;
  static const auto table =
      shared_keys()
          .elsewhere({"start", "rad or m", "", "the model's pose",
                      "a table: `COORDINATE`s at `begin`, and of those without a motion", true})
          .elsewhere({"start_speed", "rad/s or m/s", "", "the model's", "a table, forward: speeds at `begin`", true})
          .file("start_file", &O::start_file,
                "forward: pose, speeds, activations, fibre lengths at `begin`; what it does not hold stays as above")
          .elsewhere({"excitation", "", "from 0 to 1", "0.05 of each",
                      "a table, forward: constant excitations by `MUSCLE`, and `default`", true})
          .elsewhere({"excitation_step", "", "", "",
                      "tables `[[motion.excitation_step]]`, forward: `time`, from which on excitations are these "
                      "(`default`, by `MUSCLE`); others stay"})
          .file("excitation_file", &O::excitation_file,
                "forward: columns by muscle, and `COORDINATE_reserve` in units of `reserve_force`")
          .choice("interpolation", &O::interpolation, internal::interpolations(),
                  "between samples of `excitation_file`; `hold`: each until the next")
          .file("file", &O::file, "the desired motion: `.mot`, `.sto` or `.csv`")
          .number("low_pass", &O::low_pass_Hz, "Hz", kPositive, "cut-off of its samples, without delay")
          .otherwise("none")
          .file("external_loads", &O::external_loads, "OpenSim's `ExternalLoads`: forces of the surroundings")
          .file("external_loads_data", &O::external_loads_data, "another file for its columns")
          .otherwise("the data file that it names")
          .number("external_low_pass", &O::external_low_pass_Hz, "Hz", kPositive,
                  "pass band of a low-pass on all external loads, without delay, 60 dB at 1.5 times it")
          .otherwise("none")
          .table("control", &O::control, internal::control_keys())
          .table("static_optimization", &O::static_optimization, static_optimization_keys());
  return table;
}

}  // namespace veridyn::muscle
