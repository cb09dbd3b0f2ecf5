#pragma once

#include <filesystem>
#include <memory>

#include "core/progress.h"
#include "slicing/layer_sink.h"

namespace lamella {

enum class XmlPayload { text, binary };  ///< numbers as text, or zlib + base64 blocks of little-endian doubles

/// One XML file of all layers (schemas/slices.xsd), written as a stream.
[[nodiscard]] std::unique_ptr<LayerSink> make_xml_sink(const std::filesystem::path& file,
                                                       XmlPayload payload = XmlPayload::binary);

/// Reads such a file back as the same stream, bit for bit, with bounded memory. Throws InputError with file and line.
void read_xml_slices(const std::filesystem::path& file, LayerSink& sink, const Progress& progress = {});

}  // namespace lamella
