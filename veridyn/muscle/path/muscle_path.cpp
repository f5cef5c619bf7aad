#include "veridyn/muscle/path/muscle_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <set>
#include <tuple>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::muscle {

int MusclePaths::point(int link, const Eigen::Vector3d& location) {
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (points_[i].moving < 0 && points_[i].link == link && points_[i].location == location) return static_cast<int>(i);
  points_.push_back({link, location, -1});
  return static_cast<int>(points_.size()) - 1;
}

int MusclePaths::segment(int a, int b) {
  for (std::size_t i = 0; i < segments_.size(); ++i)
    if (segments_[i].a == a && segments_[i].b == b) return static_cast<int>(i);
  Segment segment{a, b, {terms_.size(), terms_.size()}};
  const Point& pa = points_[a];
  const Point& pb = points_[b];
  for (int c = 0; c < coordinates_; ++c) {
    const int sign = static_cast<int>(moves(c, pb.link)) - static_cast<int>(moves(c, pa.link));
    if (sign != 0) terms_.push_back({c, sign, -1});
  }
  for (const auto& [at, sign] : {std::pair{&pa, -1}, std::pair{&pb, 1}}) {
    if (at->moving < 0) continue;
    const MovingPoint& moving = moving_[at->moving];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int c = moving.coordinate[axis];
      if (c >= 0 && moving.with[axis] == axis) terms_.push_back({c, sign, 3 * at->moving + static_cast<int>(axis)});
    }
  }
  segment.terms[1] = terms_.size();
  segments_.push_back(segment);
  return static_cast<int>(segments_.size()) - 1;
}

std::vector<int> MusclePaths::coordinates_of(const Path& path) const {
  std::vector<int> links;
  std::set<int> moving;
  for (const PathStation& station : path.stations) {
    const Point& p = points_[station.point];
    links.push_back(p.link);
    if (p.moving < 0) continue;
    for (const int c : moving_[p.moving].coordinate)
      if (c >= 0) moving.insert(c);
  }
  for (const Wrap& wrap : path.wraps) links.push_back(objects_[wrap.object].link);
  std::vector<int> found;
  for (int c = 0; c < coordinates_; ++c) {
    const auto count = std::count_if(links.begin(), links.end(), [&](int link) { return moves(c, link); });
    if ((count > 0 && count < signed_index(links.size())) || moving.count(c) > 0) found.push_back(c);
  }
  return found;
}

MusclePaths::MusclePaths(const Model& model, const Mechanism& mechanism, WrapMode mode)
    : mode_(mode), coordinates_(mechanism.coordinates()) {
  moves_.resize(static_cast<std::size_t>(mechanism.links()) * static_cast<std::size_t>(coordinates_));
  for (int link = 0; link < mechanism.links(); ++link)
    for (int c = 0; c < coordinates_; ++c) moves_[link * coordinates_ + c] = mechanism.moves(c, link) ? 1 : 0;
  for (const WrapObject& object : model.wrap_objects) add_object(model, mechanism, object);
  for (const Muscle& muscle : model.muscles) add_path(model, mechanism, muscle);
  for (int muscle = 0; muscle < muscles(); ++muscle) {
    if (model.muscles[muscle].function) {
      add_function(model, muscle);
    } else {
      compile_path(muscle);
    }
  }
  sort_segments();
  list_points();
}

void MusclePaths::add_object(const Model& model, const Mechanism& mechanism, const WrapObject& object) {
  if (object.body < 0 || object.body >= static_cast<int>(model.bodies.size()))
    throw InputError(model.name, fmt::format("wrap object {} is fixed to no body", object.name));
  const int sizes = object.shape == WrapShape::kEllipsoid ? 3 : (object.shape == WrapShape::kSphere ? 1 : 2);
  for (int i = 0; i < sizes; ++i)
    if (!(object.dimensions[i] > 0.0))
      throw InputError(model.name, fmt::format("wrap object {}: its dimensions must be positive, one is {}",
                                               object.name, object.dimensions[i]));
  const Mechanism::BodyPlace& place = mechanism.body(object.body);
  Object compiled;
  compiled.name = object.name;
  compiled.description = object;
  compiled.link = place.link;
  compiled.in_link = place.in_link * object.placement;
  compiled.shape = object.shape;
  const Eigen::Vector3d& d = object.dimensions;
  compiled.sphere = {d[0], object.quadrant};
  compiled.cylinder = {d[0], 0.5 * d[1], object.quadrant};
  compiled.ellipsoid = {d, object.quadrant};
  compiled.torus = {d[0], d[1], object.quadrant};
  if (mode_ == WrapMode::kTaut && (sizes == 1 || sizes == 3)) compiled.reach = d.head(sizes).maxCoeff();
  objects_.push_back(compiled);
}

