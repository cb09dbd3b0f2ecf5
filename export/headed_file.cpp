#include "export/headed_file.h"

namespace lamella {

HeadedFile::HeadedFile(const std::filesystem::path& path, std::size_t header_bytes)
    : file_(path), header_bytes_(header_bytes) {
  file_.stream() << std::string(header_bytes, '\0');
}

void HeadedFile::append(std::string_view bytes) {
  file_.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file_.check();
  appended_ += bytes.size();
}

void HeadedFile::write_header(std::size_t at, std::string_view bytes) {
  file_.stream().seekp(static_cast<std::streamoff>(at));
  file_.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace lamella
