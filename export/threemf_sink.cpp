#include "export/threemf_sink.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/xml.h"
#include "export/build_check.h"
#include "export/decimal.h"
#include "export/output_file.h"
#include "export/package_file.h"
#include "export/prism_mesh.h"
#include "export/scratch_file.h"

namespace lamella {

namespace fs = std::filesystem;

namespace {

constexpr const char* kTypes =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
)";
constexpr const char* kRelationships =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
)";
constexpr const char* kModelBegin =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:s="http://schemas.microsoft.com/3dmanufacturing/slice/2015/07" requiredextensions="s">
<metadata name="Application">Lamella</metadata>
<resources>
)";

/// The mesh shows this many blocks of layers at most: it is for looking, the slices are for building.
constexpr std::size_t kMostBlocks = 64;

constexpr int kMaterialsId = 1;

std::string decimal(double length) {
  std::string text;
  append_decimal(text, length);
  return text;
}

/// What goes into one material's object.
struct MaterialPart {
  explicit MaterialPart(const fs::path& beside) : slices(beside) {}

  ScratchFile slices;
  PrismMesh mesh;
  std::vector<MaterialLoop> fullest;  ///< of the layers of a block the one with most of the material
  double area = 0.0;                  ///< mm^2, of the fullest
};

void append_polygon(const MaterialLoop& loop, std::size_t first, std::size_t material, std::string& out) {
  out += fmt::format("<s:polygon startv=\"{}\">", first);
  for (std::size_t i = 0; i < loop.points.size(); ++i) {
    const std::size_t to = first + (i + 1) % loop.points.size();
    out += fmt::format("<s:segment v2=\"{}\" p1=\"{}\" p2=\"{}\" pid=\"{}\"/>", to, material, material, kMaterialsId);
  }
  out += "</s:polygon>";
}

/// Readers want an empty slice to hold nothing.
std::string slice_text(const std::vector<MaterialLoop>& loops, double z_top, MaterialId material) {
  std::string out = "<s:slice ztop=\"" + decimal(z_top) + "\"";
  if (loops.empty()) return out + "/>\n";
  out += "><s:vertices>";
  for (const MaterialLoop& loop : loops) {
    for (const Vec2& point : loop.points) {
      out += "<s:vertex x=\"";
      append_decimal(out, point.x());
      out += "\" y=\"";
      append_decimal(out, point.y());
      out += "\"/>";
    }
  }
  out += "</s:vertices>";
  std::size_t first = 0;
  for (const MaterialLoop& loop : loops) {
    append_polygon(loop, first, material.value(), out);
    first += loop.points.size();
  }
  return out + "</s:slice>\n";
}

void write_mesh(const PrismMesh& mesh, std::ostream& out) {
  out << "<mesh><vertices>\n";
  for (const Vec3& point : mesh.points) {
    out << "<vertex x=\"" << decimal(point.x()) << "\" y=\"" << decimal(point.y()) << "\" z=\"" << decimal(point.z())
        << "\"/>\n";
  }
  out << "</vertices><triangles>\n";
  for (const auto& [a, b, c] : mesh.triangles)
    out << fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>\n", a, b, c);
  out << "</triangles></mesh>";
}

class ThreemfSink final : public LayerSink {
 public:
  explicit ThreemfSink(fs::path file) : path_(std::move(file)) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    combiner_.emplace(info, "3mf");
    info_ = info;
    block_layers_ = (info.plan.layers.size() + kMostBlocks - 1) / kMostBlocks;
    prepare_target(path_);
    for (std::size_t i = 0; i < info.materials.size(); ++i) parts_.emplace_back(path_);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    MaterialContours contours = combiner_->combine(*layer.contours);
    std::vector<std::string> texts;
    for (const MaterialId material : contours.ids())
      texts.push_back(slice_text(contours[material], layer.z_top, material));
    return [this, &layer, contours = std::move(contours), texts = std::move(texts)] { add(layer, contours, texts); };
  }

  void finish(const SliceReport&) override {
    end_block();
    ScratchFile model(path_);
    write_model(model.stream());
    model.close();
    write_package(path_, {{{"[Content_Types].xml", kTypes}, {"_rels/.rels", kRelationships}},
                          {{"3D/3dmodel.model", model.path()}}});
  }

 private:
  void add(const Layer& layer, const MaterialContours& contours, const std::vector<std::string>& texts) {
    const std::size_t block = layer.index / block_layers_;
    if (!block_ || *block_ != block) {
      end_block();
      block_bottom_ = layer.z_bottom;
      if (!block_) z_bottom_ = layer.z_bottom;
    }
    block_ = block;
    block_top_ = layer.z_top;
    for (std::size_t m = 0; m < parts_.size(); ++m) {
      MaterialPart& part = parts_[m];
      part.slices.stream() << texts[m];
      part.slices.check();
      double area = 0.0;
      for (const MaterialLoop& loop : contours[MaterialId{m}]) area += loop.area;
      if (!(area > part.area)) continue;
      part.area = area;
      part.fullest = contours[MaterialId{m}];
    }
  }

  void end_block() {
    for (MaterialPart& part : parts_) {
      part.mesh.add(part.fullest, block_bottom_, block_top_);
      part.fullest.clear();
      part.area = 0.0;
    }
  }

  void write_model(std::ostream& out) {
    out << kModelBegin << "<basematerials id=\"" << kMaterialsId << "\">";
    for (const Material& material : info_.materials) {
      out << "<base name=\"" << xml_escape(material.name) << "\" displaycolor=\"#";
      for (const double channel : material.color)
        out << fmt::format("{:02X}", std::lround(std::clamp(channel, 0.0, 1.0) * 255.0));
      out << "FF\"/>";
    }
    out << "</basematerials>\n";
    for (std::size_t m = 0; m < parts_.size(); ++m) write_object(m, out);
    out << "</resources>\n<build>";
    for (std::size_t m = 0; m < parts_.size(); ++m) {
      if (!parts_[m].mesh.triangles.empty()) out << "<item objectid=\"" << object_id(m) << "\"/>";
    }
    out << "</build>\n</model>\n";
  }

  /// A material that no layer shows has no object: meshes mustn't be empty.
  void write_object(std::size_t m, std::ostream& out) {
    MaterialPart& part = parts_[m];
    if (part.mesh.triangles.empty()) return;
    out << "<s:slicestack id=\"" << object_id(m) - 1 << "\" zbottom=\"" << decimal(z_bottom_) << "\">\n";
    part.slices.close();
    part.slices.append_to(out);
    out << "</s:slicestack>\n<object id=\"" << object_id(m) << "\" type=\"model\" pid=\"" << kMaterialsId
        << "\" pindex=\"" << m << "\" name=\"" << xml_escape(info_.materials[MaterialId{m}].name)
        << "\" s:slicestackid=\"" << object_id(m) - 1 << "\" s:meshresolution=\"lowres\">";
    write_mesh(part.mesh, out);
    out << "</object>\n";
  }

  static std::size_t object_id(std::size_t material) { return 2 * material + 3; }

  fs::path path_;
  BuildInfo info_;
  std::optional<ContourCombiner> combiner_;
  std::deque<MaterialPart> parts_;
  std::size_t block_layers_ = 1;
  std::optional<std::size_t> block_;  ///< the one that layers are added to
  double z_bottom_ = 0.0;
  double block_bottom_ = 0.0;
  double block_top_ = 0.0;
};

}  // namespace

std::unique_ptr<LayerSink> make_3mf_sink(const fs::path& file) { return std::make_unique<ThreemfSink>(file); }

}  // namespace lamella
