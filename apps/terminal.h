#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "core/error.h"

namespace spdlog {
class logger;
}

namespace lamella::apps {

/// stdout and stderr of the program: results on one, the log and the progress on the other.
///
/// On a terminal the progress is a bar that is redrawn a few times a second; elsewhere it is at most one line a second,
/// the first within the first second. All members may be called from any thread.
class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Starts to show progress (not with --quiet).
  void show_progress();
  /// How far the current stage is; see Progress.
  void report(std::string_view stage, double fraction);

  /// Writes `text` to stdout as it is.
  void write(std::string_view text);
  /// One line on stderr each, "lamella: LEVEL: ..."; characters that steer terminals are replaced.
  void info(std::string_view text);
  void warn(std::string_view text);
  void error(const Error& error);

  /// Flushes stdout; false when something could not be written (a full disk).
  [[nodiscard]] bool flush();

 private:
  using Clock = std::chrono::steady_clock;

  void tick(const std::stop_token& stop);
  void draw_bar();
  void print_line();
  void clear_bar();
  [[nodiscard]] std::string describe() const;

  std::shared_ptr<spdlog::logger> log_;
  const bool is_terminal_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::string stage_;
  double fraction_ = -1.0;
  Clock::time_point stage_start_ = Clock::now();
  std::string printed_;
  Clock::time_point printed_at_ = Clock::now();
  bool bar_is_drawn_ = false;
  std::jthread ticker_;
};

/// WHAT (WHERE); HINT
[[nodiscard]] std::string one_line(std::string_view what, std::string_view where, std::string_view hint);

/// `text` on one line, control characters and bytes that aren't UTF-8 replaced by '?'.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace lamella::apps
