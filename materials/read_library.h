#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/xml.h"
#include "materials/material_rules.h"

namespace lamella {

/// Reads a <library> and the libraries that it includes into MaterialRules.
class LibraryReader {
 public:
  /// `file` is what `href` attributes are relative to.
  LibraryReader(MaterialRules& rules, const std::filesystem::path& file);

  /// Appends the materials, in the order in which they stand, with what they match.
  void read(const XmlElement& library);

  [[nodiscard]] bool contains(const std::string& name) const { return places_.contains(name); }

 private:
  void read_include(const XmlElement& element);
  void read_material(const XmlElement& element);
  void read_graded_material(const XmlElement& element);
  void add_material(const XmlElement& element, Material material);
  void read_match(const XmlElement& element, std::size_t material);
  static void read_layers(const XmlElement& element, ThicknessLimits& layers);
  void match_own_name(const XmlElement& element, std::size_t material);

  MaterialRules& rules_;
  std::vector<std::filesystem::path> open_;    ///< the file that is read, behind those that include it
  std::set<std::filesystem::path> included_;   ///< files so far
  std::map<std::string, std::string> places_;  ///< where each material is defined
};

}  // namespace lamella