MusclePaths::PathStation MusclePaths::station(const Model& model, const Mechanism& mechanism, const Muscle& muscle,
                                              const PathPoint& p) {
  if (p.body < 0 || p.body >= static_cast<int>(model.bodies.size()))
    throw InputError(model.name, fmt::format("muscle {}: point {} is fixed to no body", muscle.name(), p.name));
  const Mechanism::BodyPlace& place = mechanism.body(p.body);
  PathStation station;
  station.name = p.name;
  if (p.kind == PathPointKind::kMoving) {
    MovingPoint moving;
    moving.point = static_cast<int>(points_.size());
    moving.in_link = place.in_link * p.frame;
    moving.coordinate = p.moving_coordinate;
    moving.location = p.moving_location;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (moving.coordinate[axis] < 0) {
        moving.still[axis] = moving.location[axis].evaluate(0.0).value;
        continue;
      }
      const Coordinate& c = model.coordinates[moving.coordinate[axis]];
      moving.with[axis] = axis;
      for (std::size_t other = axis; other-- > 0;)
        if (moving.coordinate[other] == moving.coordinate[axis]) moving.with[axis] = other;
      moving.low[axis] = c.low;
      moving.high[axis] = c.high;
    }
    points_.push_back({place.link, Eigen::Vector3d::Zero(), static_cast<int>(moving_.size())});
    moving_.push_back(moving);
    station.point = moving.point;
  } else {
    station.point = point(place.link, place.in_link * p.location);
    if (p.kind == PathPointKind::kConditional) {
      station.condition = p.coordinate;
      station.low = p.low;
      station.high = p.high;
    }
  }
  return station;
}

void MusclePaths::add_path(const Model& model, const Mechanism& mechanism, const Muscle& muscle) {
  Path path;
  path.name = muscle.name();
  if (muscle.function) {
    muscles_.push_back(path);
    return;
  }
  if (muscle.points.size() < 2)
    throw InputError(model.name, fmt::format("muscle {}: a path needs at least two points", path.name));
  for (const PathPoint& p : muscle.points) path.stations.push_back(station(model, mechanism, muscle, p));
  const int stations = static_cast<int>(path.stations.size());
  for (const PathWrap& w : muscle.wraps) {
    if (w.object < 0 || w.object >= static_cast<int>(objects_.size()))
      throw InputError(model.name, fmt::format("muscle {}: it wraps over an object that is not there", path.name));
    if (!objects_[w.object].description.active) continue;
    Wrap wrap;
    wrap.object = w.object;
    wrap.first = std::max(0, w.first_point);
    wrap.last = w.last_point < 0 ? stations - 1 : std::min(stations - 1, w.last_point);
    wrap.method = w.method;
    path.wraps.push_back(wrap);
  }
  if (path.wraps.size() > kMostWraps)
    throw InputError(model.name, fmt::format("muscle {}: more than {} wrap objects", path.name, kMostWraps));
  muscles_.push_back(path);
}

void MusclePaths::add_function(const Model& model, int muscle) {
  Path& path = muscles_[muscle];
  const std::vector<int> coordinates = functions_.add(model, muscle, pairs_.size());
  path.pairs[0] = pairs_.size();
  for (const int c : coordinates) pairs_.push_back({muscle, c});
  path.pairs[1] = pairs_.size();
}

/// Object and both ends on one link: the answer is always the same; where it is no, the wrap is not tested again.
bool MusclePaths::never_wraps(const Object& object, const Point& a, const Point& b) const {
  if (mode_ != WrapMode::kTaut || a.link != object.link || b.link != object.link || a.moving >= 0 || b.moving >= 0)
    return false;
  const Placement in = object.in_link.inverse();
  return wrap_status(object, in * a.location, in * b.location) == WrapStatus::kStraight;
}

