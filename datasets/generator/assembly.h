#pragma once

#include <TopoDS_Shape.hxx>
#include <array>
#include <gp_Trsf.hxx>
#include <string>
#include <vector>

/// What a data set is: parts with a known volume, placed in a tree.
namespace lamella::datasets {

using Rgb = std::array<double, 3>;  ///< sRGB, 0 to 1

struct PartMaterial {
  std::string name;
  double density = 0.0;  ///< g/cm^3
  Rgb color{0.5, 0.5, 0.5};
  int priority = 0;  ///< who wins where bodies overlap
};

/// A volume known without OpenCASCADE.
struct Truth {
  double value = 0.0;    ///< mm^3
  std::string method;    ///< how it was obtained
  double bound = 1e-13;  ///< relative error of `value` against the shape in the file
};

/// One product with one body.
struct Part {
  std::string name;  ///< UTF-8
  TopoDS_Shape shape;
  PartMaterial material;
  Truth volume;
};

/// An instance of a part or of a shared assembly, or an assembly of further instances.
struct Node {
  std::string name;
  int part = -1;
  gp_Trsf placement;
  std::vector<Node> children;
  int shared = -1;  ///< an index into DataSet::shared
};

/// Common volume of two solids, counted in the order of the assembly walk.
struct Overlap {
  std::size_t first = 0, second = 0;
  Truth volume;
};

/// An instance that is placed by a mirror image in x and then a shift, in mm.
struct Mirror {
  std::string instance;
  std::array<double, 3> shift;
};

struct DataSet {
  std::string name;
  std::string description;
  std::string unit = "mm";  ///< of the STEP file: "mm" or "inch"; shapes here are always mm
  std::vector<Part> parts;
  Node root;
  std::vector<Overlap> overlaps;
  std::vector<Mirror> mirrored{};
  std::vector<Node> shared{};  ///< assemblies that are written once and placed many times; their placement isn't used

  /// Adds a part and one instance of it under the root; returns the part's index.
  int add(Part part);
  /// Adds a part without an instance.
  int define(Part part);
};

/// "#rrggbb"
[[nodiscard]] std::string hex(const Rgb& color);

/// A solid of the data set: a part where the assembly puts it.
struct PlacedPart {
  int part = -1;
  gp_Trsf placement;  ///< from the part's frame to that of the file, mirrors included
};

/// Every solid in the order of the assembly walk.
[[nodiscard]] std::vector<PlacedPart> placed_parts(const DataSet& set);

/// Part index of each solid in the order of the assembly walk.
[[nodiscard]] std::vector<int> walk(const DataSet& set);

}  // namespace lamella::datasets
