#pragma once

#include <functional>

#include "apps/stopwatch.h"
#include "slicing/layer_sink.h"

namespace lamella::apps {

/// Adds up the time that another sink takes in calls that don't overlap: all but prepare(), which takes no turn.
class TimedSink final : public LayerSink {
 public:
  explicit TimedSink(LayerSink& sink) : sink_(sink) {}
  void begin(const BuildInfo& info) override {
    timed([&] { sink_.begin(info); });
  }
  void write(const Layer& layer) override {
    timed([&] { sink_.write(layer); });
  }
  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    return [this, rest = sink_.prepare(layer)] { timed(rest); };
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
