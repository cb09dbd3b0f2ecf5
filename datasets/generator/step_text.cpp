#include "datasets/generator/step_text.h"

#include <cmath>
#include <cstdio>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace lamella::datasets {
namespace {

/// The UTF-8 sequence at `at`, which is moved past it.
unsigned code_point(const std::string& utf8, std::size_t& at) {
  const auto lead = static_cast<unsigned char>(utf8[at++]);
  const int more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : 1;
  unsigned value = lead & (0x3Fu >> more);
  for (int i = 0; i < more; ++i) value = value << 6 | (static_cast<unsigned char>(utf8.at(at++)) & 0x3Fu);
  return value;
}

/// Runs of non-ASCII characters as \X2\....\X0\, four hex digits each (all our names lie in the basic plane).
std::string part21_text(const std::string& utf8) {
  std::string result;
  bool wide = false;
  for (std::size_t at = 0; at < utf8.size();) {
    const bool ascii = static_cast<unsigned char>(utf8[at]) < 0x80;
    if (ascii == wide) result += wide ? "\\X0\\" : "\\X2\\";
    wide = !ascii;
    if (ascii) {
      result += utf8[at++];
    } else {
      char digits[16];
      std::snprintf(digits, sizeof digits, "%04X", code_point(utf8, at));
      result += digits;
    }
  }
  return result;
}

/// The statements between "\n#" and ";\n" whose text matches `kind`.
struct Statement {
  std::size_t begin = 0, end = 0;  ///< of "#12 = ...;\n"
  std::string number;              ///< "#12"
};

std::vector<Statement> statements(const std::string& text, const std::string& kind) {
  std::vector<Statement> result;
  for (std::size_t at = text.find("\n#"); at != std::string::npos;) {
    const std::size_t end = text.find(";\n", at + 1);
    if (end == std::string::npos) break;
    const std::size_t equals = text.find(" = ", at + 1);
    if (text.compare(equals + 3, kind.size(), kind) == 0)
      result.push_back({at + 1, end + 2, text.substr(at + 1, equals - at - 1)});
    at = text.compare(end + 1, 2, "\n#") == 0 ? end + 1 : text.find("\n#", end);
  }
  return result;
}

/// Replaces all "(#a)" or ",#a)" of the given numbers by the first of them and drops the statements of the rest.
std::string with_one_plane_context(const std::string& text) {
  const auto contexts = statements(text, "( GEOMETRIC_REPRESENTATION_CONTEXT(2)");
  if (contexts.size() < 2) return text;
  std::string result;
  std::size_t from = 0;
  for (std::size_t i = 1; i < contexts.size(); ++i) {
    result.append(text, from, contexts[i].begin - from);
    from = contexts[i].end;
  }
  result.append(text, from);
  // A plane context is only named at the end of a definitional representation.
  static const std::regex use(R"((DEFINITIONAL_REPRESENTATION\('',\(#\d+\),)(\s*)#\d+\))");
  return std::regex_replace(result, use, std::string("$1$2").append(contexts.front().number).append(")"));
}

/// A body of the file and the context of its representation.
struct Body {
  std::string solid, context;
};

std::vector<Body> bodies(const std::string& text) {
  static const std::regex parts(R"(^#\d+ = ADVANCED_BREP_SHAPE_REPRESENTATION\('',\(#\d+,(#\d+)\),\s*(#\d+)\))");
  std::vector<Body> result;
  for (const Statement& s : statements(text, "ADVANCED_BREP_SHAPE_REPRESENTATION")) {
    std::smatch match;
    const std::string body = text.substr(s.begin, s.end - s.begin);
    if (!std::regex_search(body, match, parts)) throw std::runtime_error("a representation without exactly one body");
    result.push_back({match[1], match[2]});
  }
  return result;
}

/// The chain of entities that gives a body its colour, numbered from `first`.
std::string style_text(const Body& body, const std::array<double, 3>& color, int first) {
  char rgb[96];
  std::snprintf(rgb, sizeof rgb, "'',%#.15G,%#.15G,%#.15G", std::round(color[0] * 255) / 255,
                std::round(color[1] * 255) / 255, std::round(color[2] * 255) / 255);
  std::ostringstream out;
  int number = first;
  const auto entity = [&](const char* keyword, const std::string& before, const std::string& after) {
    out << '#' << number << " = " << keyword << '(' << before << '#' << number + 1 << after << ");\n";
    ++number;
  };
  entity("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION", "'',(", ")," + body.context);
  entity("STYLED_ITEM", "'color',(", ")," + body.solid);
  entity("PRESENTATION_STYLE_ASSIGNMENT", "(", ")");
  entity("SURFACE_STYLE_USAGE", ".BOTH.,", "");
  entity("SURFACE_SIDE_STYLE", "'',(", ")");
  entity("SURFACE_STYLE_FILL_AREA", "", "");
  entity("FILL_AREA_STYLE", "'',(", ")");
  entity("FILL_AREA_STYLE_COLOUR", "'',", "");
  out << '#' << number << " = COLOUR_RGB(" << rgb << ");\n";
  return out.str();
}

std::string only_statement(const std::string& text, const std::string& kind, const std::string& holding) {
  for (const Statement& s : statements(text, kind)) {
    const std::string body = text.substr(s.begin, s.end - s.begin);
    if (std::regex_search(body, std::regex(holding + "[,)']"))) return body;
  }
  throw std::runtime_error("no " + kind + " with " + holding);
}

std::string number_of(const std::string& statement) { return statement.substr(0, statement.find(' ')); }

std::string point_text(const char* keyword, const std::array<double, 3>& p) {
  char buffer[128];
  std::snprintf(buffer, sizeof buffer, "%s('',(%#.15G,%#.15G,%#.15G));\n", keyword, p[0], p[1], p[2]);
  return buffer;
}

}  // namespace

