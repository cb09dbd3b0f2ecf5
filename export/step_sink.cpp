#include "export/step_sink.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/xml.h"
#include "export/build_check.h"
#include "export/follow_curves.h"
#include "export/material_contours.h"
#include "export/output_file.h"
#include "export/step_curves.h"
#include "export/step_entities.h"

namespace lamella {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSchema = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }";

/// mm; corners of contours are exact to less, and programs may unite points that are nearer.
constexpr const char* kUncertainty = "1.E-6";

/// What entities of a material are known by, and what waits for the end of the file.
struct MaterialEntities {
  StepId style = 0;
  std::vector<StepId> curve_sets;
};

/// Entities that all others share.
struct SharedEntities {
  StepId application = 0;
  StepId product_context = 0;
  StepId definition_context = 0;
  StepId gram = 0;
  StepId centimetre = 0;
  StepId geometry_context = 0;
  StepId placement = 0;
  StepId font = 0;
};

class StepSink final : public LayerSink {
 public:
  StepSink(fs::path file, const StepLayersOptions& options) : path_(std::move(file)), options_(options) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    combiner_.emplace(info, "step");
    if (options_.hatches && !info.plan.hatch) {
      throw UsageError("hatch rows in a STEP file need a build with hatch rows", {}, "slice with --hatch-spacing");
    }
    info_ = info;
    file_.emplace(path_);
    write_header();
    entities_.emplace(file_->stream());
    write_shared();
    for (const MaterialId material : info.materials.ids()) write_style(material);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    MaterialContours contours = combiner_->combine(*layer.contours);
    MaterialCurves curves(info_.plan.curves ? contours.size() : 0);
    if (info_.plan.curves) {
      const CurveFollower follower(*layer.contours, *info_.plan.chord_error);
      for (const MaterialId material : contours.ids()) {
        for (const MaterialLoop& loop : contours[material]) curves[material].push_back(follower.follow(loop));
      }
    }
    return [this, &layer, contours = std::move(contours), curves = std::move(curves)] {
      write_layer(layer, contours, curves);
    };
  }

  void finish(const SliceReport&) override {
    std::vector<StepId> products;
    for (const MaterialId material : info_.materials.ids()) {
      if (!materials_[material].curve_sets.empty()) products.push_back(write_product(material));
    }
    if (!products.empty()) add("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$," + step_list(products) + ")");
    if (!styled_.empty()) {
      add("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION(''," + step_list(styled_) + "," +
          step_reference(shared_.geometry_context) + ")");
    }
    file_->stream() << "ENDSEC;\nEND-ISO-10303-21;\n";
    file_->commit();
  }

 private:
  /// By loop of the material's contours; none where the build keeps no curves.
  using MaterialCurves = IdVector<MaterialId, std::vector<std::vector<CurveStretch>>>;

  StepId add(std::string_view text) { return entities_->add(text); }

  void write_header() {
    std::ostream& out = file_->stream();
    out << "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(("
        << step_string(info_.plan.curves ? "Lamella layers: contours of materials, exact curves"
                                         : "Lamella layers: contours of materials, chord error " +
                                               format_double(*info_.plan.chord_error) + " mm");
    for (const SourceFile& source : info_.sources) out << ",\n" << step_string("sliced from " + source.path);
    // No date: the same build gives the same bytes.
    out << "),'2;1');\nFILE_NAME(" << step_string(path_.filename().string())
        << ",'',('Lamella'),('Lamella'),'Lamella','Lamella','');\nFILE_SCHEMA((" << step_string(kSchema)
        << "));\nENDSEC;\nDATA;\n";
  }

  void write_shared() {
    shared_.application = add("APPLICATION_CONTEXT('managed model based 3d engineering')");
    add("APPLICATION_PROTOCOL_DEFINITION('international standard','ap242_managed_model_based_3d_engineering',2014,#1)");
    shared_.product_context = add("PRODUCT_CONTEXT('',#1,'mechanical')");
    shared_.definition_context = add("PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design')");
    const StepId length = add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
    const StepId angle = add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    const StepId solid_angle = add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
    const StepId uncertainty = add(fmt::format(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{},'distance_accuracy_value','')", kUncertainty, length));
    shared_.geometry_context =
        add(fmt::format("(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{}))"
                        "GLOBAL_UNIT_ASSIGNED_CONTEXT((#{},#{},#{}))REPRESENTATION_CONTEXT('',''))",
                        uncertainty, length, angle, solid_angle));
    const StepId origin = add("CARTESIAN_POINT('',(0.,0.,0.))");
    const StepId axis = add("DIRECTION('',(0.,0.,1.))");
    const StepId along = add("DIRECTION('',(1.,0.,0.))");
    shared_.placement = add(fmt::format("AXIS2_PLACEMENT_3D('',#{},#{},#{})", origin, axis, along));
    shared_.font = add("DRAUGHTING_PRE_DEFINED_CURVE_FONT('continuous')");
    const StepId gram = add("(MASS_UNIT()NAMED_UNIT(*)SI_UNIT($,.GRAM.))");
    const StepId centimetre = add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.))");
    shared_.gram = add(fmt::format("DERIVED_UNIT_ELEMENT(#{},1.)", gram));
    shared_.centimetre = add(fmt::format("DERIVED_UNIT_ELEMENT(#{},-3.)", centimetre));
  }

  void write_style(MaterialId material) {
    const Color& color = info_.materials[material].color;
    const StepId colour = add(fmt::format("COLOUR_RGB({},{},{},{})", step_string(info_.materials[material].name),
                                          step_real(color[0]), step_real(color[1]), step_real(color[2])));
    const StepId curve = add(fmt::format("CURVE_STYLE('',#{},POSITIVE_LENGTH_MEASURE(0.1),#{})", shared_.font, colour));
    materials_.push_back({add(fmt::format("PRESENTATION_STYLE_ASSIGNMENT((#{}))", curve)), {}});
  }

  void write_layer(const Layer& layer, const MaterialContours& contours, const MaterialCurves& curves) {
    std::vector<StepId> sets;
    const auto add_set = [&](MaterialId material, std::span<const StepId> elements, const char* what) {
      const std::string name = fmt::format("layer {}, {}{}", layer.index, info_.materials[material].name, what);
      sets.push_back(add("GEOMETRIC_CURVE_SET(" + step_string(name) + "," + step_list(elements) + ")"));
      styled_.push_back(add(fmt::format("STYLED_ITEM('',(#{}),#{})", materials_[material].style, sets.back())));
      materials_[material].curve_sets.push_back(sets.back());
    };
    for (const MaterialId material : contours.ids()) {
      if (contours[material].empty()) continue;
      std::vector<StepId> loops;
      for (std::size_t i = 0; i < contours[material].size(); ++i) {
        const MaterialLoop& loop = contours[material][i];
        const bool is_straight = curves.empty() || std::none_of(curves[material][i].begin(), curves[material][i].end(),
                                                                [](const auto& s) { return s.carrier.kind; });
        loops.push_back(is_straight ? write_loop(loop, layer.z_sample)
                                    : add_curve_loop(*entities_, curves[material][i], layer.z_sample, kind_of(loop)));
      }
      add_set(material, loops, "");
    }
    if (options_.hatches) {
      for (const MaterialId material : contours.ids()) {
        const std::vector<StepId> lines = write_hatches(layer, material);
        if (!lines.empty()) add_set(material, lines, ", hatch");
      }
    }
    if (sets.empty()) return;
    const std::string heights = fmt::format("z_bottom={} z_sample={} z_top={} mm", format_double(layer.z_bottom),
                                            format_double(layer.z_sample), format_double(layer.z_top));
    add(fmt::format("PRESENTATION_LAYER_ASSIGNMENT('layer {}',{},{})", layer.index, step_string(heights),
                    step_list(sets)));
    file_->check();
  }

  StepId write_loop(const MaterialLoop& loop, double z) {
    const std::string height = step_real(z);
    std::vector<StepId> points;
    for (const Vec2& point : loop.points) {
      points.push_back(
          add("CARTESIAN_POINT('',(" + step_real(point.x()) + "," + step_real(point.y()) + "," + height + "))"));
    }
    points.push_back(points.front());
    return add(fmt::format("POLYLINE({},{})", kind_of(loop), step_list(points)));
  }

  static const char* kind_of(const MaterialLoop& loop) { return loop.parent < 0 ? "'outer'" : "'hole'"; }

  /// One line for each segment of the material, along its row.
  [[nodiscard]] std::vector<StepId> write_hatches(const Layer& layer, MaterialId material) {
    const HatchAxes axes = hatch_axes(*info_.plan.hatch, layer.index);
    const HatchRows& hatch = *layer.hatch;
    const auto point = [&](double x, double offset) {
      const Vec2 at = x * axes.along + offset * axes.across;
      return add(fmt::format("CARTESIAN_POINT('',({},{},{}))", step_real(at.x()), step_real(at.y()),
                             step_real(layer.z_sample)));
    };
    std::vector<StepId> lines;
    for (std::size_t row = 0; row < hatch.rows.rows(); ++row) {
      const double offset =
          (static_cast<double>(hatch.first_row + static_cast<std::int64_t>(row)) + 0.5) * hatch.spacing;
      for (const Segment& segment : hatch.rows.row(row)) {
        if (segment.material != material) continue;
        const std::array ends{point(segment.x_begin, offset), point(segment.x_end, offset)};
        lines.push_back(add("POLYLINE('hatch'," + step_list(ends) + ")"));
      }
    }
    return lines;
  }

  StepId write_product(MaterialId id) {
    const std::string name = step_string(info_.materials[id].name);
    std::vector<StepId> items{shared_.placement};
    const auto& sets = materials_[id].curve_sets;
    items.insert(items.end(), sets.begin(), sets.end());
    const StepId shape = add("GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION(" + name + "," + step_list(items) +
                             "," + step_reference(shared_.geometry_context) + ")");
    const StepId product = add(fmt::format("PRODUCT({},{},'',(#{}))", name, name, shared_.product_context));
    const StepId formation = add(fmt::format("PRODUCT_DEFINITION_FORMATION('','',#{})", product));
    const StepId definition =
        add(fmt::format("PRODUCT_DEFINITION('design','',#{},#{})", formation, shared_.definition_context));
    const StepId of_shape = add(fmt::format("PRODUCT_DEFINITION_SHAPE('','',#{})", definition));
    add(fmt::format("SHAPE_DEFINITION_REPRESENTATION(#{},#{})", of_shape, shape));
    write_properties(info_.materials[id], name, definition);
    return product;
  }

  /// Material as CAx-IF's recommended practice has it (Material Identification and Density).
  void write_properties(const Material& material, const std::string& name, StepId definition) {
    const StepId item = add("DESCRIPTIVE_REPRESENTATION_ITEM(" + name + "," + name + ")");
    write_property("material name", item, definition);
    if (!material.density) return;
    const StepId unit = add(fmt::format("DERIVED_UNIT((#{},#{}))", shared_.gram, shared_.centimetre));
    write_property("density",
                   add(fmt::format("MEASURE_REPRESENTATION_ITEM('density measure',POSITIVE_RATIO_MEASURE({}),#{})",
                                   step_real(*material.density), unit)),
                   definition);
  }

  void write_property(const char* what, StepId item, StepId definition) {
    const StepId property = add(fmt::format("PROPERTY_DEFINITION('material property','{}',#{})", what, definition));
    const StepId value = add(fmt::format("REPRESENTATION('{}',(#{}),#{})", what, item, shared_.geometry_context));
    add(fmt::format("PROPERTY_DEFINITION_REPRESENTATION(#{},#{})", property, value));
  }

  fs::path path_;
  StepLayersOptions options_;
  BuildInfo info_;
  std::optional<ContourCombiner> combiner_;
  std::optional<OutputFile> file_;
  std::optional<StepEntities> entities_;
  SharedEntities shared_;
  IdVector<MaterialId, MaterialEntities> materials_;
  std::vector<StepId> styled_;
};

}  // namespace

std::unique_ptr<LayerSink> make_step_sink(const fs::path& file, const StepLayersOptions& options) {
  return std::make_unique<StepSink>(file, options);
}

}  // namespace lamella
