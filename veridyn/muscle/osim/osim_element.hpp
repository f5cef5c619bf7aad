#pragma once

#include <Eigen/Core>
#include <pugixml.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Typed access to the properties of an .osim document, shared by the parts of the reader and by the writer.
namespace veridyn::muscle::osim {

/// The text of a file and the tree parsed from it. Offsets of the tree point into the text, which stays as it was:
/// errors name lines, and writing back replaces single numbers.
class Document {
 public:
  /// @throws InputError with line when the text is not XML or has no OpenSimDocument with a Model (or another object,
  /// `type`).
  Document(std::string text, std::string name, const char* type = "Model");
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] int version() const { return version_; }
  /// The Model, or what object the document was opened for.
  [[nodiscard]] pugi::xml_node model() const { return model_; }
  /// Node of `<defaults>` for objects of this type; empty when there is none.
  [[nodiscard]] pugi::xml_node defaults(const char* type) const;
  /// "arm26.osim:120: Thelen2003Muscle 'TRIlong'"
  [[nodiscard]] std::string place(pugi::xml_node node) const;

 private:
  std::string text_;
  std::string name_;
  std::string parsed_;  ///< pugixml parses in place
  pugi::xml_document tree_;
  pugi::xml_node model_;
  pugi::xml_node defaults_;
  int version_ = 0;
};

/// View of one object of a document, which must outlive it. A property that the object does not have is looked up in
/// the defaults of its type.
class Element {
 public:
  Element(const Document& document, pugi::xml_node node) : document_(&document), node_(node) {}

  [[nodiscard]] explicit operator bool() const { return !node_.empty(); }
  [[nodiscard]] const Document& document() const { return *document_; }
  [[nodiscard]] pugi::xml_node node() const { return node_; }
  [[nodiscard]] std::string type() const { return node_.name(); }
  [[nodiscard]] std::string name() const { return node_.attribute("name").value(); }
  [[nodiscard]] std::string place() const { return document_->place(node_); }
  /// Throws InputError "place: property: what".
  [[noreturn]] void fail(std::string_view property, std::string_view what) const;

  /// The property's node, of the object or of its type's defaults; may be empty.
  [[nodiscard]] pugi::xml_node property(const char* name) const;
  [[nodiscard]] bool has(const char* name) const { return !property(name).empty(); }
  [[nodiscard]] std::string text_or(const char* name, std::string_view otherwise) const;
  /// Words separated by blanks.
  [[nodiscard]] std::vector<std::string> words(const char* name) const;
  [[nodiscard]] bool flag_or(const char* name, bool otherwise) const;
  /// A finite number.
  [[nodiscard]] double number_or(const char* name, double otherwise) const;
  /// A finite number >= 0, or > 0.
  [[nodiscard]] double not_negative_or(const char* name, double otherwise) const;
  [[nodiscard]] double positive_or(const char* name, double otherwise) const;
  /// Finite numbers; empty when the property is absent.
  [[nodiscard]] std::vector<double> numbers(const char* name) const;
  [[nodiscard]] Eigen::Vector3d vector_or(const char* name, const Eigen::Vector3d& otherwise) const;
  /// A child object, as `<name>` itself or within a property `<name>`; may be empty.
  [[nodiscard]] Element child(const char* name) const { return {*document_, property(name)}; }
  /// Objects of a set, `<set><objects>...` or `<set>...` directly.
  [[nodiscard]] std::vector<Element> objects(const char* set) const;

 private:
  const Document* document_;
  pugi::xml_node node_;
};

/// A damaged file's text for a message: what is not printable ASCII becomes '?'.
[[nodiscard]] std::string one_line(std::string text);

/// Last part of a component path: "/bodyset/r_humerus" gives "r_humerus".
[[nodiscard]] std::string last_part(std::string_view path);

}  // namespace veridyn::muscle::osim