std::string normalised(std::string step_text) {
  static const std::regex grams(R"(DERIVED_UNIT_ELEMENT\((#\d+),3\.\))");
  static const std::regex centimetres(R"(DERIVED_UNIT_ELEMENT\((#\d+),2\.\))");
  step_text = std::regex_replace(step_text, grams, "DERIVED_UNIT_ELEMENT($1,1.)");
  step_text = std::regex_replace(step_text, centimetres, "DERIVED_UNIT_ELEMENT($1,-3.)");
  return part21_text(with_one_plane_context(step_text));
}

std::string with_colors(const std::string& step_text, const std::vector<std::array<double, 3>>& colors) {
  const std::vector<Body> all = bodies(step_text);
  if (all.size() != colors.size()) throw std::runtime_error("as many colours as bodies are needed");
  std::string styles;
  for (std::size_t i = 0; i < all.size(); ++i)
    styles += style_text(all[i], colors[i], 800001 + 10 * static_cast<int>(i));
  std::string result = step_text;
  return result.insert(result.rfind("ENDSEC;"), styles);
}

std::string with_mirrored_instance(const std::string& step_text, const std::string& instance,
                                   const std::array<double, 3>& shift) {
  const std::string use =
      number_of(only_statement(step_text, "NEXT_ASSEMBLY_USAGE_OCCURRENCE", std::string("'").append(instance)));
  const std::string shape = number_of(only_statement(step_text, "PRODUCT_DEFINITION_SHAPE", use));
  const std::string placed = only_statement(step_text, "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION", shape);
  std::smatch relation, transform;
  if (!std::regex_search(placed, relation, std::regex(R"(\((#\d+),)"))) throw std::runtime_error("odd placement");
  const std::size_t at = step_text.find(std::string("\n").append(relation[1].str()).append(" = "));
  const std::string body = step_text.substr(at, step_text.find(";\n", at) - at);
  if (!std::regex_search(body, transform, std::regex(R"(TRANSFORMATION\((#\d+)\))")))
    throw std::runtime_error("odd placement");
  const std::string head = std::string("\n").append(transform[1].str()).append(" = ");
  const std::size_t begin = step_text.find(head) + head.size(), end = step_text.find(";\n", begin) + 2;
  std::string result = step_text.substr(0, begin);
  result += "CARTESIAN_TRANSFORMATION_OPERATOR_3D('','mirror','',#900001,#900002,#900004,1.,#900003);\n";
  result += "#900001 = " + point_text("DIRECTION", {-1, 0, 0});
  result += "#900002 = " + point_text("DIRECTION", {0, 1, 0});
  result += "#900003 = " + point_text("DIRECTION", {0, 0, 1});
  result += "#900004 = " + point_text("CARTESIAN_POINT", shift);
  return result + step_text.substr(end);
}

}  // namespace lamella::datasets
