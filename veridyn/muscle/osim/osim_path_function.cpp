// Paths of an .osim file that are given as functions of coordinates.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/osim_context.hpp"
#include "veridyn/muscle/osim/osim_function.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle::osim {
namespace {

using FunctionOfCoordinates = decltype(PathFunction::length);
constexpr double kContradiction = 1.0e-3;  ///< of moment arms [m/rad or 1] and speeds [m/s]

FunctionOfCoordinates read_any(const Element& function, std::size_t arguments) {
  if (arguments == 1) return read_function(function);
  return read_function_of_several(function, arguments);
}

/// Returns the value; gradient by argument.
double evaluate(const FunctionOfCoordinates& function, std::span<const double> x, std::span<double> gradient) {
  if (const auto* polynomial = std::get_if<numerics::MultivariatePolynomial>(&function))
    return polynomial->evaluate(x.data(), gradient.data());
  const auto f = std::get<numerics::PiecewisePolynomial>(function).evaluate(x[0]);
  gradient[0] = f.slope;
  return f.value;
}

/// Random poses, and speeds between -1 and 1, of a path's coordinates.
struct PathPose {
  std::vector<double> q, qdot, slope;  ///< dL/dq
};

std::vector<PathPose> random_poses(const Model& model, const PathFunction& path) {
  constexpr int kPoses = 200;
  constexpr double kUnlimited = 20.0;
  numerics::RandomStream random(1, "path functions");
  std::vector<PathPose> poses(kPoses);
  for (PathPose& pose : poses) {
    for (const int index : path.coordinates) {
      const Coordinate& c = model.coordinates[index];
      const bool limited = c.high - c.low < kUnlimited;
      pose.q.push_back(limited ? random.uniform(c.low, c.high) : c.default_value + random.uniform(-0.5, 0.5));
      pose.qdot.push_back(random.uniform(-1.0, 1.0));
    }
    pose.slope.resize(pose.q.size());
    static_cast<void>(evaluate(path.length, pose.q, pose.slope));
  }
  return poses;
}

std::string text_of(const Model& model, const PathFunction& path, const PathPose& pose) {
  std::string text;
  for (std::size_t i = 0; i < path.coordinates.size(); ++i) {
    const Coordinate& c = model.coordinates[path.coordinates[i]];
    text += fmt::format("{}{} = {:.4g} {}", i == 0 ? "" : ", ", c.name, pose.q[i], c.unit());
  }
  return text;
}

/// OpenSim takes given moment arms as they are; ours are the slopes of the length.
void compare_arms(Context& context, const Element& element, const PathFunction& path,
                  const std::vector<PathPose>& poses, const std::vector<Element>& functions) {
  const std::size_t n = path.coordinates.size();
  if (functions.size() != n)
    element.fail("moment_arm_functions", fmt::format("{} functions of {} coordinates", functions.size(), n));
  double worst = 0.0, otherwise = 0.0;
  std::size_t of = 0;
  const PathPose* at_pose = nullptr;
  std::vector<double> unused(n);
  for (std::size_t i = 0; i < n; ++i) {
    const FunctionOfCoordinates arm = read_any(functions[i], n);
    for (const PathPose& pose : poses) {
      const double given = evaluate(arm, pose.q, unused);
      otherwise = std::max(otherwise, std::abs(given - pose.slope[i]));
      const double off = std::abs(given + pose.slope[i]);
      if (off <= worst) continue;
      worst = off;
      of = i;
      at_pose = &pose;
    }
  }
  if (!(worst > kContradiction)) return;
  const Coordinate& c = context.model.coordinates[path.coordinates[of]];
  context.warn(element,
               fmt::format("moment_arm_functions are not -dL/dq of the length: about '{}' they differ by {:.3g} {} at "
                           "{}{}; the length's slope is used",
                           c.name, worst, c.unit() == "m" ? "m/m" : "m/rad", text_of(context.model, path, *at_pose),
                           otherwise <= kContradiction ? ", as they are +dL/dq" : ""));
}

/// Ours are the rates of the length.
void compare_speed(Context& context, const Element& element, const PathFunction& path,
                   const std::vector<PathPose>& poses, const Element& function) {
  const std::size_t n = path.coordinates.size();
  const numerics::MultivariatePolynomial speed = read_function_of_several(function, 2 * n);
  double worst = 0.0;
  const PathPose* at_pose = nullptr;
  for (const PathPose& pose : poses) {
    std::vector<double> x = pose.q;
    x.insert(x.end(), pose.qdot.begin(), pose.qdot.end());
    double off = speed.value(x.data());
    for (std::size_t i = 0; i < n; ++i) off -= pose.slope[i] * pose.qdot[i];
    if (std::abs(off) <= worst) continue;
    worst = std::abs(off);
    at_pose = &pose;
  }
  if (worst > kContradiction)
    context.warn(element, fmt::format("lengthening_speed_function is not the rate of the length: it differs by {:.3g} "
                                      "m/s at {}, at speeds within 1 per second; the length's rate is used",
                                      worst, text_of(context.model, path, *at_pose)));
}

}  // namespace

std::optional<PathFunction> read_path_function(Context& context, const Element& owner) {
  Element element = owner.child("FunctionBasedPath");
  if (!element) element = Element(context.document, owner.property("path").child("FunctionBasedPath"));
  if (!element) return std::nullopt;
  PathFunction path;
  const char* const property = element.has("coordinate_paths") ? "coordinate_paths" : "coordinates";
  for (const std::string& name : element.words(property)) {
    const int index = context.coordinate(owner, property, name);
    if (std::find(path.coordinates.begin(), path.coordinates.end(), index) != path.coordinates.end())
      owner.fail(property, fmt::format("'{}' stands there twice", name));
    path.coordinates.push_back(index);
  }
  if (path.coordinates.empty()) owner.fail(property, "a path's length must depend on at least one coordinate");
  const Element length = find_function(element, "length_function");
  if (!length) owner.fail("length_function", "missing");
  path.length = read_any(length, path.coordinates.size());
  const std::vector<PathPose> poses = random_poses(context.model, path);
  const std::vector<Element> arms = element.objects("moment_arm_functions");
  if (!arms.empty()) compare_arms(context, owner, path, poses, arms);
  if (const Element speed = find_function(element, "lengthening_speed_function"))
    compare_speed(context, owner, path, poses, speed);
  return path;
}

}  // namespace veridyn::muscle::osim
