#pragma once

#include <TopoDS_Shape.hxx>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// STEP files made with OpenCASCADE, and edits of their text.
namespace lamella::test {

/// One component of an assembly.
struct Component {
  TopoDS_Shape shape;  ///< its location places the instance; equal shapes share one part
  std::string name;
};

/// Writes an assembly "assembly" of the components, or their single shape when there is one, in millimetres.
void write_step(const std::filesystem::path& path, const std::vector<Component>& components);

struct PartMaterial {
  std::string name;
  double density = 0.0;  ///< g/cm^3
};
/// Writes one part with colour (sRGB), layer and material.
void write_part(const std::filesystem::path& path, const TopoDS_Shape& shape, const std::string& name,
                const std::vector<double>& rgb, const std::string& layer, const PartMaterial& material);

[[nodiscard]] std::string read_text(const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, const std::string& text);

/// `text` with every `from` replaced; at least one must be there.
[[nodiscard]] std::string replaced(std::string text, const std::string& from, const std::string& to);

}  // namespace lamella::test
