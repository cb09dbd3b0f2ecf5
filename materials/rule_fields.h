#pragma once

#include <optional>
#include <string>

#include "core/xml.h"
#include "model/scene.h"

namespace lamella {

// Attributes that the files about materials and machines share. All throw InputError with file, line and hint.

/// A name on one line, without blanks at its ends.
[[nodiscard]] std::string read_name(const XmlElement& element, const char* attribute);

/// `priority`, -1000000 to 1000000, or `fallback`.
[[nodiscard]] int read_priority(const XmlElement& element, int fallback);

/// `color`, #rrggbb.
[[nodiscard]] Color read_color(const XmlElement& element);

/// `density`, g/cm^3, more than 0 and at most kMaxDensity.
[[nodiscard]] double read_density(const XmlElement& element);

/// A thickness or a deviation of layers, mm, more than 0 and at most 1000; nothing where there is no such attribute.
[[nodiscard]] std::optional<double> read_thickness(const XmlElement& element, const char* attribute);

/// Refuses a least thickness (`layer_min`) above the largest (`layer_max`).
void check_thicknesses(const XmlElement& element, const std::optional<double>& least,
                       const std::optional<double>& most);

/// A pattern that matches_glob() takes, not empty.
[[nodiscard]] std::string read_glob(const XmlElement& element, const char* attribute);

/// Refuses text between an element's tags.
void refuse_text(const XmlElement& element);

/// The root of a materials file: namespace and version 1.x.
void check_materials_head(const XmlElement& root);

}  // namespace lamella
