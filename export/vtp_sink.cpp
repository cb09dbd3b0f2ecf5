#include "export/vtp_sink.h"

#include <cstdint>
#include <fmt/format.h>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "core/atomic_file.h"
#include "core/xml_writer.h"
#include "export/build_check.h"
#include "export/image_folder.h"
#include "export/material_contours.h"
#include "export/row_tracks.h"
#include "export/vtk_array.h"
#include "slicing/rotation_words.h"

namespace lamella {

namespace {

namespace fs = std::filesystem;

enum class LineKind : std::uint8_t { segment = 0, contour = 1 };

/// Lines of one layer as VTK has them: line i has the points connectivity[offsets[i - 1]] to [offsets[i]].
struct Lines {
  double z = 0.0;
  std::vector<double> points;  ///< x, y, z, x, ...
  std::vector<std::int64_t> connectivity;
  std::vector<std::int64_t> offsets;
  std::vector<std::int32_t> material;
  std::vector<std::int32_t> solid;  ///< -1 for contours: a material's may be of several solids
  std::vector<std::uint8_t> kind;

  [[nodiscard]] std::int64_t point_count() const { return static_cast<std::int64_t>(points.size() / 3); }

  void add_point(const Vec2& point) {
    connectivity.push_back(point_count());
    points.insert(points.end(), {point.x(), point.y(), z});
  }
  void end_line(MaterialId of_material, std::int32_t of_solid, LineKind of_kind) {
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    material.push_back(static_cast<std::int32_t>(of_material.value()));
    solid.push_back(of_solid);
    kind.push_back(static_cast<std::uint8_t>(of_kind));
  }
};

void add_segments(const Layer& layer, const LayerPlan& plan, Lines& lines) {
  const RowFrame frame = tracked_frame(layer, plan);
  const SegmentRows& rows = tracked_rows(layer);
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    for (const Segment& segment : rows.row(r)) {
      lines.add_point(frame.at(r, segment.x_begin));
      lines.add_point(frame.at(r, segment.x_end));
      lines.end_line(segment.material, static_cast<std::int32_t>(segment.solid.value()), LineKind::segment);
    }
  }
}

void add_contours(const MaterialContours& contours, Lines& lines) {
  for (const MaterialId material : contours.ids()) {
    for (const MaterialLoop& loop : contours[material]) {
      const std::int64_t first = lines.point_count();
      for (const Vec2& point : loop.points) lines.add_point(point);
      lines.connectivity.push_back(first);
      lines.end_line(material, -1, LineKind::contour);
    }
  }
}

template <class T>
void write_array(XmlWriter& xml, const char* type, const char* name, const std::vector<T>& values, int components) {
  xml.start("DataArray").attribute("type", type).attribute("Name", name);
  xml.attribute("NumberOfComponents", components).attribute("format", "binary");
  xml.plain_text(vtk_text(std::as_bytes(std::span(values)))).end();
}

void write_lines(XmlWriter& xml, const Lines& lines) {
  xml.start("Piece").attribute("NumberOfPoints", lines.point_count()).attribute("NumberOfVerts", 0);
  xml.attribute("NumberOfLines", lines.offsets.size()).attribute("NumberOfStrips", 0).attribute("NumberOfPolys", 0);
  xml.start("CellData").attribute("Scalars", "material");
  write_array(xml, "Int32", "material", lines.material, 1);
  write_array(xml, "Int32", "solid", lines.solid, 1);
  write_array(xml, "UInt8", "kind", lines.kind, 1);
  xml.end();
  xml.start("Points");
  write_array(xml, "Float64", "points", lines.points, 3);
  xml.end();
  xml.start("Lines");
  write_array(xml, "Int64", "connectivity", lines.connectivity, 1);
  write_array(xml, "Int64", "offsets", lines.offsets, 1);
  xml.end().end();
}

class VtpSink final : public LayerSink {
 public:
  explicit VtpSink(fs::path folder) : root_(folder), folder_(std::move(folder), {.extension = ".vtp"}) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    if (info.plan.chord_error) combiner_.emplace(info, "vtp");
    info_ = info;
    for (const Material& material : info.materials) material_names_.push_back(material.name);
    for (const BuildSolid& solid : info.solids) solid_paths_.push_back(solid.path);
    folder_.open(info);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    folder_.write_image(layer.index, 0, file_of(layer));
    return [this, &layer] {
      folder_.add_layer(layer.index, {layer.z_bottom, layer.z_sample, layer.z_top});
      written_.emplace_back(layer.index, layer.z_sample);
    };
  }

  void finish(const SliceReport&) override {
    write_file_atomically(root_ / "layers.pvd", series());
    folder_.close();
  }

  void abandon() noexcept override { folder_.abandon(); }

 private:
  [[nodiscard]] std::string file_of(const Layer& layer) const {
    Lines lines;
    lines.z = layer.z_sample;
    add_segments(layer, info_.plan, lines);
    if (combiner_) add_contours(combiner_->combine(*layer.contours), lines);
    std::ostringstream text;
    XmlWriter xml(text);
    xml.start("VTKFile").attribute("type", "PolyData").attribute("version", "1.0");
    xml.attribute("byte_order", "LittleEndian").attribute("header_type", "UInt64");
    xml.attribute("compressor", "vtkZLibDataCompressor").start("PolyData");
    xml.start("FieldData");
    write_names(xml, "material_names", material_names_);
    write_names(xml, "solid_paths", solid_paths_);
    if (info_.turn) {
      xml.start("DataArray").attribute("type", "Float64").attribute("Name", "rotation");
      xml.attribute("NumberOfComponents", 9).attribute("NumberOfTuples", 1).attribute("format", "ascii");
      xml.plain_text(rotation_text(*info_.turn)).end();
    }
    xml.end();
    write_lines(xml, lines);
    xml.end().end();
    return std::move(text).str();
  }

  static void write_names(XmlWriter& xml, const char* name, const std::vector<std::string>& names) {
    xml.start("DataArray").attribute("type", "String").attribute("Name", name);
    xml.attribute("NumberOfTuples", names.size()).attribute("format", "ascii");
    xml.plain_text(vtk_text_of_names(names)).end();
  }

  /// The height stands for the time, so that a viewer's time slider goes up through the layers.
  [[nodiscard]] std::string series() const {
    std::ostringstream text;
    XmlWriter xml(text);
    xml.start("VTKFile").attribute("type", "Collection").attribute("version", "0.1").start("Collection");
    for (const auto& [index, z] : written_) {
      xml.start("DataSet").attribute("timestep", z).attribute("part", 0);
      xml.attribute("file", fmt::format("layer_{:06}.vtp", index)).end();
    }
    xml.end().end();
    return std::move(text).str();
  }

  fs::path root_;
  ImageFolder folder_;
  BuildInfo info_;
  std::optional<ContourCombiner> combiner_;
  std::vector<std::string> material_names_;
  std::vector<std::string> solid_paths_;
  std::vector<std::pair<std::uint32_t, double>> written_;  ///< index and height
};

}  // namespace

std::unique_ptr<LayerSink> make_vtp_sink(const fs::path& folder) { return std::make_unique<VtpSink>(folder); }

}  // namespace lamella
