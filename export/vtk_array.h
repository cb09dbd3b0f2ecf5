#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace lamella {

/// Text of an inline binary DataArray of a VTK XML file with header_type UInt64 and vtkZLibDataCompressor: sizes, then
/// zlib blocks, each of the two in base64. The same bytes give the same text.
[[nodiscard]] std::string vtk_text(std::span<const std::byte> bytes);

/// Text of an ASCII DataArray of type String: the codes of all characters, each name ended by 0.
[[nodiscard]] std::string vtk_text_of_names(std::span<const std::string> names);

}  // namespace lamella
