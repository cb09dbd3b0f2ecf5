#include "export/vti_file.h"

#include <fmt/format.h>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/xml.h"
#include "export/deflate_writer.h"
#include "export/headed_file.h"
#include "slicing/rotation_words.h"

namespace lamella {

namespace {

constexpr std::size_t kRoom = 256;  // for numbers that turn out longer than expected

std::string vector_text(const Vec3& v) {
  return fmt::format("{} {} {}", format_double(v.x()), format_double(v.y()), format_double(v.z()));
}

/// Little-endian 64-bit numbers.
std::string bytes_of(const std::vector<std::uint64_t>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(std::uint64_t)};
}

/// The names of the materials by label as VTK has strings: codes of characters, each string ended by a zero.
std::string names_text(const BuildInfo& info) {
  std::string out = fmt::format("<Array type=\"String\" Name=\"materials\" NumberOfTuples=\"{}\" format=\"ascii\">",
                                info.materials.size() + 1);
  const auto append = [&](const std::string& name) {
    for (const char c : name) out += fmt::format("{} ", static_cast<unsigned char>(c));
    out += "0 ";
  };
  append("void");
  for (const Material& material : info.materials) append(material.name);
  return out + "</Array>";
}

/// How the assembly was turned, if it was.
std::string rotation_array(const BuildInfo& info) {
  if (!info.turn) return {};
  return fmt::format(
      "<DataArray type=\"Float64\" Name=\"rotation\" NumberOfComponents=\"9\" NumberOfTuples=\"1\" "
      "format=\"ascii\">{}</DataArray>",
      rotation_text(*info.turn));
}

/// `offset` of the data behind the underscore.
std::string header_text(const BuildInfo& info, const Volume& volume, bool is_raw, std::uint64_t offset) {
  const std::string extent = fmt::format("0 {} 0 {} 0 {}", volume.size[0], volume.size[1], volume.size[2]);
  std::string out = "<?xml version=\"1.0\"?>\n";
  out +=
      fmt::format("<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{}>\n",
                  is_raw ? "" : " compressor=\"vtkZLibDataCompressor\"");
  out += fmt::format("<ImageData WholeExtent=\"{}\" Origin=\"{}\" Spacing=\"{}\">\n", extent,
                     vector_text(volume.origin), vector_text(volume.pitch));
  out += fmt::format("<FieldData>{}{}</FieldData>\n<Piece Extent=\"{}\">\n<CellData Scalars=\"material\">\n",
                     names_text(info), rotation_array(info), extent);
  out += fmt::format("<DataArray type=\"{}\" Name=\"material\" format=\"appended\" offset=\"{}\"/>\n",
                     volume.label_bytes == 1 ? "UInt8" : "UInt16", offset);
  return out + "</CellData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n";
}

/// Each slice is a block; the table of their sizes stands before them and is filled in at the end.
class VtiFile final : public VolumeFile {
 public:
  VtiFile(std::filesystem::path path, bool is_raw) : path_(std::move(path)), is_raw_(is_raw) {}

  void begin(const BuildInfo& info, const Volume& volume) override {
    info_ = info;
    volume_ = volume;
    text_bytes_ = header_text(info, volume, is_raw_, 0).size() + kRoom;
    const std::size_t numbers = is_raw_ ? 1 : 3 + static_cast<std::size_t>(volume.size[2]);
    file_.emplace(path_, text_bytes_ + numbers * sizeof(std::uint64_t));
  }

  [[nodiscard]] EncodedSlice encode(std::span<const std::uint8_t> labels) const override {
    if (is_raw_) return {{labels.begin(), labels.end()}};
    return {zlib_rows(labels, volume_.row_bytes(), static_cast<std::size_t>(volume_.label_bytes))};
  }

  void add(const EncodedSlice& slice) override {
    file_->append(slice.bytes);
    sizes_.push_back(slice.bytes.size());
  }

  void finish(const Volume& volume) override {
    file_->append("\n</AppendedData>\n</VTKFile>\n");
    std::vector<std::uint64_t> numbers{volume.slice_bytes() * sizes_.size()};
    if (!is_raw_) {
      numbers = {sizes_.size(), volume.slice_bytes(), 0};  // no last block that is shorter
      numbers.insert(numbers.end(), sizes_.begin(), sizes_.end());
    }
    const std::string table = bytes_of(numbers);
    const std::size_t place = file_->header_bytes() - table.size();  // next to the blocks
    std::string text = header_text(info_, volume, is_raw_, place - text_bytes_);
    text += std::string(text_bytes_ - text.size() - 1, ' ') + '_';
    text += std::string(place - text_bytes_, '\0');
    file_->write_header(0, text + table);
    file_->commit();
  }

 private:
  std::filesystem::path path_;
  bool is_raw_;
  BuildInfo info_;
  Volume volume_;
  std::size_t text_bytes_ = 0;
  std::optional<HeadedFile> file_;
  std::vector<std::uint64_t> sizes_;
};

}  // namespace

std::unique_ptr<LayerSink> make_vti_sink(const std::filesystem::path& file, const VolumeOptions& options) {
  return make_volume_sink(std::make_unique<VtiFile>(file, options.is_raw), options, "VTK image data");
}

}  // namespace lamella
