#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/xml_writer.h"
#include "export/xml_payload.h"
#include "export/xml_stream.h"

/// Columns of XML slices in blocks (docs/formats/slices-xml.md).
namespace lamella::slices_xml {

/// Writes <name> with its blocks.
template <class T>
void write_blocks(XmlWriter& xml, const char* name, std::span<const T> items) {
  xml.start(name);
  for (std::size_t at = 0; at < items.size(); at += kMaxBlockItems) {
    const PackedBlock block = pack_block(items.subspan(at, std::min(kMaxBlockItems, items.size() - at)));
    xml.start("block").attribute("bytes", block.bytes).attribute("stored", block.stored);
    xml.plain_text(block.text).end();
  }
  xml.end();
}

/// Reads the blocks of the current element, at most `count` numbers.
template <class T>
void read_block_items(XmlStream& xml, std::size_t count, std::vector<T>& items) {
  while (xml.at("block")) {
    xml.enter("block", {"bytes", "stored"});
    const auto bytes = static_cast<std::size_t>(xml.integer("bytes", 1, kMaxBlockItems * sizeof(T)));
    const auto stored = static_cast<std::size_t>(xml.integer("stored", 1, INT32_MAX));
    if (bytes / sizeof(T) > count - items.size()) xml.fail("more numbers than stated");
    try {
      unpack_block(bytes, stored, xml.text(), items);
    } catch (const std::invalid_argument& error) {
      xml.fail(std::string("block: ") + error.what());
    }
    xml.leave();
  }
}

/// Reads <name> with its blocks: exactly `count` numbers.
template <class T>
std::vector<T> read_blocks(XmlStream& xml, std::string_view name, std::size_t count) {
  std::vector<T> items;
  xml.enter(name);
  read_block_items(xml, count, items);
  if (items.size() != count) xml.fail("not as many numbers as stated");
  xml.leave();
  return items;
}

}  // namespace lamella::slices_xml
