#pragma once

#include <chrono>
#include <filesystem>

/// What the study asks of the system around it.
namespace lamella::accuracy {

/// Wall time since it was made, in seconds.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// By how much the process's resident memory has grown at most since it was made. Memory that was freed before counts
/// as free, as far as the allocator gives it back.
class PeakMemory {
 public:
  PeakMemory();
  /// Zero where the system doesn't say.
  [[nodiscard]] double bytes() const;

 private:
  double start_ = 0.0;
};

/// A fresh folder among the system's temporary ones, removed with the object.
class ScratchFolder {
 public:
  /// Throws ExportError.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace lamella::accuracy
