#include "apps/session.h"

#include "apps/options.h"
#include "apps/signals.h"

namespace lamella::apps {

namespace {

constexpr long kMaxThreads = 1024;

std::string place_of(const Finding& finding) {
  std::string where;
  const auto add = [&where](const char* kind, const std::string& text) {
    if (!text.empty()) where.append(where.empty() ? "" : ", ").append(kind).append(text);
  };
  add("solid ", finding.solid);
  add("", finding.face);
  add("", finding.entity);
  return where;
}

}  // namespace

Session::Session(const CommonOptions& options, Terminal& terminal)
    : json_(options.json),
      threads_(options.threads.empty() ? 0
                                       : static_cast<int>(parse_whole("--threads", options.threads, 1, kMaxThreads))),
      arguments_(options.arguments),
      terminal_(terminal),
      progress_([&terminal](std::string_view stage, double fraction) { terminal.report(stage, fraction); },
                &cancel_flag()) {
  if (!options.quiet) terminal.show_progress();
}

void Session::print(const std::string& text) const {
  if (!json_) terminal_.write(text);
}

void Session::print(const Json& object) const { terminal_.write(dump(object) + "\n"); }

void Session::warn(const std::vector<Finding>& findings) const {
  constexpr std::size_t kShown = 50;
  std::size_t count = 0;
  for (const Finding& finding : findings) {
    if (finding.severity == Severity::note || ++count > kShown) continue;
    terminal_.warn(one_line(finding.what, place_of(finding), finding.hint));
  }
  if (count > kShown) {
    terminal_.warn(one_line(std::to_string(count - kShown) + " more warnings", "", "--json lists them all"));
  }
}

}  // namespace lamella::apps
