#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "veridyn/muscle/actuator/musculotendon.hpp"
#include "veridyn/muscle/model/muscle_parameters.hpp"

namespace veridyn::muscle {

struct Model;

/// Parameters of all muscles of a model, in its order.
[[nodiscard]] std::vector<MuscleParameters> muscle_parameters(const Model& model);

/// View of the inputs of all muscles, in the model's order: valid while the arrays that it names are. Entries that a
/// muscle does not use are not read.
template <typename Scalar>
struct MuscleInputs {
  std::span<const Scalar> excitation;
  std::span<const Scalar> activation;
  std::span<const Scalar> fiber_length;  ///< [m]
  std::span<const Scalar> path_length;   ///< [m]
  std::span<const Scalar> path_speed;    ///< [m/s]; rigid tendons only
};

/// View of the arrays that `MuscleGroup::rates` writes to, in the model's order.
template <typename Scalar>
struct MuscleOutputs {
  std::span<Scalar> activation_rate;  ///< [1/s]
  std::span<Scalar> fiber_velocity;   ///< [m/s]
  std::span<Scalar> tendon_force;     ///< [N]
};

/// All muscles of a model, kept by kind of curve so that evaluation runs through plain arrays: no virtual calls, no
/// allocation, no exceptions. Outputs in the model's order. Copies share the tables of Millard's curves, and so do
/// muscles with equal curves.
template <typename Scalar>
class MuscleGroup {
 public:
  MuscleGroup() = default;
  /// @throws InputError naming muscle and element when a parameter is wrong.
  explicit MuscleGroup(std::span<const MuscleParameters> muscles);

  [[nodiscard]] std::size_t size() const { return settings_.size(); }
  [[nodiscard]] const MuscleParameters& settings(std::size_t muscle) const { return settings_[muscle]; }
  [[nodiscard]] bool has_fiber_state(std::size_t muscle) const { return !settings_[muscle].rigid_tendon; }
  [[nodiscard]] bool has_activation_state(std::size_t muscle) const {
    return !settings_[muscle].ignore_activation_dynamics;
  }

  /// The same muscles with other parameters, possibly of another scalar; curves are shared. Not checked: an estimator
  /// keeps its parameters positive.
  template <typename Other>
  [[nodiscard]] MuscleGroup<Other> with(std::span<const MusculotendonParameters<Other>> parameters) const;
  /// The same in place.
  void set_parameters(std::span<const MusculotendonParameters<Scalar>> parameters);

  /// Derivatives of the muscles' states, and their forces.
  void rates(const MuscleInputs<Scalar>& in, const MuscleOutputs<Scalar>& out) const;

  /// Forces only.
  void tendon_forces(const MuscleInputs<Scalar>& in, std::span<Scalar> force) const;

  /// Fibre lengths at rest, by `musculotendon_equilibrium`; `end` (when not empty) says how each ended.
  void equilibrium(std::span<const Scalar> activation, std::span<const Scalar> path_length,
                   std::span<Scalar> fiber_length, std::span<EquilibriumEnd> end = {}) const;

  /// Two functions a muscle whose zeros are events: lM - its least length, lT - LS (rigid: lMT - LS for both) [m].
  void events(const MuscleInputs<Scalar>& in, std::span<Scalar> value) const;

  /// Forces as if tendons were rigid, at activation a for all muscles: what static optimisation and CMC scale by.
  void rigid_forces(double a, std::span<const double> path_length, std::span<const double> path_speed,
                    std::span<RigidTendonForces> forces) const requires std::same_as<Scalar, double> {
    // clang 14 compiles constrained members of explicit instantiations too.
    if constexpr (std::same_as<Scalar, double>) {
      for_each([&](const auto& m) {
        forces[m.muscle] = rigid_tendon_forces(m.curves, m.constants, a, path_length[m.muscle], path_speed[m.muscle]);
      });
    }
  }

