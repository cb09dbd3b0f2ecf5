#include "core/atomic_file.h"

#include <atomic>
#include <fstream>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "core/error.h"

namespace lamella {

namespace fs = std::filesystem;

namespace {

/// Unique within the process by a counter and between processes by the process id.
fs::path temporary_name(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  const std::string suffix = ".part-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
  return target.parent_path() / (target.filename().string() + suffix);
}

}  // namespace

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)), temporary_(temporary_name(target_)) {}

AtomicFile::~AtomicFile() { discard(); }

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : target_(std::move(other.target_)), temporary_(std::exchange(other.temporary_, {})) {}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
  if (this != &other) {
    discard();
    target_ = std::move(other.target_);
    temporary_ = std::exchange(other.temporary_, {});
  }
  return *this;
}

void AtomicFile::commit() {
  std::error_code failure;
  fs::rename(temporary_, target_, failure);
  if (failure) throw ExportError("can't write file: " + failure.message(), target_.string());
  temporary_.clear();
}

void AtomicFile::discard() noexcept {
  if (temporary_.empty()) return;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void write_file_atomically(const fs::path& target, std::string_view bytes) {
  AtomicFile file(target);
  std::ofstream stream(file.temporary(), std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) {
    throw ExportError("can't write file", target.string(), "check the folder's permissions and free space");
  }
  file.commit();
}

void make_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw ExportError("can't create folder: " + failure.message(), folder.string());
}

}  // namespace lamella
