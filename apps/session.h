#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/json.h"
#include "apps/terminal.h"
#include "core/error.h"
#include "core/progress.h"

namespace lamella::apps {

/// Options that every verb takes.
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  std::string threads;                 ///< as given; empty for all cores
  std::vector<std::string> arguments;  ///< the whole command line behind the program's name
};

/// What a verb needs of the program around it: where to print, how to report progress, when to stop.
class Session {
 public:
  /// Throws UsageError when the number of threads can't be used.
  Session(const CommonOptions& options, Terminal& terminal);

  [[nodiscard]] bool json() const { return json_; }
  [[nodiscard]] int threads() const { return threads_; }
  /// The command line, for the record.
  [[nodiscard]] const std::vector<std::string>& arguments() const { return arguments_; }
  [[nodiscard]] const Progress& progress() const { return progress_; }
  [[nodiscard]] Terminal& terminal() const { return terminal_; }

  /// Text for people on stdout, nothing with --json.
  void print(const std::string& text) const;
  /// One object on one line of stdout; bytes that aren't UTF-8 are replaced.
  void print(const Json& object) const;
  /// One line on stderr per warning or error; notes aren't shown. After the first 50 only their number is.
  void warn(const std::vector<Finding>& findings) const;

 private:
  bool json_;
  int threads_;
  std::vector<std::string> arguments_;
  Terminal& terminal_;
  Progress progress_;
};

/// What a verb does once the command line has been understood; the result is the exit code.
using Action = std::function<ExitCode(const Session&)>;

}  // namespace lamella::apps
