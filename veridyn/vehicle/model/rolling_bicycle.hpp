#pragma once

#include <Eigen/Core>
#include <array>

#include "veridyn/vehicle/model/bicycle_model.hpp"

namespace veridyn::vehicle {

/// How a body leans on its springs, as motion shows it: roll phi after the lateral acceleration a_y,
///
///     phi'' = frequency^2 (gradient a_y - phi) - 2 damping frequency phi'
///
/// With the mass m and the arm h of the centre of gravity above the roll axis that is a body of roll stiffness
/// K = m h/gradient (gravity's tilting moment taken off), roll inertia K/frequency^2 and roll damping
/// 2 damping K/frequency.
template <typename Scalar>
struct BodyRoll {
  Scalar gradient{0.0};   ///< steady roll per lateral acceleration [rad/(m/s^2)]
  Scalar frequency{9.0};  ///< undamped natural frequency [rad/s]
  Scalar damping{0.3};    ///< damping ratio [-]
  Scalar arm{0.0};        ///< h: centre of gravity above the roll axis, which the contact points move by [m]
};

/// What axles lose where springs and dampers move their load from one wheel to the other, n times as much as in steady
/// cornering at 1 g.
template <typename Scalar>
struct LoadTransfer {
  enum class Effect {
    kNone,
    /// Either wheel has the force of its own load, W (1 +- share n) of static loads W: a friction limit is reached
    /// sooner by the inner one than later by the outer one.
    kLoads,
    /// The force at the static loads, times 1 - loss n^2: the stiffness of a tyre grows less than its load.
    kLoss
  };
  Effect effect = Effect::kNone;
  Scalar share{0.0};    ///< of both axles
  Scalar loss{0.0};     ///< of both axles
  Scalar balance{0.0};  ///< by how much of that the front axle has more, and the rear one less: -1 to 1
};

/// What axles gain with their load: forces, and with them stiffness and friction limit, grow in front and behind by
///
///     1 + d_f u^2 - s a_x c/(g b),   1 + d_r u^2 + s a_x c/(g a)
///
/// of their static ones: the air presses the axles down, and braking and driving move load between them (c the height
/// of the centre of gravity, a_x = u' - r v). A tyre whose stiffness grows in proportion to its load has s = 1. What
/// the front axle has of the force along the vehicle m a_x, a share f, its steered wheels turn sideways: f m a_x
/// tan(delta).
template <typename Scalar>
struct AxleLoad {
  bool acts = false;
  Scalar downforce_f{0.0}, downforce_r{0.0};  ///< d [s^2/m^2]
  Scalar sensitivity{0.0};                    ///< s [-]
  Scalar front_force_share{0.0};              ///< f [-]

  /// No axle loses more than this.
  static constexpr double kLeastShareOfLoad = 0.05;
};

/// What of road and pedals moves the vehicle besides its steering.
template <typename Scalar>
struct DriveConditions {
  double speed_rate = 0.0;  ///< u' [m/s^2]
  bool banked = false;      ///< else `bank` is not looked at
  Scalar bank{0.0};         ///< of the road, left side up [rad]
};

/// Rates of a `RollingBicycle` at one moment.
template <typename Scalar, int kStates>
struct RollingBicycleRates {
  Eigen::Matrix<Scalar, kStates, 1> derivative;
  /// Of the tyres' forces [m/s^2]: v' + r u of the centre of gravity, and g sin(bank), which an accelerometer shows
  /// too.
  Scalar lateral_acceleration{0.0};
};

/// The bicycle model with as many states as one asks for, in this order (ISO 8855: roll is left side up):
///
/// - 2: lateral velocity v and yaw rate r of the centre of gravity, which is `BicycleModel`;
/// - 4: and roll phi and roll rate: the contact points move sideways by h phi' against the centre of gravity, so that
///   slip angles are delta - atan((v + h phi' + a r)/u) and -atan((v + h phi' - b r)/u), and the lateral force on the
///   arm h rolls the body (the linear form: Segel 1956, Proc. IMechE Automobile Division 10(1); here the wheels are
///   without mass of their own, as in the lateral motion of `FourWheelModel`);
/// - 6: and the slip angles of front and rear tyres, which follow after `relaxation_length` of travel.
///
/// Roll steer adds e phi to the slip angles of an axle (camber thrust as a share of the stiffness is the same); a trail
/// t of the tyres adds - t m a_y to the yaw moment, which is the aligning moment of all wheels.
///
/// On a banked road gravity pulls by g sin(bank) to its lower side; the body rolls against the road by the tyres'
/// forces alone.
template <typename Scalar, typename Tyre>
struct RollingBicycle {
  BicycleModel<Scalar, Tyre> bicycle;
  BodyRoll<Scalar> roll = {};
  Scalar relaxation_length{0.3};  ///< with six states; > 0 [m]
  LoadTransfer<Scalar> load_transfer = {};
  AxleLoad<Scalar> axle_load = {};
  std::array<Scalar, 2> roll_steer{};  ///< slip angle per roll, front and rear [rad/rad]
  Scalar trail{0.0};                   ///< of the side forces behind the middle of the tyres' contact [m]

