#include <filesystem>
#include <stdexcept>
#include <string>

#include "core/error.h"
#include "export/build_check.h"
#include "export/xml_blocks.h"
#include "export/xml_mixtures.h"
#include "export/xml_payload.h"
#include "export/xml_slices.h"
#include "export/xml_slices_format.h"
#include "export/xml_slices_header.h"
#include "export/xml_stream.h"

namespace lamella {

namespace {

using namespace slices_xml;

/// Segments as columns, the way the file has them.
struct Columns {
  std::vector<double> x_begin;
  std::vector<double> x_end;
  std::vector<std::uint32_t> material;
  std::vector<std::uint32_t> solid;
};

void append(SegmentRows& rows, const Columns& columns) {
  for (std::size_t i = 0; i < columns.x_begin.size(); ++i) {
    rows.segments.push_back({columns.x_begin[i], columns.x_end[i], MaterialId{std::size_t{columns.material[i]}},
                             SolidId{std::size_t{columns.solid[i]}}});
  }
}

SegmentRows read_packed(XmlStream& xml, std::size_t row_count, std::size_t segment_count) {
  xml.enter("packed");
  SegmentRows rows;
  for (std::uint32_t count : read_blocks<std::uint32_t>(xml, "segments_per_row", row_count)) {
    rows.row_start.push_back(rows.row_start.back() + count);
  }
  if (rows.row_start.back() != segment_count) xml.fail("the rows have not as many segments as stated");
  Columns columns;
  columns.x_begin = read_blocks<double>(xml, "x_begin", segment_count);
  columns.x_end = read_blocks<double>(xml, "x_end", segment_count);
  columns.material = read_blocks<std::uint32_t>(xml, "material", segment_count);
  columns.solid = read_blocks<std::uint32_t>(xml, "solid", segment_count);
  append(rows, columns);
  xml.leave();
  return rows;
}

/// Reads <name>: a list of exactly `count` numbers.
template <class T>
std::vector<T> read_list(XmlStream& xml, std::string_view name, std::size_t count) {
  std::vector<T> items;
  xml.enter(name);
  try {
    parse_list(xml.text(), count, items);
  } catch (const std::invalid_argument& error) {
    xml.fail(error.what());
  }
  if (items.size() != count) xml.fail("not as many numbers as stated");
  xml.leave();
  return items;
}

/// Reads one <row> into `rows`, after ending the rows before it.
void read_row(XmlStream& xml, std::size_t row_count, std::size_t segment_count, SegmentRows& rows) {
  xml.enter("row", {"index", "segments"});
  const std::size_t next = rows.rows();
  // The last row may go on in a further element of the same index.
  const auto least = static_cast<std::int64_t>(next == 0 ? 0 : next - 1);
  const auto index = static_cast<std::size_t>(xml.integer("index", least, static_cast<std::int64_t>(row_count) - 1));
  const auto left = static_cast<std::int64_t>(segment_count - rows.segments.size());
  const auto count = static_cast<std::size_t>(xml.integer("segments", 1, std::min<std::int64_t>(left, kMaxRowPart)));
  const auto x = read_list<double>(xml, "x", 2 * count);
  Columns columns;
  for (std::size_t i = 0; i < count; ++i) {
    columns.x_begin.push_back(x[2 * i]);
    columns.x_end.push_back(x[2 * i + 1]);
  }
  columns.material = read_list<std::uint32_t>(xml, "material", count);
  columns.solid = read_list<std::uint32_t>(xml, "solid", count);
  while (rows.rows() < index + 1) rows.row_start.push_back(rows.segments.size());
  append(rows, columns);
  rows.row_start.back() = rows.segments.size();
  xml.leave();
}

SegmentRows read_segments(XmlStream& xml) {
  const auto row_count = static_cast<std::size_t>(xml.integer("rows", 0, kMaxRows));
  const auto segment_count = static_cast<std::size_t>(xml.integer("segments", 0, kMaxSegments));
  if (xml.at("packed")) return read_packed(xml, row_count, segment_count);
  SegmentRows rows;
  while (xml.at("row")) read_row(xml, row_count, segment_count, rows);
  while (rows.rows() < row_count) rows.row_start.push_back(rows.segments.size());
  if (rows.segments.size() != segment_count) xml.fail("not as many segments as stated");
  return rows;
}

SegmentRows read_rows(XmlStream& xml) {
  SegmentRows rows = read_segments(xml);
  if (xml.at("mixtures")) rows.mixtures = read_mixtures(xml, rows.segments.size());
  return rows;
}

Layer read_layer(XmlStream& xml, std::int64_t least_index) {
  Layer layer;
  xml.enter("layer", {"index", "z_bottom", "z_sample", "z_top"});
  layer.index = static_cast<std::uint32_t>(xml.integer("index", least_index, INT32_MAX));
  layer.z_bottom = xml.number("z_bottom");
  layer.z_sample = xml.number("z_sample");
  layer.z_top = xml.number("z_top");
  xml.enter("raster", {"rows", "segments"});
  layer.raster = read_rows(xml);
  xml.leave();
  if (xml.at("hatch")) {
    xml.enter("hatch", {"angle", "spacing", "first_row", "rows", "segments"});
    layer.hatch.emplace();
    layer.hatch->angle = xml.number("angle");
    layer.hatch->spacing = xml.number("spacing");
    layer.hatch->first_row = xml.integer("first_row", INT64_MIN, INT64_MAX);
    layer.hatch->rows = read_rows(xml);
    xml.leave();
  }
  xml.leave();
  return layer;
}

}  // namespace

void read_xml_slices(const std::filesystem::path& file, LayerSink& sink, const Progress& progress) {
  XmlStream xml(file, std::string(kNamespace));
  std::error_code ignored;
  const auto size = static_cast<double>(std::filesystem::file_size(file, ignored));
  xml.enter("slices", {"version"});
  if (!xml.attribute("version").starts_with("1.")) {
    xml.fail("version " + xml.attribute("version") + " of the slice format is not known", "this program reads 1.x");
  }
  const BuildInfo info = read_header(xml);
  sink.begin(info);
  std::int64_t next_index = 0;
  while (xml.at("layer")) {
    progress.throw_if_cancelled();
    const Layer layer = read_layer(xml, next_index);
    next_index = std::int64_t{layer.index} + 1;
    if (const std::string fault = find_layer_fault(layer, info); !fault.empty()) {
      xml.fail("layer " + std::to_string(layer.index) + ": " + fault);
    }
    sink.write(layer);
    progress.report("reading", static_cast<double>(xml.bytes_read()) / size);
  }
  const SliceReport report = read_report(xml, info);
  xml.leave();
  xml.finish();
  sink.finish(report);
}

}  // namespace lamella
