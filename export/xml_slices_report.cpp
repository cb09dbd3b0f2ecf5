#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "export/xml_slices_format.h"
#include "export/xml_slices_header.h"

namespace lamella::slices_xml {

namespace {

/// Counters are unsigned 64-bit in memory; a run that counts beyond 2^63 would take centuries.
constexpr std::int64_t kMaxCount = std::numeric_limits<std::int64_t>::max();

struct Counter {
  std::string_view name;
  std::uint64_t CastCounters::*member;
};

constexpr std::array<Counter, 9> kCounters = {{{"cast_rays", &CastCounters::rays},
                                               {"hits", &CastCounters::hits},
                                               {"tie_rays", &CastCounters::tie_rays},
                                               {"tolerance_rays", &CastCounters::tolerance_rays},
                                               {"repaired_rays", &CastCounters::repaired_rays},
                                               {"unclosed_rays", &CastCounters::unclosed_rays},
                                               {"uncertain_hits", &CastCounters::uncertain_hits},
                                               {"candidates", &CastCounters::candidates},
                                               {"iterations", &CastCounters::iterations}}};

std::uint64_t count(const XmlStream& xml, std::string_view name) {
  return static_cast<std::uint64_t>(xml.integer(name, 0, kMaxCount));
}

void write_pairs(XmlWriter& xml, const char* name, const std::vector<PairReport>& pairs) {
  for (const PairReport& pair : pairs) {
    xml.start(name).attribute("first", pair.first.value()).attribute("second", pair.second.value());
    xml.attribute_if_finite("volume", pair.volume).attribute("layers", pair.layers);
    xml.attribute_if_finite("largest_depth", pair.largest_depth).end();
  }
}

void write_contacts(XmlWriter& xml, const char* name, const std::vector<ContactReport>& contacts) {
  for (const ContactReport& contact : contacts) {
    xml.start(name).attribute("first", contact.first.value()).attribute("second", contact.second.value());
    xml.attribute_if_finite("area", contact.area).attribute_if_finite("volume", contact.volume);
    xml.attribute_if_finite("least_gap", contact.least_gap).attribute_if_finite("largest_gap", contact.largest_gap);
    xml.attribute("layers", contact.layers).end();
  }
}

std::vector<ContactReport> read_contacts(XmlStream& xml, const char* name, std::int64_t solids) {
  std::vector<ContactReport> contacts;
  while (xml.at(name)) {
    xml.enter(name, {"first", "second", "area", "volume", "least_gap", "largest_gap", "layers"});
    ContactReport contact;
    contact.first = SolidId{static_cast<std::size_t>(xml.integer("first", 0, solids - 1))};
    contact.second = SolidId{static_cast<std::size_t>(xml.integer("second", 0, solids - 1))};
    contact.area = xml.number_or_unknown("area");
    contact.volume = xml.number_or_unknown("volume");
    contact.least_gap = xml.number_or_unknown("least_gap");
    contact.largest_gap = xml.number_or_unknown("largest_gap");
    contact.layers = count(xml, "layers");
    contacts.push_back(contact);
    xml.leave();
  }
  return contacts;
}

std::vector<PairReport> read_pairs(XmlStream& xml, const char* name, std::int64_t solids) {
  std::vector<PairReport> pairs;
  while (xml.at(name)) {
    xml.enter(name, {"first", "second", "volume", "layers", "largest_depth"});
    PairReport pair;
    pair.first = SolidId{static_cast<std::size_t>(xml.integer("first", 0, solids - 1))};
    pair.second = SolidId{static_cast<std::size_t>(xml.integer("second", 0, solids - 1))};
    pair.volume = xml.number_or_unknown("volume");
    pair.layers = count(xml, "layers");
    // Files of before there were depths have none.
    const double depth = xml.number_or_unknown("largest_depth");
    pair.largest_depth = std::isfinite(depth) ? depth : 0.0;
    pairs.push_back(pair);
    xml.leave();
  }
  return pairs;
}

void write_solids(XmlWriter& xml, const IdVector<SolidId, SolidReport>& solids) {
  for (SolidId id : solids.ids()) {
    const SolidReport& solid = solids[id];
    xml.start("solid_result").attribute("solid", id.value()).attribute("status", solid.status);
    xml.attribute("left_out", solid.left_out ? "true" : "false");
    xml.attribute_if_finite("volume_sliced", solid.volume_sliced);
    xml.attribute_if_finite("volume_exact", solid.volume_exact);
    xml.attribute_if_finite("quadrature_bound", solid.quadrature_bound).end();
  }
}

IdVector<SolidId, SolidReport> read_solids(XmlStream& xml, std::int64_t known) {
  IdVector<SolidId, SolidReport> solids;
  while (xml.at("solid_result")) {
    xml.enter("solid_result", {"solid", "status", "left_out", "volume_sliced", "volume_exact", "quadrature_bound"});
    const auto next = static_cast<std::int64_t>(solids.size());
    static_cast<void>(xml.integer("solid", next, std::min(next, known - 1)));
    SolidReport solid;
    solid.status = xml.attribute("status");
    solid.left_out = xml.attribute("left_out") == "true";
    solid.volume_sliced = xml.number_or_unknown("volume_sliced");
    solid.volume_exact = xml.number_or_unknown("volume_exact");
    solid.quadrature_bound = xml.number_or_unknown("quadrature_bound");
    solids.push_back(std::move(solid));
    xml.leave();
  }
  return solids;
}

void write_materials(XmlWriter& xml, const IdVector<MaterialId, MaterialReport>& materials) {
  for (MaterialId id : materials.ids()) {
    xml.start("material_result").attribute("material", id.value());
    xml.attribute_if_finite("volume", materials[id].volume).attribute_if_finite("mass", materials[id].mass).end();
  }
}

IdVector<MaterialId, MaterialReport> read_materials(XmlStream& xml, std::int64_t known) {
  IdVector<MaterialId, MaterialReport> materials;
  while (xml.at("material_result")) {
    xml.enter("material_result", {"material", "volume", "mass"});
    const auto next = static_cast<std::int64_t>(materials.size());
    static_cast<void>(xml.integer("material", next, std::min(next, known - 1)));
    materials.push_back({xml.number_or_unknown("volume"), xml.number_or_unknown("mass")});
    xml.leave();
  }
  return materials;
}

void write_findings(XmlWriter& xml, const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    xml.start("finding").attribute("severity", kSeverities[static_cast<std::size_t>(finding.severity)]);
    xml.attribute("solid", finding.solid).attribute("face", finding.face).attribute("entity", finding.entity);
    xml.attribute("what", finding.what).attribute("hint", finding.hint).end();
  }
}

std::vector<Finding> read_findings(XmlStream& xml) {
  std::vector<Finding> findings;
  while (xml.at("finding")) {
    xml.enter("finding", {"severity", "solid", "face", "entity", "what", "hint"});
    const auto severity = std::find(kSeverities.begin(), kSeverities.end(), xml.attribute("severity"));
    if (severity == kSeverities.end()) xml.fail("unknown severity '" + xml.attribute("severity") + "'");
    findings.push_back({static_cast<Severity>(severity - kSeverities.begin()), xml.attribute("solid"),
                        xml.attribute("face"), xml.attribute("entity"), xml.attribute("what"), xml.attribute("hint")});
    xml.leave();
  }
  return findings;
}

}  // namespace