/// The pairs of points that each wrap of a path without conditions is tested on.
void MusclePaths::list_spans(Path& path) {
  for (Wrap& wrap : path.wraps) {
    for (int i = wrap.first; i < wrap.last; ++i) {
      const int a = path.stations[i].point;
      const int b = path.stations[i + 1].point;
      if (never_wraps(objects_[wrap.object], points_[a], points_[b])) {
        wrap.spans.push_back(-1);
        continue;
      }
      // OpenSim's cylinder depends on whether it is the path's only wrap, its ellipsoid on the method: not shared.
      const auto same = std::find_if(spans_.begin(), spans_.end(), [&](const Span& s) {
        return mode_ == WrapMode::kTaut && s.a == a && s.b == b && s.object == wrap.object && s.alone == wrap.alone;
      });
      wrap.spans.push_back(static_cast<int>(same - spans_.begin()));
      if (same == spans_.end()) spans_.push_back({a, b, wrap.object, wrap.alone});
    }
  }
}

/// A wrap for each segment that its object can act on, so that no choice between segments makes the length jump.
void MusclePaths::part_wraps(Path& path) const {
  std::vector<Wrap> parts;
  for (const Wrap& wrap : path.wraps) {
    for (int i = wrap.first; i < wrap.last; ++i) {
      const int span = wrap.spans[i - wrap.first];
      if (span >= 0) parts.push_back({wrap.object, i, i + 1, wrap.method, wrap.alone, {span}});
    }
  }
  if (parts.size() <= kMostWraps) path.wraps = std::move(parts);
}

void MusclePaths::compile_path(int muscle) {
  Path& path = muscles_[muscle];
  const bool conditional =
      std::any_of(path.stations.begin(), path.stations.end(), [](const PathStation& s) { return s.condition >= 0; });
  const auto share = [&](std::size_t i, std::size_t j) {
    return path.wraps[i].first < path.wraps[j].last && path.wraps[j].first < path.wraps[i].last;
  };
  for (std::size_t i = 0; i < path.wraps.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (share(i, j)) path.wraps[i].alone = path.wraps[j].alone = false;
  if (!conditional) {
    list_spans(path);
    if (mode_ == WrapMode::kTaut) part_wraps(path);
  }
  for (std::size_t i = 0; i < path.wraps.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (share(i, j)) path.coupled = true;
  for (std::size_t i = 0; i + 1 < path.stations.size(); ++i) {
    const Point& pa = points_[path.stations[i].point];
    const Point& pb = points_[path.stations[i + 1].point];
    const bool fixed = pa.link == pb.link && pa.moving < 0 && pb.moving < 0;
    path.fixed.push_back(fixed ? (pb.location - pa.location).norm() : -1.0);
  }
  most_stations_ = std::max(most_stations_, path.stations.size());
  most_wraps_ = std::max(most_wraps_, path.wraps.size());
  path.pairs[0] = pairs_.size();
  for (const int c : coordinates_of(path)) pairs_.push_back({muscle, c});
  path.pairs[1] = pairs_.size();
  compile_straight(muscle);
}

void MusclePaths::compile_straight(int muscle) {
  const Path& path = muscles_[muscle];
  std::vector<Condition> conditions;
  std::vector<std::size_t> condition_of;
  for (const PathStation& s : path.stations) {
    const auto same = std::find_if(conditions.begin(), conditions.end(), [&](const Condition& c) {
      return c.coordinate == s.condition && c.low == s.low && c.high == s.high;
    });
    condition_of.push_back(static_cast<std::size_t>(same - conditions.begin()));
    if (s.condition >= 0 && same == conditions.end()) conditions.push_back({s.condition, s.low, s.high});
  }
  if (!path.wraps.empty() || conditions.size() > kMostConditions) {
    general_.push_back(muscle);
    return;
  }
  StraightPath straight{muscle, conditions_.size(), conditions_.size() + conditions.size(), variants_.size()};
  conditions_.insert(conditions_.end(), conditions.begin(), conditions.end());
  for (unsigned held = 0; held < 1u << conditions.size(); ++held) {
    Variant variant{0.0, variant_segments_.size(), 0, variant_adds_.size(), 0};
    int a = -1;
    for (std::size_t i = 0; i < path.stations.size(); ++i) {
      const PathStation& station = path.stations[i];
      if (station.condition >= 0 && (held >> condition_of[i] & 1u) == 0) continue;
      const int b = station.point;
      if (a >= 0) {
        const Point& pa = points_[a];
        const Point& pb = points_[b];
        if (pa.link == pb.link && pa.moving < 0 && pb.moving < 0) {
          variant.constant += (pb.location - pa.location).norm();
        } else {
          const int s = segment(a, b);
          variant_segments_.push_back(s);
          const Segment& compiled = segments_[s];
          for (std::size_t t = compiled.terms[0]; t < compiled.terms[1]; ++t)
            for (std::size_t k = path.pairs[0]; k < path.pairs[1]; ++k)
              if (pairs_[k].coordinate == terms_[t].coordinate)
                variant_adds_.push_back({static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(k)});
        }
      }
      a = b;
    }
    variant.end_segments = variant_segments_.size();
    variant.end_adds = variant_adds_.size();
    variants_.push_back(variant);
  }
  straight_.push_back(straight);
}

void MusclePaths::sort_segments() {
  const auto links = [&](const Segment& s) {
    const Point& a = points_[s.a];
    const Point& b = points_[s.b];
    return std::tuple{a.moving >= 0 || b.moving >= 0, a.link, b.link};
  };
  std::vector<std::size_t> order(segments_.size()), place(segments_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return links(segments_[i]) < links(segments_[j]); });
  std::vector<Segment> sorted;
  const auto fixed_end = [&](int p, int q) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      end_a_[axis].push_back(p < 0 ? 0.0 : points_[p].location[axis]);
      end_b_[axis].push_back(q < 0 ? 1.0 : points_[q].location[axis]);
    }
  };
  const auto fill_up = [&] {
    if (link_pairs_.empty()) return;
    for (; sorted.size() % kLanes != 0; sorted.push_back({-1, -1, {}})) fixed_end(-1, -1);
    link_pairs_.back().end = sorted.size();
  };
  for (const std::size_t i : order) {
    const Segment& s = segments_[i];
    const auto [moving, a, b] = links(s);
    if (moving || link_pairs_.empty() || link_pairs_.back().a != a || link_pairs_.back().b != b) {
      if (end_a_[0].size() == sorted.size()) fill_up();
      if (!moving) {
        LinkPair pair{a, b, sorted.size(), sorted.size(), 0, {}, {}};
        for (std::size_t t = s.terms[0]; t < s.terms[1]; ++t) {
          pair.coordinates.push_back(terms_[t].coordinate);
          pair.signs.push_back(terms_[t].sign);
        }
        most_pair_coordinates_ = std::max(most_pair_coordinates_, pair.coordinates.size());
        link_pairs_.push_back(pair);
      }
    }
    place[i] = sorted.size();
    if (!moving) fixed_end(s.a, s.b);
    sorted.push_back(s);
  }
  if (end_a_[0].size() == sorted.size()) fill_up();
  segments_ = sorted;
  for (int& s : variant_segments_) s = static_cast<int>(place[s]);
  sort_terms();
}

