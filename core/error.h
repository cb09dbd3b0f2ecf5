#pragma once

#include <stdexcept>
#include <string>

namespace lamella {

/// Exit codes of the command; every error knows its own.
enum class ExitCode : int { ok = 0, usage = 1, input = 2, budget = 3, output = 4, cancelled = 130 };

/// What went wrong, where (file, line, STEP entity `#123`, solid or face), and what to do about it.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, std::string what, std::string where = {}, std::string hint = {})
      : std::runtime_error(what), code_(code), where_(std::move(where)), hint_(std::move(hint)) {}

  [[nodiscard]] ExitCode code() const { return code_; }
  [[nodiscard]] const std::string& where() const { return where_; }
  [[nodiscard]] const std::string& hint() const { return hint_; }

 private:
  ExitCode code_;
  std::string where_;
  std::string hint_;
};

/// Unknown option, missing argument, an option that another one needs.
class UsageError : public Error {
 public:
  explicit UsageError(std::string what, std::string where = {}, std::string hint = {})
      : Error(ExitCode::usage, std::move(what), std::move(where), std::move(hint)) {}
};

/// A file or a setting that can't be used; nothing has been written.
class InputError : public Error {
 public:
  explicit InputError(std::string what, std::string where = {}, std::string hint = {})
      : Error(ExitCode::input, std::move(what), std::move(where), std::move(hint)) {}
};

/// Geometry outside the stated limits (degree, weights, size).
class GeometryError : public Error {
 public:
  explicit GeometryError(std::string what, std::string where = {}, std::string hint = {})
      : Error(ExitCode::input, std::move(what), std::move(where), std::move(hint)) {}
};

/// An output that could not be written.
class ExportError : public Error {
 public:
  explicit ExportError(std::string what, std::string where = {}, std::string hint = {})
      : Error(ExitCode::output, std::move(what), std::move(where), std::move(hint)) {}
};

/// The user cancelled; finished files stay, no incomplete one does.
class Cancelled : public Error {
 public:
  Cancelled() : Error(ExitCode::cancelled, "cancelled") {}
};

enum class Severity { note, warning, error };

/// A remark on the input that does not stop the run: which solid, which STEP entity, what, and what to do.
struct Finding {
  Severity severity = Severity::warning;
  std::string solid;   ///< name or path of the solid, empty when it concerns the file
  std::string face;    ///< name or number of the face, may be empty
  std::string entity;  ///< STEP entity, "#123", may be empty
  std::string what;
  std::string hint;
};

}  // namespace lamella
