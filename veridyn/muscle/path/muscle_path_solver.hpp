#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "veridyn/core/assert.hpp"
#include "veridyn/muscle/path/muscle_path.hpp"
#include "veridyn/muscle/path/wrap_opensim.hpp"

/// Evaluation of compiled paths: templates of `muscle_path.hpp`.
namespace veridyn::muscle {

enum class PathFlag : std::uint8_t {
  kFine = 0,
  kFading = 1,  ///< a wrap counts in part: an end dips into its object, or a cylinder ends
  kInside = 2,  ///< a point lies inside a wrap object: straight there
  kFailed = 3,  ///< a geodesic did not converge: straight there
};

/// Which points `PathSolver` places.
enum class PathPlaces { kForLengths, kForAll, kEvery };

/// Results and scratch of `MusclePaths`, made once, used by one thread.
template <typename Scalar>
struct PathWorkspace {
  explicit PathWorkspace(const MusclePaths& paths)
      : length(paths.muscles_.size()),
        gradient(paths.pairs_.size()),
        flag(paths.muscles_.size(), PathFlag::kFine),
        position(paths.points_.size()),
        moving_slope(3 * paths.moving_.size()),
        segment_length(paths.segments_.size()),
        term(paths.terms_.size()),
        object(paths.objects_.size()),
        span(paths.spans_.size()),
        span_known(paths.spans_.size(), 0),
        stations(paths.most_stations_),
        nodes(paths.most_stations_ + 2 * paths.most_wraps_),
        other_nodes(nodes.size()),
        result(paths.most_wraps_),
        other_result(paths.most_wraps_),
        own_result(paths.most_wraps_),
        other_own_result(paths.most_wraps_),
        first(paths.most_wraps_),
        own_first(paths.most_wraps_),
        first_segment(paths.most_wraps_),
        before(2 * paths.most_wraps_),
        start(2 * paths.most_wraps_),
        memory(paths.most_wraps_) {
    for (std::size_t i = 0; i < paths.points_.size(); ++i)
      position[i] = paths.points_[i].location.template cast<Scalar>();
  }

  std::vector<Scalar> length;    ///< by muscle [m]
  std::vector<Scalar> gradient;  ///< dL/dq by pair [m/rad or 1]
  std::vector<PathFlag> flag;    ///< by muscle

  using Vector = Vector3<Scalar>;
  struct Frame {
    Matrix3<Scalar> rotation;
    Vector position;
  };
  struct Node {
    Vector x;
    int link = 0;
    int point = -1;    ///< of a path point
    int station = -1;  ///< of a path point
    int wrap = -1;     ///< of a tangent point
  };
  std::vector<Vector> position;
  std::vector<Vector> moving_slope;
  std::vector<Scalar> segment_length;
  std::vector<Scalar> term;
  std::vector<Frame> object;
  std::vector<WrapResult<Scalar>> span;
  std::vector<std::uint8_t> span_known;
  std::vector<Node> stations;
  std::vector<Node> nodes;
  std::vector<Node> other_nodes;
  WrapResult<Scalar> fresh;
  /// Of the wraps on the path: in `span`, or in `own_result` where an end is a tangent point.
  std::vector<const WrapResult<Scalar>*> result;
  std::vector<const WrapResult<Scalar>*> other_result;
  std::vector<WrapResult<Scalar>> own_result;
  std::vector<WrapResult<Scalar>> other_own_result;
  std::vector<const WrapResult<Scalar>*> first;
  std::vector<WrapResult<Scalar>> own_first;
  std::vector<int> first_segment;
  std::vector<Vector> before;  ///< tangent points of the last pass
  std::vector<Vector> start;   ///< and of the one before
  std::vector<internal::GeodesicMemory> memory;
};

template <typename Scalar>
class PathSolver {
 public:
  using Vector = Vector3<Scalar>;
  using Node = typename PathWorkspace<Scalar>::Node;
  using Path = MusclePaths::Path;

  PathSolver(const MusclePaths& paths, const Kinematics<Scalar>& kinematics, const Scalar* q,
             PathWorkspace<Scalar>& workspace, PathPlaces places)
      : paths_(paths), kinematics_(kinematics), q_(q), w_(workspace) {
    std::fill(w_.span_known.begin(), w_.span_known.end(), std::uint8_t{0});
    place(places);
  }

