#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/osim/osim_element.hpp"

/// What the parts of the reader share. Not for others.
namespace veridyn::muscle::osim {

/// A frame of the file: a body and where the frame stands in it.
struct FrameReference {
  int body = 0;
  Placement placement;
};

/// What an object of a file is part of: the set that holds such objects, or what may stand among a model's components
/// without changing its motion.
enum class PartOf {
  kBodySet,
  kJointSet,
  kConstraintSet,
  kForceSet,
  kContactGeometrySet,
  kMarkerSet,
  kNothing,
  kUnknown
};

/// By the name of the object's type.
[[nodiscard]] PartOf part_of(std::string_view type);

/// What scripts added to the model or to its parts: `<components>` and ComponentSet.
[[nodiscard]] std::vector<Element> components_of(const Document& document);

/// View of a document, which must outlive it, and the model as far as it has been read.
struct Context {
  const Document& document;
  Model model;
  /// Every PhysicalOffsetFrame and StationDefinedFrame of the file, every Station and Marker.
  std::vector<Element> frames, stations;
  /// `components_of` the document.
  std::vector<Element> components;

  /// The objects of a set, and those of its kind among the components.
  [[nodiscard]] std::vector<Element> members(PartOf set) const;
  /// Index of a body by name or component path. @throws InputError naming the nearest body.
  [[nodiscard]] int body(const Element& user, const char* property, std::string_view reference) const;
  [[nodiscard]] int coordinate(const Element& user, const char* property, std::string_view reference) const;
  /// The frame that `reference` means to `user`: ground, a body, or a frame fixed to one, those of `user` first.
  /// `depth`: by how many frames it was come to.
  [[nodiscard]] FrameReference frame(const Element& user, const char* property, std::string_view reference,
                                     std::size_t depth = 0) const;
  /// The frame that a point is fixed to; the ground, with a warning, where its file names none.
  [[nodiscard]] FrameReference frame_or_ground(const Element& point);
  /// The body that an offset frame with an empty socket stands in, as OpenSim names such frames: that which owns it, or
  /// "pelvis" of "pelvis_offset". Empty: unknown.
  [[nodiscard]] std::string parent_by_name(const Element& offset_frame) const;
  /// Adds to the model's warnings or to its unsupported elements.
  void warn(const Element& element, std::string_view what);
  void unsupported(const Element& element, bool changes_motion);
};

/// A frame in another one by two properties: a translation [m] and angles of a body-fixed x-y-z sequence [rad].
[[nodiscard]] Placement read_placement(const Element& element, const char* translation, const char* orientation);

/// Of bodies or coordinates, for suggestions.
template <typename List>
[[nodiscard]] std::vector<std::string> names_of(const List& list) {
  std::vector<std::string> names;
  for (const auto& item : list) names.push_back(item.name);
  return names;
}

/// What a socket is connected to: `socket_NAME`, `socket_NAME_connectee_name` or a Connector element.
[[nodiscard]] std::string socket(const Element& user, const char* name);

/// Reads the document's bodies into the model. @throws InputError with file, line and element.
void read_bodies(Context& context);
/// Reads the document's wrap objects into the model. @throws InputError with file, line and element.
void read_wrap_objects(Context& context);
/// Reads the document's joints into the model. @throws InputError with file, line and element.
void read_joints(Context& context);
/// Reads the document's constraints into the model. @throws InputError with file, line and element.
void read_constraints(Context& context);
/// Makes rates of the default speeds, as OpenSim counts them, at the default pose.
void read_default_speeds(Context& context);
/// Reads the document's forces into the model. @throws InputError with file, line and element.
void read_forces(Context& context);
/// Reads the document's markers into the model. @throws InputError with file, line and element.
void read_markers(Context& context);

/// Everything but the curves and the path of a Muscle element.
[[nodiscard]] bool is_muscle(std::string_view type);
/// A Schutte1993Muscle by either of its names.
[[nodiscard]] bool is_schutte(std::string_view type);
/// Reads a muscle of the set of forces. @throws InputError with file, line and element.
void read_muscle(Context& context, const Element& element);

/// Reads the path of a muscle or of another force along one: points and wraps, or a function of coordinates.
/// @throws InputError with file, line and element.
void read_path(Context& context, const Element& element, std::vector<PathPoint>& points, std::vector<PathWrap>& wraps,
               std::optional<PathFunction>& function);
/// The path that a FunctionBasedPath of `owner` gives; nothing when there is none. @throws InputError with file, line
/// and element.
[[nodiscard]] std::optional<PathFunction> read_path_function(Context& context, const Element& owner);
/// Reads a force that needs no control. False: it is none that is understood. @throws InputError with file, line and
/// element.
[[nodiscard]] bool read_passive_force(Context& context, const Element& element);

}  // namespace veridyn::muscle::osim
