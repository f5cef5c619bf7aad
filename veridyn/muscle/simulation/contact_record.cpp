#include "veridyn/muscle/simulation/contact_record.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/dynamics/body_forces.hpp"

namespace veridyn::muscle {
namespace {

/// A load of `record` and its columns.
void add_source(const std::string& contact, const std::string& body, ContactRecord& record) {
  std::string name = contact.empty() ? "contact" : contact;
  const auto taken = [&](const std::string& wanted) {
    return std::any_of(record.sources.begin(), record.sources.end(),
                       [&](const ExternalLoadSource& s) { return s.name == wanted; });
  };
  for (int number = 2; taken(name); ++number) name = fmt::format("{}_{}", contact, number);
  record.sources.push_back({.name = name, .body = body, .force = name + "_force_v", .point = name + "_force_p"});
  for (const char* kind : {"v", "p"})
    for (const char axis : {'x', 'y', 'z'})
      record.storage.labels.push_back(fmt::format("{}_force_{}{}", name, kind, axis));
}

}  // namespace

ContactRecord record_contacts(const MusculoskeletalSystem& system, const std::vector<double>& time,
                              const estimation::RowMatrix& q, const estimation::RowMatrix& qdot) {
  const Model& model = system.model();
  const Mechanism& mechanism = system.mechanism();
  ContactRecord record;
  record.storage.name = "contact_forces";
  record.storage.source = "contact_forces.sto";
  record.storage.time = time;
  std::vector<const SphereContact*> contacts;
  std::vector<double> sign;
  for (const SphereContact& contact : model.body_forces.contacts) {
    if (mechanism.body(contact.sphere_body).link > 0) {
      add_source(contact.name, model.bodies[contact.sphere_body].name, record);
      contacts.push_back(&contact);
      sign.push_back(1.0);
    }
    if (mechanism.body(contact.plane_body).link > 0) {
      add_source(contact.name + "_plane", model.bodies[contact.plane_body].name, record);
      contacts.push_back(&contact);
      sign.push_back(-1.0);
    }
  }
  Kinematics<double> kinematics(mechanism);
  for (Eigen::Index i = 0; i < signed_index(time.size()); ++i) {
    const Eigen::VectorXd pose = q.row(i), speed = qdot.row(i);
    update_positions(mechanism, pose.data(), kinematics);
    update_velocities(mechanism, speed.data(), kinematics);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      const ContactForce<double> found = contact_force(*contacts[k], mechanism, kinematics);
      for (const double value : found.force) record.storage.values.push_back(sign[k] * value);
      record.storage.values.insert(record.storage.values.end(), found.point.begin(), found.point.end());
    }
  }
  return record;
}

}  // namespace veridyn::muscle