  /// All muscles but those of `skip` (by muscle, may be empty) that wrap.
  template <bool kGradient>
  void all(std::span<const std::uint8_t> skip = {}) {
    segments<kGradient>();
    if constexpr (kGradient) std::fill(w_.gradient.begin(), w_.gradient.end(), Scalar(0.0));
    for (const MusclePaths::StraightPath& path : paths_.straight_) {
      std::size_t held = 0;
      for (std::size_t c = path.conditions; c < path.end_conditions; ++c) {
        const MusclePaths::Condition& condition = paths_.conditions_[c];
        if (condition.holds(value_of(q_[condition.coordinate]))) held |= std::size_t{1} << (c - path.conditions);
      }
      const MusclePaths::Variant& variant = paths_.variants_[path.variants + held];
      Scalar length(variant.constant);
      for (std::size_t s = variant.segments; s < variant.end_segments; ++s)
        length += w_.segment_length[static_cast<std::size_t>(paths_.variant_segments_[s])];
      w_.length[static_cast<std::size_t>(path.muscle)] = length;
      if constexpr (kGradient) {
        for (std::size_t a = variant.adds; a < variant.end_adds; ++a) {
          const auto& [term, pair] = paths_.variant_adds_[a];
          w_.gradient[pair] += w_.term[term];
        }
      }
    }
    for (const int muscle : paths_.general_) {
      const auto m = static_cast<std::size_t>(muscle);
      if (!skip.empty() && skip[m] != 0) continue;
      w_.flag[m] = PathFlag::kFine;
      w_.length[m] = general<kGradient>(paths_.muscles_[m], w_.flag[m]);
    }
  }

  /// The nodes of one path as solved (in the workspace), their number.
  std::size_t nodes_of(int muscle) {
    PathFlag flag = PathFlag::kFine;
    const Path& path = paths_.muscles_[static_cast<std::size_t>(muscle)];
    stations(path);
    detect(path, flag);
    return solve(path, ~0u);
  }
  const WrapResult<Scalar>& result(std::size_t wrap) const { return *w_.result[wrap]; }

  /// What an object does to one segment, in ground; true if it wraps.
  bool wrap_between(const MusclePaths::Object& object, int index, const MusclePaths::Wrap& wrap, bool single,
                    const Vector& p_ground, const Vector& q_ground, WrapResult<Scalar>& r,
                    internal::GeodesicMemory* memory = nullptr) {
    const auto& frame = w_.object[static_cast<std::size_t>(index)];
    // Most segments pass far from most objects.
    if (object.reach > 0.0) {
      const Eigen::Vector3d a = value_of(Vector(p_ground - frame.position));
      const Eigen::Vector3d b = value_of(Vector(q_ground - p_ground));
      const double b2 = b.squaredNorm(), along = -a.dot(b);
      if (!(along > 0.0 && along < b2) || a.squaredNorm() * b2 - along * along > object.reach * object.reach * b2) {
        r.clear();
        return false;
      }
    } else if (object.shape == WrapShape::kCylinder && paths_.mode_ == WrapMode::kTaut) {
      const Eigen::Vector3d x = value_of(Vector(frame.rotation.col(0)));
      const Eigen::Vector3d y = value_of(Vector(frame.rotation.col(1)));
      const Eigen::Vector3d p = value_of(Vector(p_ground - frame.position));
      const Eigen::Vector3d q = value_of(Vector(q_ground - frame.position));
      const internal::CylinderPass pass =
          internal::cylinder_pass(object.cylinder, x.dot(p), y.dot(p), x.dot(q), y.dot(q));
      if (!pass.meets && !pass.long_way) {
        r.clear();
        return false;
      }
    }
    const Vector p = frame.rotation.transpose() * (p_ground - frame.position);
    const Vector q = frame.rotation.transpose() * (q_ground - frame.position);
    if (paths_.mode_ == WrapMode::kAsOpenSim) {
      r = as_opensim(object, wrap, single, p, q);
    } else {
      switch (object.shape) {
        case WrapShape::kSphere:
          internal::wrap_onto(object.sphere, p, q, r);
          break;
        case WrapShape::kCylinder:
          internal::wrap_onto(object.cylinder, p, q, r);
          break;
        case WrapShape::kEllipsoid:
          if (side_ == 0) {
            internal::wrap_onto(object.ellipsoid, p, q, memory, r);
          } else {
            WrapEllipsoid one_side = object.ellipsoid;
            one_side.side = side_;
            internal::wrap_onto(one_side, p, q, memory, r);
          }
          break;
        case WrapShape::kTorus:
          r = muscle::wrap(object.torus, p, q);
          break;
      }
    }
    if (!r.wrapped()) return false;
    r.r1 = frame.rotation * r.r1 + frame.position;
    r.r2 = frame.rotation * r.r2 + frame.position;
    // The straight parts' directions follow from the points; these are asked for only where an end dips in.
    if (r.depth > 0.0) {
      r.direction1 = frame.rotation * r.direction1;
      r.direction2 = frame.rotation * r.direction2;
      r.gradient_p = frame.rotation * r.gradient_p;
      r.gradient_q = frame.rotation * r.gradient_q;
    }
    if (r.weight < Scalar(1.0)) {
      r.weight_p = frame.rotation * r.weight_p;
      r.weight_q = frame.rotation * r.weight_q;
    }
    return true;
  }

