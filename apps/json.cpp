#include "apps/json.h"

namespace lamella::apps {

const char* word_of(Severity severity) {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      break;
  }
  return "error";
}

Json json_of(const Vec2& value) { return Json::array({value.x(), value.y()}); }

Json json_of(const Vec3& value) { return Json::array({value.x(), value.y(), value.z()}); }

Json json_of(const Mat3& value) {
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({value(i, 0), value(i, 1), value(i, 2)});
  return rows;
}

Json json_of(const Box3& box) {
  if (box.isEmpty() || !box.min().allFinite() || !box.max().allFinite()) return nullptr;
  return Json::array({json_of(Vec3(box.min())), json_of(Vec3(box.max()))});
}

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json json_of(const Finding& finding) {
  return {{"severity", word_of(finding.severity)},
          {"solid", text_or_null(finding.solid)},
          {"face", text_or_null(finding.face)},
          {"entity", text_or_null(finding.entity)},
          {"what", finding.what},
          {"hint", finding.hint}};
}

Json json_of(const std::vector<Finding>& findings) {
  Json out = Json::array();
  for (const Finding& finding : findings) out.push_back(json_of(finding));
  return out;
}

Json json_of(const Error& error) {
  return {{"code", static_cast<int>(error.code())},
          {"what", error.what()},
          {"where", error.where()},
          {"hint", error.hint()}};
}

std::string dump(const Json& object) { return object.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace lamella::apps
