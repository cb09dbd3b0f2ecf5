#include "export/package_file.h"

#include <cstdint>
#include <memory>
#include <zip.h>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lamella {

namespace {

/// The earliest date that ZIP knows, 1 January 1980, as DOS packs it; given as it is, for libzip's own dates follow
/// the time zone.
constexpr std::uint16_t kDosDate = (1 << 5) | 1;
constexpr std::uint16_t kDosTime = 0;

/// libzip's own choice, 9, makes an export of 34 MB of text take 2.6 times as long for 6 % less.
constexpr zip_uint32_t kDeflateLevel = 5;

constexpr std::int64_t kToTheEnd = -1;

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, Discard>;

class PackageWriter {
 public:
  explicit PackageWriter(const std::filesystem::path& target) : file_(target) {
    int code = 0;
    archive_.reset(zip_open(file_.temporary().c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
    if (!archive_) refuse("");
  }

  void add(const std::string& name, zip_source_t* source, zip_int32_t method) {
    if (source == nullptr) refuse(zip_strerror(archive_.get()));
    const zip_int64_t index = zip_file_add(archive_.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      refuse(zip_strerror(archive_.get()));
    }
    const auto entry = static_cast<zip_uint64_t>(index);
    if (zip_set_file_compression(archive_.get(), entry, method, method == ZIP_CM_DEFLATE ? kDeflateLevel : 0) != 0) {
      refuse(zip_strerror(archive_.get()));
    }
    if (zip_file_set_dostime(archive_.get(), entry, kDosTime, kDosDate, 0) != 0) refuse(zip_strerror(archive_.get()));
  }
  [[nodiscard]] zip_source_t* source_of(const std::string& bytes) {
    return zip_source_buffer(archive_.get(), bytes.data(), bytes.size(), 0);
  }
  [[nodiscard]] zip_source_t* source_of(const std::filesystem::path& file, std::uint64_t begin = 0,
                                        std::int64_t bytes = kToTheEnd) {
    return zip_source_file(archive_.get(), file.c_str(), begin, bytes);
  }

  void finish() {
    if (zip_close(archive_.get()) != 0) refuse(zip_strerror(archive_.get()));
    (void)archive_.release();
    file_.commit();
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw ExportError("can't write file" + (why.empty() ? why : ": " + why), file_.target().string(),
                      "check the folder's permissions and free space");
  }

  AtomicFile file_;
  Archive archive_;  ///< closed before its file goes
};

}  // namespace

void write_package(const std::filesystem::path& target, const PackageParts& parts) {
  PackageWriter writer(target);
  for (const auto& [name, bytes] : parts.texts) writer.add(name, writer.source_of(bytes), ZIP_CM_DEFLATE);
  for (const auto& [name, file] : parts.files) writer.add(name, writer.source_of(file), ZIP_CM_DEFLATE);
  for (const FilePart& part : parts.image_parts) {
    writer.add(part.name, writer.source_of(parts.images, part.begin, static_cast<std::int64_t>(part.bytes)),
               ZIP_CM_STORE);
  }
  writer.finish();
}

}  // namespace lamella