 private:
  void place(PathPlaces places) {
    const auto at = [&](std::size_t i) {
      const MusclePaths::Point& point = paths_.points_[i];
      w_.position[i] = kinematics_.pose[static_cast<std::size_t>(point.link)] * point.location;
    };
    if (places == PathPlaces::kEvery) {
      for (std::size_t i = 0; i < paths_.points_.size(); ++i)
        if (paths_.points_[i].moving < 0) at(i);
    } else {
      for (const int i : places == PathPlaces::kForAll ? paths_.points_for_all_ : paths_.points_for_lengths_)
        at(static_cast<std::size_t>(i));
    }
    for (std::size_t i = 0; i < paths_.moving_.size(); ++i) {
      const MusclePaths::MovingPoint& moving = paths_.moving_[i];
      const Pose<Scalar>& pose =
          kinematics_.pose[static_cast<std::size_t>(paths_.points_[static_cast<std::size_t>(moving.point)].link)];
      Vector location = pose * moving.in_link.translation;
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const Vector direction = pose.rotation * moving.in_link.rotation.col(axis).template cast<Scalar>();
        const int c = moving.coordinate[a];
        const numerics::FunctionValue<Scalar> f = moving.location[a].evaluate(c >= 0 ? q_[c] : Scalar(0.0));
        location += direction * f.value;
        w_.moving_slope[3 * i + a] = direction * f.slope;
      }
      w_.position[static_cast<std::size_t>(moving.point)] = location;
    }
    for (std::size_t i = 0; i < paths_.objects_.size(); ++i) {
      const MusclePaths::Object& object = paths_.objects_[i];
      const Pose<Scalar>& pose = kinematics_.pose[static_cast<std::size_t>(object.link)];
      w_.object[i].rotation = pose.rotation * object.in_link.rotation.template cast<Scalar>();
      w_.object[i].position = pose * object.in_link.translation;
    }
  }

  template <bool kGradient>
  void segments() {
    using std::sqrt;
    std::size_t apart = 0;
    if constexpr (!kGradient) {
      // Lengths alone do not need ground: one end is taken to the other's link, all segments of two links together.
      for (const MusclePaths::LinkPair& pair : paths_.link_pairs_) lengths_between(pair);
      if (!paths_.link_pairs_.empty()) apart = paths_.link_pairs_.back().end;
    }
    for (std::size_t i = apart; i < paths_.segments_.size(); ++i) {
      const MusclePaths::Segment& s = paths_.segments_[i];
      const Vector& a = w_.position[static_cast<std::size_t>(s.a)];
      const Vector u = w_.position[static_cast<std::size_t>(s.b)] - a;
      const Scalar length = sqrt(u.squaredNorm());
      w_.segment_length[i] = length;
      if constexpr (kGradient) {
        const Vector d = u / length;
        const Vector m = a.cross(d);
        for (std::size_t t = s.terms[0]; t < s.terms[1]; ++t) {
          const MusclePaths::Term& term = paths_.terms_[t];
          if (term.moving >= 0) {
            const Scalar along = d.dot(w_.moving_slope[static_cast<std::size_t>(term.moving)]);
            w_.term[t] = term.sign > 0 ? along : Scalar(-along);
          } else {
            const SpatialVector<Scalar>& column = kinematics_.columns[static_cast<std::size_t>(term.coordinate)];
            const Scalar along = column.angular.dot(m) + column.linear.dot(d);
            w_.term[t] = term.sign > 0 ? along : Scalar(-along);
          }
        }
      }
    }
  }

  void lengths_between(const MusclePaths::LinkPair& pair) {
    using std::sqrt;
    const Pose<Scalar>& to = kinematics_.pose[static_cast<std::size_t>(pair.a)];
    const Pose<Scalar>& from = kinematics_.pose[static_cast<std::size_t>(pair.b)];
    const Matrix3<Scalar> r = to.rotation.transpose() * from.rotation;
    const Vector t = to.rotation.transpose() * (from.position - to.position);
    const double* ax = paths_.end_a_[0].data();
    const double* ay = paths_.end_a_[1].data();
    const double* az = paths_.end_a_[2].data();
    const double* bx = paths_.end_b_[0].data();
    const double* by = paths_.end_b_[1].data();
    const double* bz = paths_.end_b_[2].data();
    Scalar* length = w_.segment_length.data();
    for (std::size_t i = pair.first; i < pair.end; ++i) {
      const Scalar x = t.x() + r(0, 0) * bx[i] + r(0, 1) * by[i] + r(0, 2) * bz[i] - ax[i];
      const Scalar y = t.y() + r(1, 0) * bx[i] + r(1, 1) * by[i] + r(1, 2) * bz[i] - ay[i];
      const Scalar z = t.z() + r(2, 0) * bx[i] + r(2, 1) * by[i] + r(2, 2) * bz[i] - az[i];
      length[i] = x * x + y * y + z * z;
    }
    if constexpr (std::is_same_v<Scalar, double>) {
      // As an array, so that roots are taken two at a time.
      Eigen::Map<Eigen::ArrayXd> roots(length + pair.first, static_cast<Eigen::Index>(pair.end - pair.first));
      roots = roots.sqrt();
    } else {
      for (std::size_t i = pair.first; i < pair.end; ++i) length[i] = sqrt(length[i]);
    }
  }

