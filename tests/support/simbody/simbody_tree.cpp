#include "tests/support/simbody/simbody_tree.hpp"

#include <Simbody.h>

#include <Eigen/Geometry>
#include <utility>

namespace veridyn::muscle::test {
namespace {

SimTK::Vec3 vec(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d eigen(const SimTK::Vec3& v) { return {v[0], v[1], v[2]}; }

SimTK::Mat33 mat(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}

SimTK::Transform transform(const TreeDescription::Frame& p) {
  return {SimTK::Rotation(mat(p.rotation)), vec(p.translation)};
}

using Body = SimTK::MobilizedBody;

/// The joint as the mobilizer of its own type.
SimTK::MobilizedBodyIndex own_mobilizer(const TreeDescription::Joint& joint, SimTK::MobilizedBody& base,
                                        const SimTK::Body::Rigid& info) {
  const SimTK::Transform F = transform(joint.parent_frame), M = transform(joint.child_frame);
  const auto direction = joint.reversed ? Body::Reverse : Body::Forward;
  switch (joint.mobilizer) {
    case TreeDescription::Mobilizer::kUniversal:
      return Body::Universal(base, F, info, M, direction).getMobilizedBodyIndex();
    case TreeDescription::Mobilizer::kBall:
      return Body::Ball(base, F, info, M, direction).getMobilizedBodyIndex();
    case TreeDescription::Mobilizer::kGimbal:
      return Body::Gimbal(base, F, info, M, direction).getMobilizedBodyIndex();
    case TreeDescription::Mobilizer::kPlanar:
      return Body::Planar(base, F, info, M, direction).getMobilizedBodyIndex();
    case TreeDescription::Mobilizer::kFree:
      return Body::Free(base, F, info, M, direction).getMobilizedBodyIndex();
    case TreeDescription::Mobilizer::kEllipsoid:
      return Body::Ellipsoid(base, F, info, M, vec(joint.radii), direction).getMobilizedBodyIndex();
    case TreeDescription::Mobilizer::kFunctions:
      break;
  }
  return base.getMobilizedBodyIndex();
}

void add_constraint(const TreeDescription::Constraint& c, SimTK::MobilizedBody& one, SimTK::MobilizedBody& two) {
  const SimTK::Transform A = transform(c.frame_1), B = transform(c.frame_2);
  switch (c.kind) {
    case TreeDescription::Constraint::Kind::kPoint:
      SimTK::Constraint::Ball(one, A.p(), two, B.p());
      break;
    case TreeDescription::Constraint::Kind::kWeld:
      SimTK::Constraint::Weld(one, A, two, B);
      break;
    case TreeDescription::Constraint::Kind::kDistance:
      SimTK::Constraint::Rod(one, A.p(), two, B.p(), c.distance);
      break;
    case TreeDescription::Constraint::Kind::kPointOnLine:
      SimTK::Constraint::PointOnLine(one, A.R().x(), A.p(), two, B.p());
      break;
  }
}

/// A function of no (a constant), one, or several coordinates.
class AxisFunction : public SimTK::Function {
 public:
  explicit AxisFunction(TreeDescription::Axis axis) : axis_(std::move(axis)) {}
  double calcValue(const SimTK::Vector& x) const override {
    if (!axis_.several.empty()) return axis_.of_several({}, arguments(x));
    return axis_.function(constant() ? 0.0 : x[0])[0];
  }
  double calcDerivative(const SimTK::Array_<int>& order, const SimTK::Vector& x) const override {
    if (!axis_.several.empty()) return axis_.of_several({order.begin(), order.end()}, arguments(x));
    return axis_.function(x[0])[order.size()];
  }
  int getArgumentSize() const override {
    return axis_.several.empty() ? (constant() ? 0 : 1) : static_cast<int>(axis_.several.size());
  }
  int getMaxDerivativeOrder() const override { return 2; }

 private:
  bool constant() const { return axis_.coordinate < 0; }
  static std::vector<double> arguments(const SimTK::Vector& x) {
    std::vector<double> values;
    for (int i = 0; i < x.size(); ++i) values.push_back(x[i]);
    return values;
  }
  TreeDescription::Axis axis_;
};

}  // namespace

struct SimbodyTree::System {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  SimTK::Force::DiscreteForces applied{forces, matter};
  SimTK::State state;
  std::vector<SimTK::MobilizedBodyIndex> bodies;
  std::vector<Eigen::Vector3d> mass_centers;
  std::vector<int> q_slot, u_slot;  ///< by coordinate: its place in Simbody's vectors

