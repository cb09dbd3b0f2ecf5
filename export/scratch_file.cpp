#include "export/scratch_file.h"

#include "core/error.h"

namespace lamella {

ScratchFile::ScratchFile(const std::filesystem::path& beside) : file_(beside) {
  stream_.open(file_.temporary(), std::ios::binary | std::ios::trunc);
  check();
}

void ScratchFile::check() {
  if (stream_) return;
  throw ExportError("can't write a temporary file", file_.temporary().string(),
                    "check the folder's permissions and free space");
}

void ScratchFile::close() {
  stream_.close();
  check();
}

void ScratchFile::append_to(std::ostream& out) const {
  std::error_code failure;
  if (std::filesystem::file_size(file_.temporary(), failure) == 0 && !failure) return;
  std::ifstream in(file_.temporary(), std::ios::binary);
  if (!(out << in.rdbuf())) throw ExportError("can't copy a temporary file", file_.temporary().string());
}

}  // namespace lamella