  /// Active points of a path into w_.stations.
  void stations(const Path& path) {
    n_stations_ = 0;
    for (std::size_t i = 0; i < path.stations.size(); ++i) {
      const MusclePaths::PathStation& station = path.stations[i];
      if (station.condition >= 0 &&
          !MusclePaths::Condition{station.condition, station.low, station.high}.holds(value_of(q_[station.condition])))
        continue;
      Node& node = w_.stations[n_stations_++];
      node.x = w_.position[static_cast<std::size_t>(station.point)];
      node.link = paths_.points_[static_cast<std::size_t>(station.point)].link;
      node.point = station.point;
      node.station = static_cast<int>(i);
      node.wrap = -1;
    }
  }

  /// What each object does to the path of points alone: w_.first, w_.first_segment (-1: nothing).
  bool detect(const Path& path, PathFlag& flag) {
    bool any = false;
    for (std::size_t i = 0; i < path.wraps.size(); ++i) {
      const MusclePaths::Wrap& wrap = path.wraps[i];
      const MusclePaths::Object& object = paths_.objects_[static_cast<std::size_t>(wrap.object)];
      w_.first_segment[i] = -1;
      double least = 1e300;
      for (std::size_t k = 0; k + 1 < n_stations_; ++k) {
        const Node& a = w_.stations[k];
        const Node& b = w_.stations[k + 1];
        if (a.station < wrap.first || b.station > wrap.last) continue;
        const WrapResult<Scalar>* r = &w_.fresh;
        if (!wrap.spans.empty()) {
          const int s = wrap.spans[static_cast<std::size_t>(a.station - wrap.first)];
          if (s < 0) continue;
          const auto index = static_cast<std::size_t>(s);
          if (!w_.span_known[index]) {
            wrap_between(object, wrap.object, wrap, path.wraps.size() == 1, a.x, b.x, w_.span[index]);
            w_.span_known[index] = 1;
          }
          r = &w_.span[index];
        } else {
          wrap_between(object, wrap.object, wrap, path.wraps.size() == 1, a.x, b.x, w_.fresh);
        }
        if (r->status == WrapStatus::kInside) flag = std::max(flag, PathFlag::kInside);
        if (r->status == WrapStatus::kFailed) flag = std::max(flag, PathFlag::kFailed);
        if (!r->wrapped()) continue;
        const double longer = value_of(r->length) - value_of(Vector(b.x - a.x)).norm();
        if (r->meets || longer < least) {
          if (r == &w_.fresh) {
            w_.own_first[i] = w_.fresh;
            r = &w_.own_first[i];
          }
          w_.first[i] = r;
          w_.first_segment[i] = static_cast<int>(k);
          least = longer;
          any = true;
        }
        if (r->meets) break;
      }
      if (w_.first_segment[i] >= 0 && w_.first[i]->weight < Scalar(1.0)) flag = std::max(flag, PathFlag::kFading);
    }
    return any;
  }
  static Eigen::Vector3d value_of(const Vector& v) { return values_of(v); }
  static double value_of(const Scalar& v) { return muscle::value_of(v); }

  /// Puts the wraps of `mask` on the path of points: w_.nodes, w_.result. Returns the number of nodes.
  std::size_t solve(const Path& path, unsigned mask) {
    const std::size_t n = settle(path, mask);
    if (path.wraps.size() < 2 || paths_.mode_ == WrapMode::kAsOpenSim) return n;
    double spread = 1.0;
    for (std::size_t k = 0; k < n; ++k)
      if (w_.nodes[k].wrap >= 0)
        spread = std::min(spread, w_.result[static_cast<std::size_t>(w_.nodes[k].wrap)]->spread);
    if (spread >= 0.7) return n;
    // Objects solved one after the other may settle on the longer of two sides: try the other one too.
    const double length = muscle::value_of(measure<false>(path, n, Scalar(1.0)));
    double other_length = length;
    std::size_t other_n = n;
    std::swap(w_.nodes, w_.other_nodes);
    std::swap(w_.result, w_.other_result);
    std::swap(w_.own_result, w_.other_own_result);
    for (const int side : {1, -1}) {
      side_ = side;
      give_up_ = other_length + kNearlySettled;
      other_n_ = other_n;
      const std::size_t count = settle(path, mask);
      const double l = muscle::value_of(measure<false>(path, count, Scalar(1.0)));
      if (l < other_length - 1e-12) {
        other_length = l;
        other_n = count;
        std::swap(w_.nodes, w_.other_nodes);
        std::swap(w_.result, w_.other_result);
        std::swap(w_.own_result, w_.other_own_result);
      }
    }
    side_ = 0;
    std::swap(w_.nodes, w_.other_nodes);
    std::swap(w_.result, w_.other_result);
    std::swap(w_.own_result, w_.other_own_result);
    return other_n;
  }

  /// Whether nodes come to those of the best path so far: on one side no other solution is that near.
  bool as_before(std::size_t n) const {
    if (n != other_n_) return false;
    for (std::size_t k = 0; k < n; ++k)
      if (w_.nodes[k].wrap != w_.other_nodes[k].wrap ||
          !(value_of(Vector(w_.nodes[k].x - w_.other_nodes[k].x)).norm() < kNearlySettled))
        return false;
    return true;
  }

