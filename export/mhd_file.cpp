#include "export/mhd_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <libdeflate.h>
#include <optional>
#include <zlib.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/utf8.h"
#include "core/xml.h"
#include "export/byte_order.h"
#include "export/deflate_writer.h"
#include "export/headed_file.h"
#include "slicing/rotation_words.h"

namespace lamella {

namespace {

constexpr std::string_view kFirstLine = "ObjectType = Image";

/// Readers of MetaIO's family skip a field that they don't know by a line of at most this many bytes.
constexpr std::size_t kMostBytes = 400;

/// A material's name as the value of a field: one line, not empty, cut between characters.
std::string field_text(const std::string& name) {
  std::string out;
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t length = std::max<std::size_t>(1, decode_utf8(name, at).length);
    if (out.size() + length > kMostBytes) break;
    const bool is_control = length == 1 && static_cast<unsigned char>(name[at]) < ' ';
    out += is_control ? " " : name.substr(at, length);
    at += length;
  }
  return out.empty() ? "-" : out;
}

/// What labels mean and how the assembly was turned, in fields of our own: MetaIO has none for it.
std::string own_fields(const BuildInfo& info) {
  std::string out = "Comment = Lamella labels: 0 is void, 1 is Material1 and so on\n";
  for (const MaterialId id : info.materials.ids()) {
    out += fmt::format("Material{} = {}\n", 1 + id.value(), field_text(info.materials[id].name));
  }
  if (info.turn) out += fmt::format("Rotation = {}\n", rotation_text(*info.turn));
  return out;
}

std::string vector_text(const Vec3& v) {
  return fmt::format("{} {} {}", format_double(v.x()), format_double(v.y()), format_double(v.z()));
}

/// The header states the name on a line of its own and has no way to quote.
void check_name(const std::string& name) {
  const bool is_line =
      std::none_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7F'; });
  if (!is_line) throw UsageError("the header can't name data with a control character", name, "choose another name");
}

class MhdFile final : public VolumeFile {
 public:
  MhdFile(std::filesystem::path path, bool is_raw)
      : path_(std::move(path)), data_path_(mhd_data_place(path_, is_raw)), is_raw_(is_raw) {
    if (data_path_ == path_)
      throw UsageError("the header would have the name of its data", path_.string(), "name it .mhd");
    check_name(data_path_.filename().string());
  }

  void begin(const BuildInfo& info, const Volume& volume) override {
    volume_ = volume;
    own_fields_ = own_fields(info);
    prepare_target(path_);
    data_.emplace(data_path_, 0);
    if (!is_raw_) data_->append("\x78\x01");  // zlib
  }

  [[nodiscard]] EncodedSlice encode(std::span<const std::uint8_t> labels) const override {
    if (is_raw_) return {{labels.begin(), labels.end()}};
    return {deflate_rows(labels, volume_.row_bytes(), static_cast<std::size_t>(volume_.label_bytes), true),
            libdeflate_adler32(1, labels.data(), labels.size())};
  }

  void add(const EncodedSlice& slice) override {
    data_->append(slice.bytes);
    sum_ = adler32_combine(sum_, slice.checksum, static_cast<z_off_t>(volume_.slice_bytes()));
  }

  void finish(const Volume& volume) override {
    if (!is_raw_) {
      std::string end = deflate_rows({}, 1, 1);
      append_big_endian(end, static_cast<std::uint32_t>(sum_));
      data_->append(end);
    }
    data_->commit();
    write_file_atomically(path_, header_text(volume));
  }

 private:
  [[nodiscard]] std::string header_text(const Volume& volume) const {
    std::string out = fmt::format("{}\n", kFirstLine);
    out += "NDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n";
    out += fmt::format("CompressedData = {}\n", is_raw_ ? "False" : "True");
    if (!is_raw_) out += fmt::format("CompressedDataSize = {}\n", data_->appended());
    out += "TransformMatrix = 1 0 0 0 1 0 0 0 1\n";
    out += fmt::format("Offset = {}\nCenterOfRotation = 0 0 0\nElementSpacing = {}\n",
                       vector_text(volume.first_centre()), vector_text(volume.pitch));
    out += fmt::format("DimSize = {} {} {}\n", volume.size[0], volume.size[1], volume.size[2]);
    out += own_fields_;
    out += fmt::format("ElementType = {}\nElementDataFile = {}\n", volume.label_bytes == 1 ? "MET_UCHAR" : "MET_USHORT",
                       data_path_.filename().string());
    return out;
  }

  std::filesystem::path path_;
  std::filesystem::path data_path_;
  bool is_raw_;
  Volume volume_;
  std::string own_fields_;
  std::optional<HeadedFile> data_;
  uLong sum_ = 1;
};

}  // namespace

std::filesystem::path mhd_data_place(std::filesystem::path file, bool is_raw) {
  return file.replace_extension(is_raw ? ".raw" : ".zraw");
}

std::filesystem::path mhd_data_file(const std::filesystem::path& file) {
  constexpr std::string_view kKey = "ElementDataFile = ";
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line) || line != kFirstLine) return {};
  while (std::getline(stream, line)) {
    if (!line.starts_with(kKey)) continue;
    const std::filesystem::path data = file.parent_path() / line.substr(kKey.size());
    std::error_code failure;
    return std::filesystem::is_regular_file(data, failure) ? data : std::filesystem::path();
  }
  return {};
}

std::unique_ptr<LayerSink> make_mhd_sink(const std::filesystem::path& file, const VolumeOptions& options) {
  return make_volume_sink(std::make_unique<MhdFile>(file, options.is_raw), options, "MetaImage");
}

}  // namespace lamella