  /// The same with an activation for each muscle, with derivatives if the scalar carries them.
  void rigid_parts(std::span<const Scalar> activation, std::span<const Scalar> path_length,
                   std::span<const Scalar> path_speed, std::span<RigidTendonParts<Scalar>> parts) const;

  /// One muscle's forces at activation a, as if its tendon were rigid.
  [[nodiscard]] RigidTendonForces rigid_forces(std::size_t muscle, double a, double lMT,
                                               double vMT) const requires std::same_as<Scalar, double> {
    if constexpr (std::same_as<Scalar, double>) {
      return with_member(muscle,
                         [&](const auto& m) { return rigid_tendon_forces(m.curves, m.constants, a, lMT, vMT); });
    }
    return {};
  }
  /// One muscle's forces, lengths and energies.
  [[nodiscard]] MuscleDetails details(std::size_t muscle, double u, double a, double lM, double lMT,
                                      double vMT) const requires std::same_as<Scalar, double> {
    if constexpr (std::same_as<Scalar, double>) {
      return with_member(
          muscle, [&](const auto& m) { return musculotendon_details(m.curves, m.constants, u, a, lM, lMT, vMT); });
    }
    return {};
  }
  /// [N]
  [[nodiscard]] double max_isometric_force(std::size_t muscle) const;

  /// @throws InputError naming the muscle when an excitation is NaN or infinite.
  void check_excitations(std::span<const double> excitation) const;

 private:
  template <typename>
  friend class MuscleGroup;

  template <typename Curves>
  struct Member {
    Curves curves;
    MusculotendonConstants<Scalar> constants;
    std::size_t muscle;
  };

  template <typename Function>
  void for_each(const Function& function) const {
    std::apply([&](const auto&... list) { (for_list(list, function), ...); }, members_);
  }
  template <typename List, typename Function>
  static void for_list(const List& list, const Function& function) {
    for (const auto& member : list) function(member);
  }
  template <typename M>
  static void member_rates(const M& m, const MuscleInputs<Scalar>& in, const MuscleOutputs<Scalar>& out) {
    const std::size_t i = m.muscle;
    const MuscleRates<Scalar> r =
        musculotendon_rates(m.curves, m.constants, in.excitation[i], in.activation[i], in.fiber_length[i],
                            in.path_length[i], m.constants.rigid_tendon ? in.path_speed[i] : Scalar(0.0));
    out.activation_rate[i] = r.activation_rate;
    out.fiber_velocity[i] = r.fiber_velocity;
    out.tendon_force[i] = r.tendon_force;
  }
  template <typename M>
  static void list_rates(const std::vector<M>& list, const MuscleInputs<Scalar>& in, const MuscleOutputs<Scalar>& out) {
    if constexpr (std::is_same_v<M, Member<Millard2012>> && std::is_same_v<Scalar, double>)
      damped_rates(list, in, out);
    else
      for (const M& m : list) member_rates(m, in, out);
  }
  /// The velocity of a damped muscle is a long chain of dependent operations. Eight muscles taken through it together
  /// use the processor better: about twice as fast as one after the other, with the same results.
  template <typename M>
  static void damped_rates(const std::vector<M>& list, const MuscleInputs<double>& in,
                           const MuscleOutputs<double>& out);

  template <typename Function>
  auto with_member(std::size_t muscle, const Function& function) const;

