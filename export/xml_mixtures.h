#pragma once

#include <cstddef>

#include "core/xml_writer.h"
#include "export/xml_stream.h"
#include "slicing/layer.h"

namespace lamella::slices_xml {

/// Writes <mixtures> of a lattice's rows, or nothing where there are none; numbers as text or as blocks.
void write_mixtures(XmlWriter& xml, const Mixtures& mixtures, bool as_text);

/// Reads <mixtures>, of rows with so many segments. Sizes are checked before memory is taken; whether the numbers make
/// sense is find_layer_fault()'s to say.
[[nodiscard]] Mixtures read_mixtures(XmlStream& xml, std::size_t segments);

}  // namespace lamella::slices_xml
