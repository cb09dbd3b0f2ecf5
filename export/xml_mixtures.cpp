#include "export/xml_mixtures.h"

#include <cstdint>
#include <vector>

#include "export/xml_blocks.h"
#include "export/xml_slices_format.h"

namespace lamella::slices_xml {

namespace {

/// Writes <name> as lists of text or as blocks.
template <class T>
void write_column(XmlWriter& xml, const char* name, const std::vector<T>& items, bool as_text) {
  const std::span<const T> all = items;
  if (!as_text) {
    write_blocks<T>(xml, name, all);
    return;
  }
  xml.start(name);
  for (std::size_t at = 0; at < all.size(); at += kMaxBlockItems) {
    xml.start("part").plain_text(format_list(all.subspan(at, std::min(kMaxBlockItems, all.size() - at)))).end();
  }
  xml.end();
}

/// Reads <name>, however it is written: exactly `count` numbers.
template <class T>
std::vector<T> read_column(XmlStream& xml, const char* name, std::size_t count) {
  std::vector<T> items;
  xml.enter(name);
  while (xml.at("part")) {
    xml.enter("part");
    try {
      parse_list(xml.text(), std::min(kMaxBlockItems, count - items.size()), items);
    } catch (const std::invalid_argument& error) {
      xml.fail(error.what());
    }
    xml.leave();
  }
  if (items.empty()) read_block_items(xml, count, items);
  if (items.size() != count) xml.fail("not as many numbers as stated");
  xml.leave();
  return items;
}

}  // namespace

void write_mixtures(XmlWriter& xml, const Mixtures& mixtures, bool as_text) {
  if (mixtures.empty()) return;
  std::vector<std::uint32_t> segment;
  std::vector<std::uint32_t> knots;
  std::vector<std::uint32_t> components;
  for (std::size_t g = 0; g < mixtures.segment.size(); ++g) {
    segment.push_back(static_cast<std::uint32_t>(mixtures.segment[g]));
    knots.push_back(static_cast<std::uint32_t>(mixtures.knots(g).size()));
    components.push_back(static_cast<std::uint32_t>(mixtures.fractions(g).size() / mixtures.knots(g).size()));
  }
  const std::vector<double> fractions(mixtures.fraction.begin(), mixtures.fraction.end());
  xml.start("mixtures").attribute("segments", segment.size()).attribute("knots", mixtures.x.size());
  xml.attribute("fractions", fractions.size());
  write_column(xml, "segment", segment, as_text);
  write_column(xml, "knots", knots, as_text);
  write_column(xml, "components", components, as_text);
  write_column(xml, "x", mixtures.x, as_text);
  write_column(xml, "fraction", fractions, as_text);
  xml.end();
}

Mixtures read_mixtures(XmlStream& xml, std::size_t segments) {
  xml.enter("mixtures", {"segments", "knots", "fractions"});
  const auto count = static_cast<std::size_t>(xml.integer("segments", 0, static_cast<std::int64_t>(segments)));
  const auto knot_count = static_cast<std::size_t>(xml.integer("knots", 0, kMaxKnots));
  const auto fraction_count = static_cast<std::size_t>(xml.integer("fractions", 0, kMaxFractions));
  Mixtures mixtures;
  for (const std::uint32_t s : read_column<std::uint32_t>(xml, "segment", count)) mixtures.segment.push_back(s);
  const auto knots = read_column<std::uint32_t>(xml, "knots", count);
  const auto components = read_column<std::uint32_t>(xml, "components", count);
  for (std::size_t g = 0; g < count; ++g) {
    mixtures.knot_start.push_back(mixtures.knot_start.back() + knots[g]);
    mixtures.fraction_start.push_back(mixtures.fraction_start.back() + std::uint64_t{knots[g]} * components[g]);
    const bool fits = mixtures.knot_start.back() <= knot_count && mixtures.fraction_start.back() <= fraction_count;
    if (!fits) xml.fail("more knots or fractions than stated");
  }
  mixtures.x = read_column<double>(xml, "x", knot_count);
  for (const double fraction : read_column<double>(xml, "fraction", fraction_count)) {
    mixtures.fraction.push_back(static_cast<float>(fraction));
  }
  xml.leave();
  return mixtures;
}

}  // namespace lamella::slices_xml
