#pragma once

#include <functional>
#include <optional>
#include <string>

namespace lamella::bench {

/// CPU seconds of this process so far, all its threads.
[[nodiscard]] double cpu_seconds();

/// The largest memory of this process since forget_peak(), in MiB.
[[nodiscard]] double peak_mebibytes();

/// Gives memory that is free back to the system and starts peak_mebibytes() anew.
void forget_peak();

/// A forked copy of this process that answers one request after another. What it allocates, and how it ends, is its
/// own affair. Fork only before this process has started threads.
class Child {
 public:
  using Answer = std::function<std::string(const std::string& request)>;

  /// Forks; in the copy `make` runs first and gives the function that answers. `cpu_cap` in CPU seconds, 0 for none.
  Child(const std::function<Answer()>& make, int cpu_cap);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// The answer, or nothing when the child has died; error() then says of what.
  [[nodiscard]] std::optional<std::string> ask(const std::string& request);
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void reap();

  int pid_ = -1;
  int socket_ = -1;
  std::string error_;
};

/// The result of `work` done in a child, or nothing when it fails, dies or exceeds the CPU seconds.
[[nodiscard]] std::optional<std::string> run_in_child(const std::function<std::string()>& work, int cpu_cap);

}  // namespace lamella::bench
