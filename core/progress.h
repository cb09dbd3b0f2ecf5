#pragma once

#include <atomic>
#include <functional>
#include <string_view>

#include "core/error.h"

namespace lamella {

/// Reports how far a long operation is and asks whether to stop. Copies share the callback and the flag.
/// Safe to use from several threads if the callback is.
class Progress {
 public:
  /// `stage` in the present participle ("reading"), `fraction` in [0, 1], or negative when unknown.
  using Callback = std::function<void(std::string_view stage, double fraction)>;

  Progress() = default;
  explicit Progress(Callback callback, const std::atomic<bool>* cancel = nullptr)
      : callback_(std::move(callback)), cancel_(cancel) {}

  void report(std::string_view stage, double fraction) const {
    if (callback_) callback_(stage, fraction);
  }
  [[nodiscard]] bool cancelled() const { return cancel_ != nullptr && cancel_->load(std::memory_order_relaxed); }
  void throw_if_cancelled() const {
    if (cancelled()) throw Cancelled();
  }

 private:
  Callback callback_;
  const std::atomic<bool>* cancel_ = nullptr;
};

}  // namespace lamella
