#include "slicing/layer_sink.h"

namespace lamella {

void TeeSink::begin(const BuildInfo& info) {
  for (const auto& sink : sinks_) sink->begin(info);
}

void TeeSink::write(const Layer& layer) {
  for (const auto& sink : sinks_) sink->write(layer);
}

void TeeSink::finish(const SliceReport& report) {
  for (const auto& sink : sinks_) sink->finish(report);
}

void TeeSink::abandon() noexcept {
  for (const auto& sink : sinks_) sink->abandon();
}

}  // namespace lamella