/// Terms in the order in which they are computed: of link pairs by coordinate and segment, then those of moving points.
void MusclePaths::sort_terms() {
  std::vector<std::size_t> place(terms_.size());
  std::vector<Term> sorted;
  for (LinkPair& pair : link_pairs_) {
    pair.terms = sorted.size();
    for (std::size_t j = 0; j < pair.coordinates.size(); ++j) {
      for (std::size_t i = pair.first; i < pair.end; ++i) {
        const Segment& s = segments_[i];
        if (s.a >= 0) place[s.terms[0] + j] = sorted.size();
        sorted.push_back(s.a >= 0 ? terms_[s.terms[0] + j] : Term{});
      }
    }
  }
  for (std::size_t i = link_pairs_.empty() ? 0 : link_pairs_.back().end; i < segments_.size(); ++i) {
    Segment& s = segments_[i];
    const std::size_t first = sorted.size();
    for (std::size_t t = s.terms[0]; t < s.terms[1]; ++t) {
      place[t] = sorted.size();
      sorted.push_back(terms_[t]);
    }
    s.terms = {first, sorted.size()};
  }
  terms_ = sorted;
  for (Add& add : variant_adds_) add.term = static_cast<std::uint32_t>(place[add.term]);
}

void MusclePaths::list_points() {
  std::set<int> needed;
  for (const int m : general_)
    for (const PathStation& s : muscles_[m].stations) needed.insert(s.point);
  for (std::size_t i = link_pairs_.empty() ? 0 : link_pairs_.back().end; i < segments_.size(); ++i)
    needed.insert({segments_[i].a, segments_[i].b});
  // Points fixed to the ground stay where they are; moving ones are placed separately.
  std::copy_if(needed.begin(), needed.end(), std::back_inserter(points_in_ground_),
               [&](int p) { return points_[p].link != 0 && points_[p].moving < 0; });
}

}  // namespace veridyn::muscle