  template <int kStates>
  [[nodiscard]] RollingBicycleRates<Scalar, kStates> rates(const Eigen::Matrix<Scalar, kStates, 1>& x,
                                                           const Scalar& steer, const Scalar& u,
                                                           const DriveConditions<Scalar>& conditions = {}) const {
    using std::sin;
    static_assert(kStates == 2 || kStates == 4 || kStates == 6);
    RollingBicycleRates<Scalar, kStates> out;
    std::array<Scalar, 2> slip = bicycle.slip_angles(contact_velocity(x), x(1), steer, u);
    if constexpr (kStates > 2)
      for (std::size_t axle = 0; axle < 2; ++axle) slip[axle] += roll_steer[axle] * x(2);
    if constexpr (kStates > 4) {
      const Scalar per_time = u / relaxation_length;
      out.derivative(4) = per_time * (slip[0] - x(4));
      out.derivative(5) = per_time * (slip[1] - x(5));
      slip = {x(4), x(5)};
    }
    const std::array<Scalar, 2> Fy =
        loaded(axle_forces<kStates>(slip, x), steer, u, conditions.speed_rate - x(0) * x(1));
    const BicycleRates<Scalar> plane = bicycle.rates_of_forces(slip, Fy, x(1), steer, u);
    out.lateral_acceleration = plane.lateral_acceleration;
    out.derivative(0) = plane.dv;
    if (conditions.banked) out.derivative(0) -= bicycle.gravity * sin(conditions.bank);
    const VehicleParameters<Scalar>& p = bicycle.parameters;
    out.derivative(1) = plane.dr - trail * p.mass * plane.lateral_acceleration / p.I_z;
    if constexpr (kStates > 2) {
      out.derivative(2) = x(3);
      out.derivative(3) = roll.frequency * (roll.frequency * (roll.gradient * plane.lateral_acceleration - x(2)) -
                                            2.0 * roll.damping * x(3));
    }
    return out;
  }

  /// Of one tyre, front and rear [N].
  template <int kStates>
  [[nodiscard]] std::array<Scalar, 2> axle_forces(const std::array<Scalar, 2>& slip,
                                                  const Eigen::Matrix<Scalar, kStates, 1>& x) const {
    if constexpr (kStates > 2) {
      const LoadTransfer<Scalar>& t = load_transfer;
      if (t.effect != LoadTransfer<Scalar>::Effect::kNone && roll.gradient > 0.0) {
        const Scalar n = (x(2) + 2.0 * roll.damping / roll.frequency * x(3)) / (bicycle.gravity * roll.gradient);
        const Scalar front = 1.0 + t.balance, rear = 1.0 - t.balance;
        if (t.effect == LoadTransfer<Scalar>::Effect::kLoads)
          return bicycle.tyre_forces(slip, {t.share * front * n, t.share * rear * n});
        const Scalar lost = t.loss * n * n;
        const std::array<Scalar, 2> Fy = bicycle.tyre_forces(slip);
        return {Fy[0] * (1.0 - lost * front), Fy[1] * (1.0 - lost * rear)};
      }
    }
    return bicycle.tyre_forces(slip);
  }

  /// Forces at the static loads as they are at the loads of the moment, with a_x along the vehicle.
  [[nodiscard]] std::array<Scalar, 2> loaded(const std::array<Scalar, 2>& Fy, const Scalar& steer, const Scalar& u,
                                             const Scalar& a_x) const {
    using std::tan;
    if (!axle_load.acts) return Fy;
    const VehicleParameters<Scalar>& p = bicycle.parameters;
    const Scalar moved = axle_load.sensitivity * (a_x * p.cg_height / bicycle.gravity);
    std::array<Scalar, 2> growth{1.0 + axle_load.downforce_f * u * u - moved / p.b,
                                 1.0 + axle_load.downforce_r * u * u + moved / p.a};
    for (Scalar& g : growth)
      if (g < AxleLoad<Scalar>::kLeastShareOfLoad) g = Scalar(AxleLoad<Scalar>::kLeastShareOfLoad);
    const Scalar turned = axle_load.front_force_share * (p.mass * a_x) * tan(steer);
    return {Fy[0] * growth[0] + 0.5 * turned, Fy[1] * growth[1]};
  }

  /// Sideways, of the contact points below the centre of gravity [m/s].
  template <int kStates>
  [[nodiscard]] Scalar contact_velocity(const Eigen::Matrix<Scalar, kStates, 1>& x) const {
    if constexpr (kStates > 2) return x(0) + roll.arm * x(3);
    return x(0);
  }

  /// The states of steady cornering at lateral velocity v and yaw rate r: the body at rest in its roll.
  template <int kStates>
  [[nodiscard]] Eigen::Matrix<Scalar, kStates, 1> steady(const Scalar& v, const Scalar& r, const Scalar& steer,
                                                         const Scalar& u,
                                                         const DriveConditions<Scalar>& conditions = {}) const {
    Eigen::Matrix<Scalar, kStates, 1> x;
    x(0) = v;
    x(1) = r;
    const std::array<Scalar, 2> slip = bicycle.slip_angles(v, r, steer, u);
    const BicycleRates<Scalar> plane = bicycle.rates_of_forces(
        slip, loaded(bicycle.tyre_forces(slip), steer, u, conditions.speed_rate - r * v), r, steer, u);
    if constexpr (kStates > 2) {
      x(2) = roll.gradient * plane.lateral_acceleration;
      x(3) = Scalar(0.0);
    }
    if constexpr (kStates > 4) {
      x(4) = plane.slip_angle[0];
      x(5) = plane.slip_angle[1];
    }
    return x;
  }
};

}  // namespace veridyn::vehicle
