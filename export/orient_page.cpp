#include "export/orient_page.h"

#include <algorithm>
#include <fmt/format.h>

#include "core/xml.h"
#include "export/base64.h"
#include "export/orient_picture.h"

namespace lamella {

namespace {

constexpr const char* kStyle = R"css(
:root{color-scheme:light dark;--ink:#1c2430;--soft:#5b6675;--page:#fff;--card:#f4f6f8;--line:#d5dae0;--bar:#2f6fb2}
@media (prefers-color-scheme:dark){:root{--ink:#e6eaf0;--soft:#9aa5b3;--page:#14181d;--card:#1d232a;--line:#343c46;--bar:#6aa9e9}}
body{margin:0 auto;max-width:1160px;padding:24px;font:15px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--page)}
h1{font-size:22px;margin:0}h2{font-size:17px;margin:0 0 6px}p{margin:4px 0;color:var(--soft)}
.all{display:grid;grid-template-columns:repeat(auto-fit,minmax(330px,1fr));gap:16px;margin-top:18px}
.one{background:var(--card);border-radius:10px;padding:12px}.one img{width:100%;height:auto;border-radius:8px;background:#f7f9fb}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}td{padding:2px 6px 2px 0;border-bottom:1px solid var(--line)}
td.n{text-align:right;white-space:nowrap}td.b{width:34%}i{display:block;height:9px;border-radius:3px;background:var(--bar)}
)css";

struct Figure {
  const char* name;
  double value;
  int digits;
  const char* unit;
};

std::vector<Figure> figures_of(const OrientationCandidate& one) {
  const OrientationFigures& f = one.figures;
  return {{"score", one.score, 4, ""},
          {"height", f.height, 4, "mm"},
          {"layers", static_cast<double>(f.layers), 0, ""},
          {"support", f.support_volume, 1, "mm&sup3;"},
          {"undersides", f.support_area, 1, "mm&sup2;"},
          {"mean cusp", f.cusp_error, 4, "mm"},
          {"contact", f.contact_area, 1, "mm&sup2;"},
          {"tool changes", static_cast<double>(f.tool_changes), 0, ""},
          {"x", one.lying.size.x(), 2, "mm"},
          {"y", one.lying.size.y(), 2, "mm"}};
}

/// The largest of each figure over all candidates: what a full bar is.
std::vector<double> largest_figures(const Orientations& found) {
  std::vector<double> largest;
  for (const OrientationCandidate& one : found.candidates) {
    const std::vector<Figure> figures = figures_of(one);
    largest.resize(figures.size(), 0.0);
    for (std::size_t i = 0; i < figures.size(); ++i) largest[i] = std::max(largest[i], figures[i].value);
  }
  return largest;
}

void write_picture(const OrientationCandidate& one, std::size_t number, bool from_below, const OrientationJudge& judge,
                   const OrientPage& page, std::ostream& out) {
  OrientPicture picture;
  picture.turn = one.lying.turn;
  picture.critical_angle = judge.options().critical_angle;
  picture.from_below = from_below;
  const std::string png = draw_orientation(judge.samples(), page.colors, picture);
  if (png.empty()) return;
  out << fmt::format(
      "<img width=\"{}\" height=\"{}\" alt=\"orientation {} seen from {}\" src=\"data:image/png;base64,{}\">\n",
      picture.width, picture.height, number, from_below ? "below" : "above", base64(png));
}

void write_candidate(const OrientationCandidate& one, std::size_t number, const std::vector<double>& largest,
                     const OrientationJudge& judge, const OrientPage& page, std::ostream& out) {
  out << "<div class=\"one\"><h2>" << number << ". " << xml_escape(one.origin)
      << (page.machine.empty() ? ""
          : one.fits           ? " &middot; fits"
                               : " &middot; DOES NOT FIT")
      << "</h2>\n";
  for (const bool from_below : {false, true}) write_picture(one, number, from_below, judge, page, out);
  out << "<table>\n";
  const std::vector<Figure> figures = figures_of(one);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const Figure& figure = figures[i];
    const double share = largest[i] > 0.0 ? 100.0 * figure.value / largest[i] : 0.0;
    out << fmt::format(
        "<tr><td>{}</td><td class=\"n\">{:.{}f} {}</td><td class=\"b\"><i style=\"width:{:.1f}%\"></i></td></tr>\n",
        figure.name, figure.value, figure.digits, figure.unit, share);
  }
  out << fmt::format(
      "</table>\n<p>up was ({:.5f}, {:.5f}, {:.5f}); support volume within about {:.2g} mm&sup3;</p></div>\n",
      one.up.x() + 0.0, one.up.y() + 0.0, one.up.z() + 0.0, one.support_error);
}

}  // namespace

void write_orient_page(const Orientations& found, const LeastWidth& least, const OrientationJudge& judge,
                       const OrientPage& page, std::ostream& out) {
  std::string weights;
  for (const auto& [name, weight] : page.weights)
    weights += fmt::format("{}{} {:g}", weights.empty() ? "" : ", ", xml_escape(name), weight);
  out << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      << "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>Orientations</title><style>"
      << kStyle << "</style></head><body>\n<h1>Orientations</h1>\n<p>" << xml_escape(page.source);
  if (!page.machine.empty()) out << " &middot; " << xml_escape(page.machine);
  out << fmt::format(
      "</p>\n<p>As it is: {:.6g} mm high. Least height over all orientations: {:.6g} mm; none is below "
      "{:.6g} mm (gap {:.1e}). {} orientations judged, weights: {}; layers of {:g} mm; undersides "
      "flatter than {:g}&deg; need support.</p>\n",
      page.present_height, least.height, least.proved, least.gap(), found.tried, weights, page.layer_height,
      judge.options().critical_angle * 180.0 / kPi);
  out << "<p>From above on the plate, and from below: red needs support, green lies on the plate. Bars: against the "
         "largest of the "
         "candidates shown.</p>\n<div class=\"all\">\n";
  const std::vector<double> largest = largest_figures(found);
  for (std::size_t i = 0; i < found.candidates.size(); ++i)
    write_candidate(found.candidates[i], i + 1, largest, judge, page, out);
  out << "</div></body></html>\n";
}

}  // namespace lamella