  std::vector<MuscleParameters> settings_;
  std::vector<std::pair<std::size_t, std::size_t>> place_;  ///< of each muscle: kind, position in its list
  std::tuple<std::vector<Member<Thelen2003>>, std::vector<Member<Thelen2003Deprecated>>,
             std::vector<Member<Millard2012>>, std::vector<Member<DeGrooteFregly2016>>,
             std::vector<Member<Schutte1993>>>
      members_;
};

/// Curves of each muscle, tables shared by those whose shape parameters are equal. @throws InputError as `check`.
[[nodiscard]] std::vector<CompiledCurves> compile_curves(std::span<const MuscleParameters> muscles);
/// @throws InputError naming the muscle when an excitation is NaN or infinite.
void check_excitations(std::span<const MuscleParameters> muscles, std::span<const double> excitation);

// Definitions

template <typename Scalar>
MuscleGroup<Scalar>::MuscleGroup(std::span<const MuscleParameters> muscles)
    : settings_(muscles.begin(), muscles.end()) {
  const std::vector<CompiledCurves> curves = compile_curves(muscles);
  for (std::size_t i = 0; i < muscles.size(); ++i)
    std::visit(
        [&]<typename Curves>(const Curves& c) {
          auto& list = std::get<std::vector<Member<Curves>>>(members_);
          place_.emplace_back(curves[i].index(), list.size());
          list.push_back(
              {c, {muscles[i].musculotendon.template cast<Scalar>(), muscles[i], minimum_norm_length(c)}, i});
        },
        curves[i]);
}

template <typename Scalar>
void MuscleGroup<Scalar>::rates(const MuscleInputs<Scalar>& in, const MuscleOutputs<Scalar>& out) const {
  std::apply([&](const auto&... list) { (list_rates(list, in, out), ...); }, members_);
}

template <typename Scalar>
void MuscleGroup<Scalar>::tendon_forces(const MuscleInputs<Scalar>& in, std::span<Scalar> force) const {
  for_each([&](const auto& m) {
    const std::size_t i = m.muscle;
    force[i] = tendon_force(m.curves, m.constants, in.excitation[i], in.activation[i], in.fiber_length[i],
                            in.path_length[i], m.constants.rigid_tendon ? in.path_speed[i] : Scalar(0.0));
  });
}

template <typename Scalar>
void MuscleGroup<Scalar>::equilibrium(std::span<const Scalar> activation, std::span<const Scalar> path_length,
                                      std::span<Scalar> fiber_length, std::span<EquilibriumEnd> end) const {
  for_each([&](const auto& m) {
    const std::size_t i = m.muscle;
    const auto found = musculotendon_equilibrium(m.curves, m.constants, activation[i], path_length[i]);
    fiber_length[i] = found.fiber_length;
    if (!end.empty()) end[i] = found.end;
  });
}

template <typename Scalar>
void MuscleGroup<Scalar>::events(const MuscleInputs<Scalar>& in, std::span<Scalar> value) const {
  for_each([&](const auto& m) {
    const std::size_t i = m.muscle;
    const auto& k = m.constants;
    value[2 * i] = value[2 * i + 1] = in.path_length[i] - k.LS;
    if (k.rigid_tendon) return;
    const Scalar& lM = in.fiber_length[i];
    value[2 * i] = lM - k.minimum_length;
    value[2 * i + 1] =
        value[2 * i + 1] - internal::Pennation<Scalar>(k, lM > k.minimum_length ? lM : k.minimum_length).along;
  });
}

template <typename Scalar>
void MuscleGroup<Scalar>::rigid_parts(std::span<const Scalar> activation, std::span<const Scalar> path_length,
                                      std::span<const Scalar> path_speed,
                                      std::span<RigidTendonParts<Scalar>> parts) const {
  for_each([&](const auto& m) {
    const std::size_t i = m.muscle;
    parts[i] = rigid_tendon_parts(m.curves, m.constants, activation[i], path_length[i], path_speed[i]);
  });
}

template <typename Scalar>
double MuscleGroup<Scalar>::max_isometric_force(std::size_t muscle) const {
  return with_member(muscle, [](const auto& m) { return value_of(m.constants.F0); });
}

template <typename Scalar>
template <typename Other>
MuscleGroup<Other> MuscleGroup<Scalar>::with(std::span<const MusculotendonParameters<Other>> parameters) const {
  MuscleGroup<Other> group;
  group.settings_ = settings_;
  group.place_ = place_;
  for_each([&]<typename M>(const M& m) {
    using Curves = std::remove_cvref_t<decltype(m.curves)>;
    using OtherMember = typename MuscleGroup<Other>::template Member<Curves>;
    std::get<std::vector<OtherMember>>(group.members_)
        .push_back({m.curves, {parameters[m.muscle], settings_[m.muscle], minimum_norm_length(m.curves)}, m.muscle});
  });
  return group;
}

template <typename Scalar>
void MuscleGroup<Scalar>::set_parameters(std::span<const MusculotendonParameters<Scalar>> parameters) {
  std::apply(
      [&](auto&... list) {
        const auto update = [&](auto& members) {
          for (auto& m : members)
            m.constants = {parameters[m.muscle], settings_[m.muscle], minimum_norm_length(m.curves)};
        };
        (update(list), ...);
      },
      members_);
}

template <typename Scalar>
template <typename M>
void MuscleGroup<Scalar>::damped_rates(const std::vector<M>& list, const MuscleInputs<double>& in,
                                       const MuscleOutputs<double>& out) {
  constexpr std::size_t kLanes = 8;
  std::array<DampedVelocity, kLanes> lane;
  for (std::size_t from = 0; from < list.size(); from += kLanes) {
    const std::size_t count = std::min(kLanes, list.size() - from);
    const M* const members = list.data() + from;
    for (std::size_t j = 0; j < count; ++j) {
      const M& m = members[j];
      const auto& k = m.constants;
      if (k.rigid_tendon || !m.curves.damped()) {
        lane[j] = {1.0, 1.0, 1.0, 0.0, 0.0, 0.0, true};
        continue;
      }
      const std::size_t i = m.muscle;
      const double held = std::max(in.fiber_length[i], k.minimum_length), l = held * k.inverse_L0;
      const internal::Pennation<double> p(k, held);
      const double fT = m.curves.tendon_force(k.tendon_stretch(in.path_length[i] - p.along));
      out.tendon_force[i] = k.F0 * fT;
      lane[j] =
          m.curves.damped_balance(acting_activation(k, in.excitation[i], in.activation[i]) * m.curves.active_length(l),
                                  fT * p.inverse_cosine - m.curves.passive_force(l), k.damping);
    }
    for (int round = 0; round < 2; ++round)
      for (std::size_t j = 0; j < count; ++j)
        if (!lane[j].done) lane[j].iterate(members[j].curves.quick_velocity_curve());
    for (std::size_t j = 0; j < count; ++j) {
      const M& m = members[j];
      const auto& k = m.constants;
      if (k.rigid_tendon || !m.curves.damped()) {
        member_rates(m, in, out);
        continue;
      }
      const std::size_t i = m.muscle;
      lane[j].finish(m.curves.quick_velocity_curve());
      const double v = lane[j].v;
      const double a = acting_activation(k, in.excitation[i], in.activation[i]);
      const bool held = in.fiber_length[i] <= k.minimum_length && v < 0.0;
      out.fiber_velocity[i] = held ? 0.0 : v * k.Vmax * k.L0;
      out.activation_rate[i] =
          k.ignore_activation_dynamics
              ? 0.0
              : m.curves.activation_rate(in.excitation[i], a, k.activation_time, k.deactivation_time);
    }
  }
}

template <typename Scalar>
template <typename Function>
auto MuscleGroup<Scalar>::with_member(std::size_t muscle, const Function& function) const {
  const auto [kind, position] = place_[muscle];
  switch (kind) {
    case 0:
      return function(std::get<0>(members_)[position]);
    case 1:
      return function(std::get<1>(members_)[position]);
    case 2:
      return function(std::get<2>(members_)[position]);
    case 3:
      return function(std::get<3>(members_)[position]);
    default:
      return function(std::get<4>(members_)[position]);
  }
}

template <typename Scalar>
void MuscleGroup<Scalar>::check_excitations(std::span<const double> excitation) const {
  muscle::check_excitations(settings_, excitation);
}

extern template class MuscleGroup<double>;

}  // namespace veridyn::muscle
