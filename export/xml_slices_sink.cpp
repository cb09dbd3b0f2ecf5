#include <optional>
#include <string>

#include "core/error.h"
#include "core/xml_writer.h"
#include "export/build_check.h"
#include "export/output_file.h"
#include "export/xml_blocks.h"
#include "export/xml_mixtures.h"
#include "export/xml_payload.h"
#include "export/xml_slices.h"
#include "export/xml_slices_format.h"
#include "export/xml_slices_header.h"

namespace lamella {

namespace {

using namespace slices_xml;

/// One number per segment, in order.
template <class T, class Get>
std::vector<T> column(std::span<const Segment> segments, Get get) {
  std::vector<T> out;
  out.reserve(segments.size());
  for (const Segment& segment : segments) out.push_back(get(segment));
  return out;
}

std::uint32_t material_of(const Segment& segment) { return segment.material.value(); }
std::uint32_t solid_of(const Segment& segment) { return segment.solid.value(); }

void write_packed(XmlWriter& xml, const SegmentRows& rows) {
  std::vector<std::uint32_t> counts(rows.rows());
  for (std::size_t r = 0; r < rows.rows(); ++r) counts[r] = static_cast<std::uint32_t>(rows.row(r).size());
  const std::span<const Segment> all = rows.segments;
  xml.start("packed");
  write_blocks<std::uint32_t>(xml, "segments_per_row", counts);
  write_blocks<double>(xml, "x_begin", column<double>(all, [](const Segment& s) { return s.x_begin; }));
  write_blocks<double>(xml, "x_end", column<double>(all, [](const Segment& s) { return s.x_end; }));
  write_blocks<std::uint32_t>(xml, "material", column<std::uint32_t>(all, material_of));
  write_blocks<std::uint32_t>(xml, "solid", column<std::uint32_t>(all, solid_of));
  xml.end();
}

void write_row(XmlWriter& xml, std::size_t index, std::span<const Segment> part) {
  std::vector<double> x;
  for (const Segment& segment : part) x.insert(x.end(), {segment.x_begin, segment.x_end});
  const auto list = [&](const char* name, const auto& items) {
    xml.start(name).plain_text(format_list(std::span(items))).end();
  };
  xml.start("row").attribute("index", index).attribute("segments", part.size());
  list("x", std::as_const(x));
  const auto materials = column<std::uint32_t>(part, material_of);
  list("material", materials);
  const auto solids = column<std::uint32_t>(part, solid_of);
  list("solid", solids);
  xml.end();
}

void write_text(XmlWriter& xml, const SegmentRows& rows) {
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    const std::span<const Segment> row = rows.row(r);
    for (std::size_t at = 0; at < row.size(); at += kMaxRowPart) {
      write_row(xml, r, row.subspan(at, std::min(kMaxRowPart, row.size() - at)));
    }
  }
}

class XmlSink final : public LayerSink {
 public:
  XmlSink(std::filesystem::path path, XmlPayload payload) : path_(std::move(path)), payload_(payload) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    if (info.plan.grid.size[1] > kMaxRows) {
      throw UsageError("XML slices hold at most " + std::to_string(kMaxRows) + " rows a layer", path_.string(),
                       "choose a coarser --pitch");
    }
    info_ = info;
    file_.emplace(path_);
    xml_.emplace(file_->stream());
    xml_->start("slices")
        .attribute("xmlns", kNamespace)
        .attribute("version", info.turn         ? kTurnedVersion
                              : is_graded(info) ? kGradedVersion
                                                : kVersion);
    write_header(*xml_, info);
    file_->check();
  }

  void write(const Layer& layer) override {
    check_layer(layer, info_);
    if (last_ && layer.index <= *last_) throw ExportError("layers are not in order", path_.string());
    last_ = layer.index;
    xml_->start("layer").attribute("index", layer.index).attribute("z_bottom", layer.z_bottom);
    xml_->attribute("z_sample", layer.z_sample).attribute("z_top", layer.z_top);
    xml_->start("raster");
    write_rows(layer.raster);
    xml_->end();
    if (layer.hatch) {
      xml_->start("hatch").attribute("angle", layer.hatch->angle).attribute("spacing", layer.hatch->spacing);
      xml_->attribute("first_row", layer.hatch->first_row);
      write_rows(layer.hatch->rows);
      xml_->end();
    }
    xml_->end();
    file_->check();
  }

  void finish(const SliceReport& report) override {
    write_report(*xml_, report);
    xml_->end();
    file_->commit();
  }

 private:
  void write_rows(const SegmentRows& rows) {
    if (rows.segments.size() > static_cast<std::size_t>(kMaxSegments) ||
        rows.rows() > static_cast<std::size_t>(kMaxRows)) {
      throw ExportError("a layer of XML slices holds at most " + std::to_string(kMaxSegments) + " segments",
                        path_.string());
    }
    xml_->attribute("rows", rows.rows()).attribute("segments", rows.segments.size());
    if (payload_ == XmlPayload::text) {
      write_text(*xml_, rows);
    } else {
      write_packed(*xml_, rows);
    }
    if (rows.mixtures.x.size() > static_cast<std::size_t>(kMaxKnots) ||
        rows.mixtures.fraction.size() > static_cast<std::size_t>(kMaxFractions)) {
      throw ExportError("a layer of XML slices holds at most " + std::to_string(kMaxKnots) + " knots and " +
                            std::to_string(kMaxFractions) + " fractions of graded segments",
                        path_.string());
    }
    write_mixtures(*xml_, rows.mixtures, payload_ == XmlPayload::text);
  }

  std::filesystem::path path_;
  XmlPayload payload_;
  BuildInfo info_;
  std::optional<OutputFile> file_;
  std::optional<XmlWriter> xml_;
  std::optional<std::uint32_t> last_;
};

}  // namespace

std::unique_ptr<LayerSink> make_xml_sink(const std::filesystem::path& file, XmlPayload payload) {
  return std::make_unique<XmlSink>(file, payload);
}

}  // namespace lamella