  std::size_t settle(const Path& path, unsigned mask) {
    std::copy_n(w_.stations.begin(), n_stations_, w_.nodes.begin());
    std::size_t n = n_stations_;
    if (path.wraps.size() == 1) {
      if ((mask & 1u) != 0 && w_.first_segment[0] >= 0) {
        w_.result[0] = w_.first[0];
        insert(path, 0, static_cast<std::size_t>(w_.first_segment[0]), n);
      }
      return n;
    }
    if (paths_.mode_ == WrapMode::kAsOpenSim) return solve_as_opensim(path, n);
    for (std::size_t i = 0; i < path.wraps.size(); ++i) w_.memory[i].clear();
    // Jets keep on for their derivatives after the values stand.
    int more = std::is_same_v<Scalar, double> ? 0 : 8;
    // An object is solved again only where another one on the path has changed since.
    std::array<int, 32> solved_at, changed_at;
    std::fill_n(changed_at.begin(), path.wraps.size(), -1);
    std::fill_n(solved_at.begin(), path.wraps.size(), -1);
    int step = 0;
    Acceleration acceleration;
    for (int pass = 0; pass < 60; ++pass) {
      double moved = 0.0;
      for (std::size_t i = 0; i < path.wraps.size(); ++i) {
        if ((mask >> i & 1u) == 0) continue;
        if (pass > 0) {
          bool same = true;
          for (std::size_t k = 0; k < path.wraps.size(); ++k)
            if (k != i && changed_at[k] > solved_at[i]) same = false;
          if (same) continue;
        }
        solved_at[i] = ++step;
        const MusclePaths::Wrap& wrap = path.wraps[i];
        const WrapResult<Scalar>* was = w_.result[i];
        const bool was_there = remove(static_cast<int>(i), n);
        const std::size_t at = choose(i, wrap, n);
        if (at < n) {
          insert(path, i, at, n);
          if (!was_there) {
            moved = 1.0;
            changed_at[i] = step;
          } else if (w_.result[i] != was || was == &w_.own_result[i]) {
            const double by = std::max(value_of(Vector(w_.result[i]->r1 - w_.before[2 * i])).norm(),
                                       value_of(Vector(w_.result[i]->r2 - w_.before[2 * i + 1])).norm());
            moved = std::max(moved, by);
            if (by > 0.0 || !std::is_same_v<Scalar, double>) changed_at[i] = step;
          }
          // Where it was, for the acceleration.
          w_.start[2 * i] = w_.before[2 * i];
          w_.start[2 * i + 1] = w_.before[2 * i + 1];
          w_.before[2 * i] = w_.result[i]->r1;
          w_.before[2 * i + 1] = w_.result[i]->r2;
        } else if (was_there) {
          moved = 1.0;
          changed_at[i] = step;
        }
      }
      if (moved == 0.0 || (pass > 0 && moved < 1e-8 && more-- <= 0)) break;
      // Nearly settled tangent points tell which solution it comes to; the length is stationary and tells if it is
      // longer.
      if (side_ != 0 && moved < kNearlySettled &&
          (as_before(n) || muscle::value_of(measure<false>(path, n, Scalar(1.0))) > give_up_))
        break;
      if constexpr (std::is_same_v<Scalar, double>) {
        if (pass > 0) accelerate(n, moved, acceleration);
      }
    }
    return n;
  }

  /// Anderson's acceleration, two passes deep: of the point where the later of two neighbouring objects faces the
  /// other.
  struct Acceleration {
    int known = 0;
    Eigen::Vector3d residual = Eigen::Vector3d::Zero(), image = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 3, 2> residual_change = Eigen::Matrix<double, 3, 2>::Zero();
    Eigen::Matrix<double, 3, 2> image_change = Eigen::Matrix<double, 3, 2>::Zero();
  };
  void accelerate(std::size_t n, double moved, Acceleration& a) {
    // The two objects whose ends are tangent points of another one.
    std::size_t found = 0, later = 0;
    for (std::size_t k = 0; k + 1 < n; ++k) {
      const int wrap = w_.nodes[k].wrap;
      if (wrap < 0 || wrap != w_.nodes[k + 1].wrap) continue;
      const auto i = static_cast<std::size_t>(wrap);
      if (w_.result[i] != &w_.own_result[i]) continue;
      ++found;
      later = std::max(later, i);
    }
    if (found != 2 || moved >= 1.0) {
      a.known = 0;
      return;
    }
    std::size_t k = 0;
    while (w_.nodes[k].wrap != static_cast<int>(later)) ++k;
    std::size_t side = 0;
    if (k > 0 && w_.nodes[k - 1].wrap >= 0) {
      side = 0;
    } else if (k + 2 < n && w_.nodes[k + 2].wrap >= 0) {
      side = 1;
    } else {
      return;
    }
    const Eigen::Vector3d image = value_of(w_.before[2 * later + side]);
    const Eigen::Vector3d residual = image - value_of(w_.start[2 * later + side]);
    if (a.known > 0) {
      a.residual_change.col(1) = a.residual_change.col(0);
      a.image_change.col(1) = a.image_change.col(0);
      a.residual_change.col(0) = residual - a.residual;
      a.image_change.col(0) = image - a.image;
    }
    a.residual = residual;
    a.image = image;
    ++a.known;
    if (a.known < 2) return;
    const Eigen::Vector3d d0 = a.residual_change.col(0);
    const double g00 = d0.squaredNorm(), b0 = d0.dot(residual);
    if (!(g00 > 0.0)) return;
    Eigen::Vector3d next = image - a.image_change.col(0) * (b0 / g00);
    if (a.known > 2) {
      const Eigen::Vector3d d1 = a.residual_change.col(1);
      const double g11 = d1.squaredNorm(), g01 = d0.dot(d1), b1 = d1.dot(residual);
      const double det = g00 * g11 - g01 * g01;
      if (det > 1e-6 * g00 * g11)
        next = image - a.image_change.col(0) * ((b0 * g11 - b1 * g01) / det) -
               a.image_change.col(1) * ((b1 * g00 - b0 * g01) / det);
    }
    if (!((next - image).norm() < 20.0 * residual.norm())) return;
    w_.nodes[k + side].x = next;
    w_.before[2 * later + side] = next;
  }

