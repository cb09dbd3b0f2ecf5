#pragma once

#include "core/xml_writer.h"
#include "export/xml_stream.h"
#include "slicing/layer_sink.h"

/// The parts of schemas/slices.xsd around the layers, each written and read: <header> and <report>.
namespace lamella::slices_xml {

void write_header(XmlWriter& xml, const BuildInfo& info);
[[nodiscard]] BuildInfo read_header(XmlStream& xml);

void write_report(XmlWriter& xml, const SliceReport& report);
/// Ids are checked against `info`.
[[nodiscard]] SliceReport read_report(XmlStream& xml, const BuildInfo& info);

}  // namespace lamella::slices_xml
