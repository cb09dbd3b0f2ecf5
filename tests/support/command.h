#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/wait.h>

#include "tests/support/paths.h"

/// Runs programs as a user would, through the shell.
namespace lamella::test {

struct CommandResult {
  int exit_code = -1;  ///< 128 + signal when killed
  std::string output;  ///< stdout
  std::string errors;  ///< stderr
};

struct CommandLimits {
  int seconds = 120;    ///< wall time, after which the program is killed (exit code 124)
  long long bytes = 0;  ///< address space, 0 for no limit
};

inline std::string quoted(const std::filesystem::path& path) {
  std::string text = "'";
  for (const char c : path.string()) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// Runs `line` in a shell with the limits and returns what it printed and how it ended.
inline CommandResult run_command(const std::string& line, const CommandLimits& limits = {}) {
  const TemporaryFolder folder;
  std::string guarded;
  if (limits.bytes > 0) guarded += "ulimit -v " + std::to_string(limits.bytes / 1024) + "; ";
  guarded += "timeout " + std::to_string(limits.seconds) + " " + line;
  guarded += " > " + quoted(folder / "out") + " 2> " + quoted(folder / "err");
  const int status = std::system(guarded.c_str());
  const auto read = [&](const char* name) {
    std::ifstream stream(folder / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, read("out"), read("err")};
}

/// The command that this build made.
inline std::filesystem::path lamella_binary() { return std::filesystem::path(LAMELLA_BINARY_DIR) / "bin" / "lamella"; }

inline CommandResult run_lamella(const std::string& arguments, const CommandLimits& limits = {}) {
  return run_command(quoted(lamella_binary()) + " " + arguments, limits);
}

}  // namespace lamella::test