  bool remove(int wrap, std::size_t& n) {
    for (std::size_t j = 0; j < n; ++j) {
      if (w_.nodes[j].wrap != wrap) continue;
      for (std::size_t k = j; k + 2 < n; ++k) w_.nodes[k] = w_.nodes[k + 2];
      n -= 2;
      return true;
    }
    return false;
  }

  /// Segment of the path as it is on which wrap i acts (n: none), with its result in w_.result[i].
  std::size_t choose(std::size_t i, const MusclePaths::Wrap& wrap, std::size_t n) {
    const MusclePaths::Object& object = paths_.objects_[static_cast<std::size_t>(wrap.object)];
    std::size_t best = n;
    double least = 1e300;
    std::size_t k = 0;
    while (k < n && (w_.nodes[k].station < 0 || w_.nodes[k].station < wrap.first)) ++k;
    for (; k + 1 < n; ++k) {
      const Node& a = w_.nodes[k];
      const Node& b = w_.nodes[k + 1];
      if (a.station >= 0 && a.station >= wrap.last) break;
      if (b.station > wrap.last) break;
      if (a.wrap >= 0 && a.wrap == b.wrap) continue;
      const bool points = a.station >= 0 && b.station >= 0;
      const WrapResult<Scalar>* r = &w_.fresh;
      if (points && !wrap.spans.empty()) {
        const int s = wrap.spans[static_cast<std::size_t>(a.station - wrap.first)];
        if (s < 0) continue;
        const auto index = static_cast<std::size_t>(s);
        if (w_.span_known[index]) {
          r = &w_.span[index];
        } else {
          wrap_between(object, wrap.object, wrap, false, a.x, b.x, w_.fresh);
        }
      } else {
        // Only the ends of a fading object's own segment fade it: here it counts whole.
        wrap_between(object, wrap.object, wrap, false, a.x, b.x, w_.fresh, &w_.memory[i]);
      }
      if (!r->wrapped()) continue;
      const double longer = value_of(r->length) - value_of(Vector(b.x - a.x)).norm();
      if (r->meets || longer < least) {
        if (r == &w_.fresh) {
          w_.own_result[i] = w_.fresh;
          r = &w_.own_result[i];
        }
        w_.result[i] = r;
        best = k;
        least = longer;
      }
      if (r->meets) break;
    }
    return best;
  }

  void insert(const Path& path, std::size_t i, std::size_t at, std::size_t& n) {
    for (std::size_t k = n; k-- > at + 1;) w_.nodes[k + 2] = w_.nodes[k];
    const int link = paths_.objects_[static_cast<std::size_t>(path.wraps[i].object)].link;
    for (std::size_t j = 0; j < 2; ++j) {
      Node& node = w_.nodes[at + 1 + j];
      node.x = j == 0 ? w_.result[i]->r1 : w_.result[i]->r2;
      node.link = link;
      node.point = -1;
      node.station = -1;
      node.wrap = static_cast<int>(i);
    }
    n += 2;
  }

  template <bool kGradient>
  Scalar general(const Path& path, PathFlag& flag) {
    stations(path);
    if (n_stations_ < 2) return Scalar(0.0);
    const bool any = detect(path, flag);
    unsigned mask = ~0u;
    if (!any) mask = 0;
    std::size_t fading = path.wraps.size();
    for (std::size_t i = 0; any && i < path.wraps.size(); ++i)
      if (w_.first_segment[i] >= 0 && w_.first[i]->weight < Scalar(1.0)) fading = i;
    if (fading == path.wraps.size() || paths_.mode_ == WrapMode::kAsOpenSim)
      return measure<kGradient>(path, solve(path, mask), Scalar(1.0));
    return blended<kGradient>(path, mask, Scalar(1.0));
  }

