#pragma once

#include "apps/stopwatch.h"
#include "slicing/layer_sink.h"

namespace lamella::apps {

/// Adds up the time that another sink takes. Calls don't overlap (LayerSink).
class TimedSink final : public LayerSink {
 public:
  explicit TimedSink(LayerSink& sink) : sink_(sink) {}
  void begin(const BuildInfo& info) override {
    timed([&] { sink_.begin(info); });
  }
  void write(const Layer& layer) override {
    timed([&] { sink_.write(layer); });
  }
  void finish(const SliceReport& report) override {
    timed([&] { sink_.finish(report); });
  }
  void abandon() noexcept override { sink_.abandon(); }

  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  void timed(const auto& call) {
    const Stopwatch watch;
    call();
    seconds_ += watch.seconds();
  }

  LayerSink& sink_;
  double seconds_ = 0.0;
};

}  // namespace lamella::apps
