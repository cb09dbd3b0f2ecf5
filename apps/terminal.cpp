#include "apps/terminal.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "core/utf8.h"

namespace lamella::apps {

namespace {

using namespace std::chrono_literals;

constexpr auto kFirstLine = 500ms;   // a line within the first second
constexpr auto kLineEvery = 1000ms;  // no more than one a second
constexpr auto kHeartbeat = 10s;     // and one now and then when nothing moves
constexpr auto kTick = 150ms;

std::shared_ptr<spdlog::logger> make_log() {
  auto log = std::make_shared<spdlog::logger>("lamella", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  log->set_pattern("lamella: %l: %v");
  log->flush_on(spdlog::level::trace);
  return log;
}

std::size_t terminal_width() {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

std::string minutes(double seconds) {
  const auto whole = static_cast<long>(std::min(seconds, 3.6e6) + 0.5);
  if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

Terminal::Terminal() : log_(make_log()), is_terminal_(::isatty(STDERR_FILENO) == 1) {}

Terminal::~Terminal() {
  if (ticker_.joinable()) {
    ticker_.request_stop();
    ticker_.join();
  }
  clear_bar();
}

void Terminal::show_progress() {
  printed_at_ = Clock::now() - kLineEvery + kFirstLine;
  ticker_ = std::jthread([this](const std::stop_token& stop) { tick(stop); });
}

void Terminal::report(std::string_view stage, double fraction) {
  const std::lock_guard lock(mutex_);
  if (stage != stage_) {
    stage_ = stage;
    stage_start_ = Clock::now();
  }
  fraction_ = fraction;
}

void Terminal::tick(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    wake_.wait_for(lock, stop, kTick, [] { return false; });
    if (stop.stop_requested() || stage_.empty()) continue;
    if (is_terminal_) {
      draw_bar();
    } else {
      print_line();
    }
  }
}

/// "slicing 45 %, 0:12 left", or with the time spent where the end isn't known.
std::string Terminal::describe() const {
  const double elapsed = std::chrono::duration<double>(Clock::now() - stage_start_).count();
  if (!(fraction_ > 0.0)) return fmt::format("{}, {} so far", stage_, minutes(elapsed));
  const double fraction = std::min(fraction_, 1.0);
  return fmt::format("{} {:.0f} %, {} left", stage_, std::floor(100.0 * fraction),
                     minutes(elapsed * (1.0 - fraction) / fraction));
}

void Terminal::draw_bar() {
  const std::string text = describe();
  const std::size_t width = terminal_width();
  std::string line = "\r\x1b[K";
  constexpr std::size_t kBar = 30;
  if (width > text.size() + kBar + 4) {
    const auto full = static_cast<std::size_t>(std::clamp(fraction_, 0.0, 1.0) * kBar);
    line += "[" + std::string(full, '#') + std::string(kBar - full, '-') + "] ";
  }
  line += text.substr(0, width - 1);
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
  bar_is_drawn_ = true;
}

void Terminal::print_line() {
  const auto since = Clock::now() - printed_at_;
  const std::string key = fmt::format("{} {:.0f}", stage_, 100.0 * fraction_);
  if (since < kLineEvery || (key == printed_ && since < kHeartbeat)) return;
  log_->info("{}", describe());
  printed_ = key;
  printed_at_ = Clock::now();
}

void Terminal::clear_bar() {
  if (!bar_is_drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  bar_is_drawn_ = false;
}

void Terminal::write(std::string_view text) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  std::fwrite(text.data(), 1, text.size(), stdout);
}

void Terminal::info(std::string_view text) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  log_->info("{}", printable(text));
}

void Terminal::warn(std::string_view text) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  log_->warn("{}", printable(text));
}

void Terminal::error(const Error& error) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  log_->error("{}", printable(one_line(error.what(), error.where(), error.hint())));
}

bool Terminal::flush() {
  const std::lock_guard lock(mutex_);
  return std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
}

std::string one_line(std::string_view what, std::string_view where, std::string_view hint) {
  std::string line(what);
  if (!where.empty()) line.append(" (").append(where).append(")");
  if (!hint.empty()) line.append("; ").append(hint);
  return line;
}

std::string printable(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint c = decode_utf8(text, at);
    const bool steers = c.value < 0x20 || (c.value >= 0x7F && c.value < 0xA0);
    if (c.length == 0 || steers) {
      out += '?';
    } else {
      out += text.substr(at, c.length);
    }
    at += std::max<std::size_t>(c.length, 1);
  }
  return out;
}

}  // namespace lamella::apps
