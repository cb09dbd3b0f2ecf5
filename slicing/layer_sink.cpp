#include "slicing/layer_sink.h"

#include <algorithm>
#include <utility>

namespace lamella {

bool is_graded(const BuildInfo& info) {
  return std::any_of(info.materials.begin(), info.materials.end(), [](const Material& m) { return m.is_graded(); });
}

std::function<void()> LayerSink::prepare(const Layer& layer) {
  return [this, &layer] { write(layer); };
}

void TeeSink::begin(const BuildInfo& info) {
  for (const auto& sink : sinks_) sink->begin(info);
}

void TeeSink::write(const Layer& layer) {
  for (const auto& sink : sinks_) sink->write(layer);
}

std::function<void()> TeeSink::prepare(const Layer& layer) {
  std::vector<std::function<void()>> rests;
  for (const auto& sink : sinks_) rests.push_back(sink->prepare(layer));
  if (rests.size() == 1) return std::move(rests.front());
  return [rests = std::move(rests)] {
    for (const auto& rest : rests) rest();
  };
}

void TeeSink::finish(const SliceReport& report) {
  for (const auto& sink : sinks_) sink->finish(report);
}

void TeeSink::abandon() noexcept {
  for (const auto& sink : sinks_) sink->abandon();
}

}  // namespace lamella
