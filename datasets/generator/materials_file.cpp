#include "datasets/generator/materials_file.h"

#include <set>
#include <sstream>

namespace lamella::datasets {

std::string materials_xml(const DataSet& set) {
  std::ostringstream library, rules;
  std::set<std::string> seen;
  for (const int part : walk(set)) {
    const PartMaterial& m = set.parts[part].material;
    if (!seen.insert(m.name).second) continue;
    library << "    <material name=\"" << m.name << "\" density=\"" << m.density << "\" color=\"" << hex(m.color)
            << "\" priority=\"" << m.priority << "\"/>\n";
    rules << "    <assign step_material=\"" << m.name << "\" material=\"" << m.name << "\"/>\n";
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- " + set.description +
         "; the higher priority wins where bodies overlap. -->\n"
         "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.0\">\n  <library>\n" +
         library.str() + "  </library>\n  <assignments>\n" + rules.str() + "  </assignments>\n</materials>\n";
}

}  // namespace lamella::datasets
