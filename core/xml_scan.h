#pragma once

#include <string>
#include <string_view>

namespace lamella::detail {

/// Checks XML text for what the parser behind `XmlDocument` would let pass, before it sees it: document type
/// declarations, references other than the five predefined ones and legal characters, encodings other than UTF-8,
/// characters XML forbids, '<' in attribute values, too deep nesting, too many elements or attributes, and text or a
/// second element outside the root. Linear in time, constant memory. Throws InputError with `name:line`, the text's
/// first line being `first_line`.
void scan_xml(std::string_view text, const std::string& name, int first_line = 1);

/// Largest number of elements, and of attributes in one element; bounds memory and the parser's search for duplicates.
inline constexpr std::size_t kMaxXmlElements = std::size_t{1} << 21;
inline constexpr int kMaxXmlAttributes = 256;

}  // namespace lamella::detail
