#include "export/output_file.h"

#include <system_error>

#include "core/error.h"

namespace lamella {

namespace fs = std::filesystem;

void prepare_target(const fs::path& target) {
  if (target.filename().empty()) throw ExportError("the output has no file name", target.string());
  if (target.has_parent_path()) make_folder(target.parent_path());
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(target, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw ExportError("the output exists and is not a regular file", target.string(), "choose another name");
  }
}

namespace {

const fs::path& prepared(const fs::path& target) {
  prepare_target(target);
  return target;
}

}  // namespace

OutputFile::OutputFile(const fs::path& target) : file_(prepared(target)) {
  stream_.open(file_.temporary(), std::ios::binary | std::ios::trunc);
  check();
}

void OutputFile::check() {
  if (stream_) return;
  throw ExportError("can't write file", file_.target().string(), "check the folder's permissions and free space");
}

void OutputFile::commit() {
  stream_.close();
  check();
  file_.commit();
}

}  // namespace lamella
