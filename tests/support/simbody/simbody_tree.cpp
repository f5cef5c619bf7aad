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

/// A function of no (a constant) or one coordinate.
class AxisFunction : public SimTK::Function {
 public:
  explicit AxisFunction(TreeDescription::Axis axis) : axis_(std::move(axis)) {}
  double calcValue(const SimTK::Vector& x) const override { return axis_.function(constant() ? 0.0 : x[0])[0]; }
  double calcDerivative(const SimTK::Array_<int>& order, const SimTK::Vector& x) const override {
    return axis_.function(x[0])[order.size()];
  }
  int getArgumentSize() const override { return constant() ? 0 : 1; }
  int getMaxDerivativeOrder() const override { return 2; }

 private:
  bool constant() const { return axis_.coordinate < 0; }
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
  std::vector<int> slot;  ///< by coordinate: its place in Simbody's vectors

  [[nodiscard]] Eigen::VectorXd ours(const SimTK::Vector& v) const {
    Eigen::VectorXd x(slot.size());
    for (std::size_t c = 0; c < slot.size(); ++c) x(c) = v[slot[c]];
    return x;
  }
  [[nodiscard]] SimTK::Vector theirs(const Eigen::VectorXd& v) const {
    SimTK::Vector x(static_cast<int>(slot.size()));
    for (std::size_t c = 0; c < slot.size(); ++c) x[slot[c]] = v(c);
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
        for (std::size_t c = 0; c < joint.coordinates.size(); ++c) {
          if (joint.coordinates[c] == axis.coordinate) index.push_back(static_cast<int>(c));
        }
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
      } else {
        const SimTK::MobilizedBody::FunctionBased custom(
            base, transform(joint.parent_frame), info, transform(joint.child_frame),
            static_cast<int>(joint.coordinates.size()), functions, indices, axes);
        s.bodies[child] = custom.getMobilizedBodyIndex();
      }
      for (std::size_t c = 0; c < joint.coordinates.size(); ++c) {
        of_coordinate[joint.coordinates[c]] = s.bodies[child];
        local[joint.coordinates[c]] = static_cast<int>(c);
      }
    }
  }
  s.state = s.system.realizeTopology();
  for (std::size_t c = 0; c < local.size(); ++c) {
    s.slot.push_back(s.matter.getMobilizedBody(of_coordinate[c]).getFirstUIndex(s.state) + local[c]);
  }
}

SimbodyTree::~SimbodyTree() = default;

void SimbodyTree::set_state(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot) {
  system_->state.updQ() = system_->theirs(q);
  system_->state.updU() = system_->theirs(qdot);
  system_->applied.clearAllForces(system_->state);
  system_->system.realize(system_->state, SimTK::Stage::Dynamics);
}

Eigen::VectorXd SimbodyTree::accelerations(const Eigen::VectorXd& tau) {
  system_->applied.setAllMobilityForces(system_->state, system_->theirs(tau));
  system_->system.realize(system_->state, SimTK::Stage::Acceleration);
  return system_->ours(system_->state.getUDot());
}

void SimbodyTree::realize_accelerations() {
  system_->state.updQ();  // marks everything from positions on as out of date
  system_->system.realize(system_->state, SimTK::Stage::Acceleration);
}

Eigen::MatrixXd SimbodyTree::mass_matrix() const {
  SimTK::Matrix M;
  system_->matter.calcM(system_->state, M);
  const auto n = static_cast<Eigen::Index>(system_->slot.size());
  Eigen::MatrixXd ours(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      ours(i, j) = M(system_->slot[i], system_->slot[j]);
    }
  }
  return ours;
}

Eigen::VectorXd SimbodyTree::inverse_dynamics(const Eigen::VectorXd& qddot) const {
  SimTK::Vector residual;
  system_->matter.calcResidualForceIgnoringConstraints(
      system_->state, SimTK::Vector(), system_->system.getRigidBodyForces(system_->state, SimTK::Stage::Dynamics),
      system_->theirs(qddot), residual);
  return system_->ours(residual);
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
