#pragma once

#include <TopoDS_Shape.hxx>

/// Sections by OpenCASCADE: nothing of our own slicing.
namespace lamella::test {

struct OcctSection {
  double area = 0.0;      ///< mm^2
  double length = 0.0;    ///< mm, of its border
  bool is_whole = false;  ///< every edge belongs to a face, and they close
};

/// The section of a solid at a height. BRepAlgoAPI_Section finds its edges and of what faces they are. Points along
/// each are moved into both plane and surface by Newton's method; the border's integral of (x dy - y dx) / 2 is
/// extrapolated from polygons of ever more sides. The face's outward normal tells the edge's sense. Ends of edges
/// within `gap` mm are joined by straight lines.
[[nodiscard]] OcctSection occt_section(const TopoDS_Shape& solid, double z, double gap = 1e-4);

}  // namespace lamella::test