void write_report(XmlWriter& xml, const SliceReport& report) {
  xml.start("report").attribute("layers", report.layers).attribute("rows", report.rows);
  xml.attribute("rays", report.rays).attribute("segments", report.segments);
  for (const Counter& counter : kCounters) xml.attribute(counter.name, report.cast.*counter.member);
  write_solids(xml, report.solids);
  write_materials(xml, report.materials);
  write_pairs(xml, "overlap", report.overlaps);
  write_pairs(xml, "gap", report.gaps);
  write_contacts(xml, "interface", report.interfaces);
  write_contacts(xml, "open_gap", report.open_gaps);
  write_findings(xml, report.findings);
  xml.end();
}

SliceReport read_report(XmlStream& xml, const BuildInfo& info) {
  xml.enter("report", {"layers", "rows", "rays", "segments", "cast_rays", "hits", "tie_rays", "tolerance_rays",
                       "repaired_rays", "unclosed_rays", "uncertain_hits", "candidates", "iterations"});
  SliceReport report;
  report.layers = count(xml, "layers");
  report.rows = count(xml, "rows");
  report.rays = count(xml, "rays");
  report.segments = count(xml, "segments");
  for (const Counter& counter : kCounters) report.cast.*counter.member = count(xml, counter.name);
  const auto solids = static_cast<std::int64_t>(info.solids.size());
  report.solids = read_solids(xml, solids);
  report.materials = read_materials(xml, static_cast<std::int64_t>(info.materials.size()));
  report.overlaps = read_pairs(xml, "overlap", solids);
  report.gaps = read_pairs(xml, "gap", solids);
  report.interfaces = read_contacts(xml, "interface", solids);
  report.open_gaps = read_contacts(xml, "open_gap", solids);
  report.findings = read_findings(xml);
  xml.leave();
  return report;
}

}  // namespace lamella::slices_xml