  /// Length with the fading objects of `mask` blended, its gradient times `factor` added.
  template <bool kGradient>
  Scalar blended(const Path& path, unsigned mask, const Scalar& factor) {
    for (std::size_t i = 0; i < path.wraps.size(); ++i) {
      if ((mask >> i & 1u) == 0 || w_.first_segment[i] < 0 || !(w_.first[i]->weight < Scalar(1.0))) continue;
      if ((done_ >> i & 1u) != 0) continue;
      done_ |= 1u << i;
      const MusclePaths::Wrap& wrap = path.wraps[i];
      const Node a = w_.stations[static_cast<std::size_t>(w_.first_segment[i])];
      const Node b = w_.stations[static_cast<std::size_t>(w_.first_segment[i]) + 1];
      const Scalar weight = w_.first[i]->weight;
      const Vector slope_a = w_.first[i]->weight_p, slope_b = w_.first[i]->weight_q;
      const Scalar with = blended<kGradient>(path, mask, Scalar(factor * weight));
      const Scalar without = blended<kGradient>(path, mask & ~(1u << i), Scalar(factor * (Scalar(1.0) - weight)));
      if constexpr (kGradient) {
        const Scalar change = factor * (with - without);
        const int link = paths_.objects_[static_cast<std::size_t>(wrap.object)].link;
        add_string(path, change, a.x, slope_a, link, a.link);
        add_string(path, change, b.x, slope_b, link, b.link);
        add_moving(path, change, a.point, slope_a);
        add_moving(path, change, b.point, slope_b);
      }
      done_ &= ~(1u << i);
      return without + weight * (with - without);
    }
    return measure<kGradient>(path, solve(path, mask), factor);
  }

  /// Length of the nodes, and its gradient times `factor`.
  template <bool kGradient>
  Scalar measure(const Path& path, std::size_t n, const Scalar& factor) {
    using std::sqrt;
    Scalar length(0.0);
    for (std::size_t k = 0; k + 1 < n; ++k) {
      const Node& a = w_.nodes[k];
      const Node& b = w_.nodes[k + 1];
      if (a.wrap >= 0 && a.wrap == b.wrap) {
        const WrapResult<Scalar>& r = *w_.result[static_cast<std::size_t>(a.wrap)];
        length += r.surface_length;
        if constexpr (kGradient) {
          if (r.depth > 0.0 && paths_.mode_ == WrapMode::kTaut) {
            // An end that shrinks the object: an extra force there, its opposite on the object.
            const Node& p = w_.nodes[k - 1];
            const Node& q = w_.nodes[k + 2];
            const Vector extra_p = r.gradient_p + r.direction1;
            const Vector extra_q = r.gradient_q - r.direction2;
            add_string(path, factor, p.x, extra_p, a.link, p.link);
            add_string(path, factor, q.x, extra_q, a.link, q.link);
            if (p.point >= 0) add_moving(path, factor, p.point, extra_p);
            if (q.point >= 0) add_moving(path, factor, q.point, extra_q);
          }
        }
        continue;
      }
      if (a.station >= 0 && b.station == a.station + 1) {
        const double fixed = path.fixed[static_cast<std::size_t>(a.station)];
        if (fixed >= 0.0) {
          length += fixed;
          continue;
        }
      }
      const Vector u = b.x - a.x;
      const Scalar l2 = u.squaredNorm();
      if (!(value_of(l2) > 0.0)) continue;
      const Scalar l = sqrt(l2);
      length += l;
      if constexpr (kGradient) {
        const bool moving = (a.point >= 0 && is_moving(a.point)) || (b.point >= 0 && is_moving(b.point));
        if (a.link == b.link && !moving) continue;
        const Vector d = u / l;
        if (a.link != b.link) add_string(path, factor, a.x, d, a.link, b.link);
        if (moving) {
          if (a.point >= 0) add_moving(path, factor, a.point, Vector(-d));
          if (b.point >= 0) add_moving(path, factor, b.point, d);
        }
      }
    }
    return length;
  }

  bool is_moving(int point) const { return paths_.points_[static_cast<std::size_t>(point)].moving >= 0; }

  /// A covector g along a line through x that grows with the motion of `to` and against that of `from`.
  void add_string(const Path& path, const Scalar& factor, const Vector& x, const Vector& g, int from, int to) {
    const Vector m = x.cross(g);
    for (std::size_t k = path.pairs[0]; k < path.pairs[1]; ++k) {
      const int c = paths_.pairs_[k].coordinate;
      const int sign = static_cast<int>(paths_.moves(c, to)) - static_cast<int>(paths_.moves(c, from));
      if (sign == 0) continue;
      const SpatialVector<Scalar>& column = kinematics_.columns[static_cast<std::size_t>(c)];
      const Scalar along = factor * (column.angular.dot(m) + column.linear.dot(g));
      w_.gradient[k] += sign > 0 ? along : Scalar(-along);
    }
  }