  [[nodiscard]] static Eigen::VectorXd ours(const SimTK::Vector& v, const std::vector<int>& slot) {
    Eigen::VectorXd x(static_cast<Eigen::Index>(slot.size()));
    for (std::size_t c = 0; c < slot.size(); ++c) x(static_cast<Eigen::Index>(c)) = v[slot[c]];
    return x;
  }
  /// By coordinate, as values, their rates, and forces on them.
  [[nodiscard]] SimTK::Vector as_q(const Eigen::VectorXd& v) const {
    SimTK::Vector x(state.getNQ(), 0.0);
    for (std::size_t c = 0; c < q_slot.size(); ++c) x[q_slot[c]] = v(static_cast<Eigen::Index>(c));
    return x;
  }
  [[nodiscard]] SimTK::Vector as_u(const Eigen::VectorXd& v) const {
    SimTK::Vector x(state.getNU(), 0.0);
    for (std::size_t c = 0; c < u_slot.size(); ++c) x[u_slot[c]] = v(static_cast<Eigen::Index>(c));
    return x;
  }
};

SimbodyTree::SimbodyTree(const TreeDescription& model) : system_(std::make_unique<System>()) {
  System& s = *system_;
  const SimTK::Force::UniformGravity gravity(s.forces, s.matter, vec(model.gravity));
  s.bodies.assign(model.bodies.size(), SimTK::MobilizedBodyIndex(0));
  std::vector<bool> placed(model.bodies.size(), false);
  placed[0] = true;
  std::vector<SimTK::MobilizedBodyIndex> of_coordinate(model.coordinates);
  std::vector<int> local(model.coordinates, 0);
  for (const TreeDescription::Body& body : model.bodies) s.mass_centers.push_back(body.mass_center);
  for (std::size_t remaining = model.joints.size(); remaining > 0;) {
    for (const TreeDescription::Joint& joint : model.joints) {
      const auto child = static_cast<std::size_t>(joint.child), parent = static_cast<std::size_t>(joint.parent);
      if (placed[child] || !placed[parent]) continue;
      placed[child] = true;
      --remaining;
      const TreeDescription::Body& body = model.bodies[child];
      const Eigen::Matrix3d& I = body.inertia;
      const SimTK::Inertia central(SimTK::Vec3(I(0, 0), I(1, 1), I(2, 2)), SimTK::Vec3(I(0, 1), I(0, 2), I(1, 2)));
      const SimTK::Body::Rigid info(SimTK::MassProperties(
          body.mass, vec(body.mass_center), central.shiftFromMassCenter(vec(body.mass_center), body.mass)));
      SimTK::Array_<const SimTK::Function*> functions;
      SimTK::Array_<SimTK::Array_<int>> indices;
      SimTK::Array_<SimTK::Vec3> axes;
      for (std::size_t i = 0; i < 6; ++i) {
        const TreeDescription::Axis& axis = joint.axes[i];
        functions.push_back(new AxisFunction(axis));
        SimTK::Array_<int> index;
        for (const int wanted : axis.several.empty() ? std::vector<int>{axis.coordinate} : axis.several)
          for (std::size_t c = 0; c < joint.coordinates.size(); ++c)
            if (joint.coordinates[c] == wanted) index.push_back(static_cast<int>(c));
        indices.push_back(index);
        axes.push_back(vec(axis.direction));
      }
      SimTK::MobilizedBody& base = s.matter.updMobilizedBody(s.bodies[parent]);
      if (joint.coordinates.empty()) {
        TreeDescription::Frame moved = joint.parent_frame;
        for (std::size_t i = 0; i < 6; ++i) {
          const TreeDescription::Axis& a = joint.axes[i];
          const double amount = a.function(0.0)[0];
          if (i < 3) moved.rotation = moved.rotation * Eigen::AngleAxisd(amount, a.direction).toRotationMatrix();
          if (i >= 3) moved.translation += joint.parent_frame.rotation * a.direction * amount;
        }
        for (const SimTK::Function* f : functions) delete f;
        const SimTK::MobilizedBody::Weld weld(base, transform(moved), info, transform(joint.child_frame));
        s.bodies[child] = weld.getMobilizedBodyIndex();
      } else if (joint.mobilizer != TreeDescription::Mobilizer::kFunctions) {
        for (const SimTK::Function* f : functions) delete f;
        s.bodies[child] = own_mobilizer(joint, base, info);
      } else {
        const SimTK::MobilizedBody::FunctionBased custom(base, transform(joint.parent_frame), info,
                                                         transform(joint.child_frame),
                                                         static_cast<int>(joint.coordinates.size()), functions, indices,
                                                         axes, joint.reversed ? Body::Reverse : Body::Forward);
        s.bodies[child] = custom.getMobilizedBodyIndex();
      }
      for (std::size_t c = 0; c < joint.coordinates.size(); ++c) {
        of_coordinate[joint.coordinates[c]] = s.bodies[child];
        local[joint.coordinates[c]] = static_cast<int>(c);
      }
    }
  }
  for (const TreeDescription::Constraint& c : model.constraints) {
    add_constraint(c, s.matter.updMobilizedBody(s.bodies[static_cast<std::size_t>(c.body_1)]),
                   s.matter.updMobilizedBody(s.bodies[static_cast<std::size_t>(c.body_2)]));
  }
  s.state = s.system.realizeTopology();
  s.matter.setUseEulerAngles(s.state, true);
  s.system.realizeModel(s.state);
  for (std::size_t c = 0; c < local.size(); ++c) {
    const SimTK::MobilizedBody& body = s.matter.getMobilizedBody(of_coordinate[c]);
    s.q_slot.push_back(body.getFirstQIndex(s.state) + local[c]);
    s.u_slot.push_back(body.getFirstUIndex(s.state) + local[c]);
  }
}

SimbodyTree::~SimbodyTree() = default;

void SimbodyTree::set_state(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot) {
  system_->state.updQ() = system_->as_q(q);
  system_->system.realize(system_->state, SimTK::Stage::Position);
  SimTK::Vector u;
  system_->matter.multiplyByNInv(system_->state, false, system_->as_q(qdot), u);
  system_->state.updU() = u;
  system_->applied.clearAllForces(system_->state);
  system_->system.realize(system_->state, SimTK::Stage::Dynamics);
}

Eigen::VectorXd SimbodyTree::speeds() const { return System::ours(system_->state.getU(), system_->u_slot); }

Eigen::VectorXd SimbodyTree::accelerations(const Eigen::VectorXd& tau) {
  SimTK::Vector on_speeds;
  system_->matter.multiplyByN(system_->state, true, system_->as_q(tau), on_speeds);
  system_->applied.setAllMobilityForces(system_->state, on_speeds);
  system_->system.realize(system_->state, SimTK::Stage::Acceleration);
  return System::ours(system_->state.getQDotDot(), system_->q_slot);
}

void SimbodyTree::realize_accelerations() {
  system_->state.updQ();  // marks everything from positions on as out of date
  system_->system.realize(system_->state, SimTK::Stage::Acceleration);
}

Eigen::MatrixXd SimbodyTree::mass_matrix() const {
  SimTK::Matrix M;
  system_->matter.calcM(system_->state, M);
  const auto n = static_cast<Eigen::Index>(system_->u_slot.size());
  Eigen::MatrixXd ours(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      ours(i, j) = M(system_->u_slot[i], system_->u_slot[j]);
    }
  }
  return ours;
}

Eigen::VectorXd SimbodyTree::inverse_dynamics(const Eigen::VectorXd& qddot) const {
  SimTK::Vector residual;
  system_->matter.calcResidualForceIgnoringConstraints(
      system_->state, SimTK::Vector(), system_->system.getRigidBodyForces(system_->state, SimTK::Stage::Dynamics),
      system_->as_u(qddot), residual);
  return System::ours(residual, system_->u_slot);
}

TreeDescription::Frame SimbodyTree::body_pose(int body) const {
  const SimTK::Transform& X = system_->matter.getMobilizedBody(system_->bodies[body]).getBodyTransform(system_->state);
  TreeDescription::Frame p;
  for (int i = 0; i < 3; ++i) {
    p.translation(i) = X.p()[i];
    p.rotation.col(i) = eigen(SimTK::Vec3(X.R()(i)));
  }
  return p;
}

Eigen::Vector3d SimbodyTree::mass_center_velocity(int body) const {
  return eigen(system_->matter.getMobilizedBody(system_->bodies[body])
                   .findStationVelocityInGround(system_->state, vec(system_->mass_centers[body])));
}

Eigen::Vector3d SimbodyTree::angular_velocity(int body) const {
  return eigen(system_->matter.getMobilizedBody(system_->bodies[body]).getBodyAngularVelocity(system_->state));
}

}  // namespace veridyn::muscle::test
