#include "slicing/accuracy/process.h"

#include <algorithm>
#include <fstream>
#include <malloc.h>
#include <stdlib.h>
#include <string>

#include "core/error.h"

namespace lamella::accuracy {

namespace {

/// A line of proc(5)'s status in bytes; zero where there is none.
double status_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kibibytes = 0.0;
    if (word == key && status >> kibibytes) return 1024.0 * kibibytes;
  }
  return 0.0;
}

}  // namespace

PeakMemory::PeakMemory() {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // proc(5): sets the peak to what is resident now
  start_ = status_bytes("VmRSS:");
}

double PeakMemory::bytes() const { return std::max(0.0, status_bytes("VmHWM:") - start_); }

ScratchFolder::ScratchFolder() {
  std::error_code error;
  std::string pattern = (std::filesystem::temp_directory_path(error) / "lamella-accuracy-XXXXXX").string();
  if (error || ::mkdtemp(pattern.data()) == nullptr) {
    throw ExportError("can't make a temporary folder", pattern, "set TMPDIR to a folder with space for STL files");
  }
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace lamella::accuracy
