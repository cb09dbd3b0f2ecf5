#include "export/zip_writer.h"

#include <libdeflate.h>

#include "core/error.h"

namespace lamella {

namespace {

constexpr std::uint64_t kMostBytes = 0xFFFFFFFF;
constexpr std::size_t kMostEntries = 0xFFFF;
constexpr std::uint32_t kFirstDay = 1U << 21 | 1U << 16;  // 1 January 1980, 0:00

void append(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>(value >> (8 * i)));
}

/// What the header before an entry and the table of contents have in common.
std::string entry_fields(std::string_view name, std::string_view bytes) {
  std::string out;
  append(out, 10, 2);        // version needed to extract: 1.0
  append(out, 1U << 11, 2);  // names are UTF-8
  append(out, 0, 2);         // stored
  append(out, kFirstDay, 4);
  append(out, libdeflate_crc32(0, bytes.data(), bytes.size()), 4);
  append(out, bytes.size(), 4);
  append(out, bytes.size(), 4);
  append(out, name.size(), 2);
  append(out, 0, 2);  // no extra field
  return out;
}

}  // namespace

void ZipWriter::add(std::string_view name, std::string_view bytes) {
  const std::string fields = entry_fields(name, bytes);
  // The table of contents has 46 bytes and the name for each entry, the end 22.
  const std::uint64_t after = size_ + 30 + name.size() + bytes.size() + contents_.size() + 46 + name.size() + 22;
  if (after > kMostBytes || entries_ == kMostEntries) {
    throw UsageError("the archive would have more than 4 GiB or 65535 entries", "", "export a range of --layers");
  }
  append(contents_, 0x02014B50, 4);
  append(contents_, 20, 2);  // made by version 2.0 for MS-DOS
  contents_ += fields;
  append(contents_, 0, 2 + 2 + 2 + 4);  // no comment, disk 0, no attributes
  append(contents_, size_, 4);
  contents_ += name;

  std::string header;
  append(header, 0x04034B50, 4);
  header += fields;
  header += name;
  file_.stream() << header << bytes;
  file_.check();
  size_ += header.size() + bytes.size();
  ++entries_;
}

void ZipWriter::commit() {
  std::string end = contents_;
  append(end, 0x06054B50, 4);
  append(end, 0, 4);  // disks
  append(end, entries_, 2);
  append(end, entries_, 2);
  append(end, contents_.size(), 4);
  append(end, size_, 4);
  append(end, 0, 2);
  file_.stream() << end;
  file_.commit();
}

}  // namespace lamella