  void add_moving(const Path& path, const Scalar& factor, int point, const Vector& g) {
    const int index = paths_.points_[static_cast<std::size_t>(point)].moving;
    if (index < 0) return;
    const MusclePaths::MovingPoint& moving = paths_.moving_[static_cast<std::size_t>(index)];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (moving.coordinate[axis] < 0) continue;
      for (std::size_t k = path.pairs[0]; k < path.pairs[1]; ++k) {
        if (paths_.pairs_[k].coordinate != moving.coordinate[axis]) continue;
        w_.gradient[k] += factor * g.dot(w_.moving_slope[3 * static_cast<std::size_t>(index) + axis]);
      }
    }
  }

  // OpenSim's own way ------------------------------------------------------------------------------------------------

  WrapResult<Scalar> as_opensim(const MusclePaths::Object& object, const MusclePaths::Wrap& wrap, bool single,
                                const Vector& p, const Vector& q) {
    WrapResult<Scalar> r;
    const OpenSimWrap o = wrap_as_opensim(object.description, wrap.method, single, values_of(p), values_of(q));
    if (o.action == OpenSimWrapAction::kInside) r.status = WrapStatus::kInside;
    if (!o.wraps()) return r;
    r.status = WrapStatus::kWrapped;
    r.meets = o.action == OpenSimWrapAction::kMandatory;
    r.r1 = o.r1.cast<Scalar>();
    r.r2 = o.r2.cast<Scalar>();
    r.surface_length = Scalar(o.surface_length);
    r.direction1 = (r.r1 - p).normalized();
    r.direction2 = (q - r.r2).normalized();
    r.gradient_p = -r.direction1;
    r.gradient_q = r.direction2;
    r.length = (r.r1 - p).norm() + r.surface_length + (q - r.r2).norm();
    return r;
  }

  std::size_t solve_as_opensim(const Path& path, std::size_t n) {
    double last = 1e300;
    std::size_t order[2] = {0, 1};
    for (int pass = 0; pass < 8; ++pass) {
      WrapStatus status[2] = {WrapStatus::kStraight, WrapStatus::kStraight};
      for (std::size_t slot = 0; slot < path.wraps.size(); ++slot) {
        const std::size_t i = slot < 2 ? order[slot] : slot;
        remove(static_cast<int>(i), n);
        const std::size_t at = choose(i, path.wraps[i], n);
        if (at < n) insert(path, i, at, n);
        if (slot < 2 && at == n && w_.first_segment[i] < 0) status[slot] = inside_somewhere(path, i, n);
        if (slot < 2 && at < n) status[slot] = WrapStatus::kWrapped;
      }
      const double length = muscle::value_of(measure<false>(path, n, Scalar(1.0)));
      if (std::abs(length - last) < 0.0005) break;
      last = length;
      if (pass == 0 && status[0] == WrapStatus::kStraight && status[1] == WrapStatus::kInside) {
        std::swap(order[0], order[1]);
        remove(0, n);
      }
    }
    return n;
  }
  WrapStatus inside_somewhere(const Path& path, std::size_t i, std::size_t n) {
    const MusclePaths::Wrap& wrap = path.wraps[i];
    const MusclePaths::Object& object = paths_.objects_[static_cast<std::size_t>(wrap.object)];
    WrapStatus status = WrapStatus::kStraight;
    for (std::size_t k = 0; k + 1 < n; ++k) {
      if (w_.nodes[k].wrap >= 0 && w_.nodes[k].wrap == w_.nodes[k + 1].wrap) continue;
      wrap_between(object, wrap.object, wrap, false, w_.nodes[k].x, w_.nodes[k + 1].x, w_.fresh);
      status = w_.fresh.status;
    }
    return status;
  }

  const MusclePaths& paths_;
  const Kinematics<Scalar>& kinematics_;
  const Scalar* q_;
  PathWorkspace<Scalar>& w_;
  std::size_t n_stations_ = 0;
  unsigned done_ = 0;
  int side_ = 0;
  double give_up_ = 0.0;     ///< length from which another side is not followed
  std::size_t other_n_ = 0;  ///< nodes of the best path so far
  static constexpr double kNearlySettled = 1e-3;
};

template <typename Scalar>
void MusclePaths::lengths(const Kinematics<Scalar>& kinematics, const Scalar* q,
                          PathWorkspace<Scalar>& workspace) const {
  PathSolver<Scalar>(*this, kinematics, q, workspace, PathPlaces::kForLengths).template all<false>();
}

template <typename Scalar>
void MusclePaths::evaluate(const Kinematics<Scalar>& kinematics, const Scalar* q,
                           PathWorkspace<Scalar>& workspace) const {
  PathSolver<Scalar>(*this, kinematics, q, workspace, PathPlaces::kForAll).template all<true>();
}

template <typename Scalar>
void MusclePaths::evaluate(const Kinematics<Scalar>& kinematics, const Scalar* q, PathWorkspace<Scalar>& workspace,
                           std::span<const std::uint8_t> skip) const {
  PathSolver<Scalar>(*this, kinematics, q, workspace, PathPlaces::kForAll).template all<true>(skip);
}

template <typename Scalar>
void MusclePaths::speeds(const PathWorkspace<Scalar>& workspace, const Scalar* qdot, Scalar* speeds) const {
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    Scalar speed(0.0);
    for (std::size_t k = muscles_[m].pairs[0]; k < muscles_[m].pairs[1]; ++k)
      speed += workspace.gradient[k] * qdot[pairs_[k].coordinate];
    speeds[m] = speed;
  }
}

}  // namespace veridyn::muscle
