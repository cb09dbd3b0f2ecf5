#include "export/tiff_file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <vector>

#include "core/xml.h"
#include "export/byte_order.h"
#include "export/deflate_writer.h"
#include "export/headed_file.h"
#include "slicing/rotation_words.h"

namespace lamella {

namespace {

constexpr std::size_t kHeaderBytes = 16;  // of a BigTIFF; a classic one leaves half of it unused

enum Tag : std::uint16_t {
  kImageWidth = 256,
  kImageLength = 257,
  kBitsPerSample = 258,
  kCompression = 259,
  kPhotometric = 262,
  kImageDescription = 270,
  kStripOffsets = 273,
  kSamplesPerPixel = 277,
  kRowsPerStrip = 278,
  kStripByteCounts = 279,
  kXResolution = 282,
  kYResolution = 283,
  kResolutionUnit = 296,
  kSoftware = 305,
};

/// Types of values with their sizes in bytes.
enum class Type : std::uint16_t { ascii = 2, short_ = 3, long_ = 4, rational = 5, long8 = 16 };

/// A directory of one page: entries in ascending order of tags, and values that don't fit into their entry behind them.
class Directory {
 public:
  /// `place` in the file where it will stand.
  Directory(bool is_big, std::uint64_t place, std::size_t entries)
      : is_big_(is_big), place_(place), entries_(entries) {}

  void add(Tag tag, Type type, std::uint64_t value) {
    const int bytes = type == Type::short_ ? 2 : type == Type::long_ ? 4 : 8;
    begin_entry(tag, type, 1);
    append_little_endian(table_, value, bytes);
    append_little_endian(table_, 0, word() - bytes);
  }
  /// Values that are longer than a word.
  void add(Tag tag, Type type, std::uint64_t count, const std::string& bytes) {
    begin_entry(tag, type, count);
    if (bytes.size() <= static_cast<std::size_t>(word())) {
      table_ += bytes;
      append_little_endian(table_, 0, word() - static_cast<int>(bytes.size()));
      return;
    }
    append_little_endian(table_, place_ + size() + values_.size(), word());
    values_ += bytes;
    if (values_.size() % 2 != 0) values_.push_back('\0');  // values begin on even bytes
  }

  /// `is_last`: else the next directory follows at once.
  [[nodiscard]] std::string bytes(bool is_last) const {
    std::string out;
    append_little_endian(out, entries_, is_big_ ? 8 : 2);
    out += table_;
    append_little_endian(out, is_last ? 0 : place_ + size() + values_.size(), word());
    return out + values_;
  }

 private:
  [[nodiscard]] int word() const { return is_big_ ? 8 : 4; }
  [[nodiscard]] std::uint64_t size() const { return is_big_ ? 16 + 20 * entries_ : 6 + 12 * entries_; }
  void begin_entry(Tag tag, Type type, std::uint64_t count) {
    append_little_endian(table_, tag, 2);
    append_little_endian(table_, static_cast<std::uint64_t>(type), 2);
    append_little_endian(table_, count, word());
  }

  bool is_big_;
  std::uint64_t place_;
  std::size_t entries_;
  std::string table_;
  std::string values_;
};

/// Pixels per mm as a fraction of 32-bit numbers, to nine digits.
std::string resolution(double pitch) {
  constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
  const double value = 1.0 / pitch;
  const double below = std::clamp(std::floor(kMost / value), 1.0, 1e9);
  std::string out;
  append_little_endian(out, static_cast<std::uint64_t>(std::clamp(std::round(value * below), 1.0, kMost)), 4);
  append_little_endian(out, static_cast<std::uint64_t>(below), 4);
  return out;
}

class TiffFile final : public VolumeFile {
 public:
  TiffFile(std::filesystem::path path, const TiffOptions& options) : path_(std::move(path)), options_(options) {}

  void begin(const BuildInfo& info, const Volume& volume) override {
    info_ = info;
    volume_ = volume;
    file_.emplace(path_, kHeaderBytes);
  }

  [[nodiscard]] EncodedSlice encode(std::span<const std::uint8_t> labels) const override {
    if (options_.volume.is_raw) return {{labels.begin(), labels.end()}};
    return {zlib_rows(labels, volume_.row_bytes(), static_cast<std::size_t>(volume_.label_bytes))};
  }

  void add(const EncodedSlice& slice) override {
    pages_.push_back({file_->header_bytes() + file_->appended(), slice.bytes.size()});
    file_->append(slice.bytes);  // without a gap: ImageJ takes pages that aren't compressed for one block
  }

  void finish(const Volume& volume) override {
    if (file_->appended() % 2 != 0) file_->append(std::string_view("\0", 1));  // directories begin on even bytes
    const std::string text = description(volume);
    const std::uint64_t place = file_->header_bytes() + file_->appended();
    // 300 bytes are more than a directory of either kind with its values has, but for the description.
    const bool is_big = place + 300 * pages_.size() + text.size() >= options_.big_from;
    for (std::size_t page = 0; page < pages_.size(); ++page) {
      const std::uint64_t at = file_->header_bytes() + file_->appended();
      file_->append(directory(volume, page, at, is_big, page == 0 ? text : ""));
    }
    std::string header = "II";
    append_little_endian(header, is_big ? 43 : 42, 2);
    if (is_big) append_little_endian(header, 8, 4);  // bytes of an offset
    append_little_endian(header, place, is_big ? 8 : 4);
    file_->write_header(0, header);
    file_->commit();
  }

 private:
  struct Page {
    std::uint64_t offset;
    std::uint64_t bytes;
  };

  /// What ImageJ reads, and the names of the materials by label.
  [[nodiscard]] std::string description(const Volume& volume) const {
    std::string out = fmt::format("ImageJ=1.53t\nimages={0}\nslices={0}\nunit=mm\nspacing={1}\nloop=false\n",
                                  pages_.size(), format_double(volume.pitch.z()));
    out += fmt::format("min=0.0\nmax={}.0\n", info_.materials.size());
    out += fmt::format("origin_mm={} {} {}\n", format_double(volume.origin.x()), format_double(volume.origin.y()),
                       format_double(volume.origin.z()));
    if (info_.turn) out += fmt::format("rotation={}\n", rotation_text(*info_.turn));
    for (const MaterialId id : info_.materials.ids()) {
      std::string name = info_.materials[id].name;
      for (char& c : name) c = static_cast<unsigned char>(c) < ' ' ? ' ' : c;
      out += fmt::format("material_{}={}\n", 1 + id.value(), name);
    }
    out.push_back('\0');
    return out;
  }

  [[nodiscard]] std::string directory(const Volume& volume, std::size_t page, std::uint64_t place, bool is_big,
                                      const std::string& text) const {
    constexpr std::size_t kEntries = 13;
    constexpr std::string_view kSoftwareName("Lamella\0", 8);
    const Type offset = is_big ? Type::long8 : Type::long_;
    Directory out(is_big, place, kEntries + (text.empty() ? 0 : 1));
    out.add(kImageWidth, Type::long_, static_cast<std::uint64_t>(volume.size[0]));
    out.add(kImageLength, Type::long_, static_cast<std::uint64_t>(volume.size[1]));
    out.add(kBitsPerSample, Type::short_, static_cast<std::uint64_t>(8 * volume.label_bytes));
    out.add(kCompression, Type::short_, options_.volume.is_raw ? 1 : 8);
    out.add(kPhotometric, Type::short_, 1);  // 0 is black
    if (!text.empty()) out.add(kImageDescription, Type::ascii, text.size(), text);
    out.add(kStripOffsets, offset, pages_[page].offset);
    out.add(kSamplesPerPixel, Type::short_, 1);
    out.add(kRowsPerStrip, Type::long_, static_cast<std::uint64_t>(volume.size[1]));
    out.add(kStripByteCounts, offset, pages_[page].bytes);
    out.add(kXResolution, Type::rational, 1, resolution(volume.pitch.x()));
    out.add(kYResolution, Type::rational, 1, resolution(volume.pitch.y()));
    out.add(kResolutionUnit, Type::short_, 1);  // none: ImageJ takes that of the description
    out.add(kSoftware, Type::ascii, kSoftwareName.size(), std::string(kSoftwareName));
    return out.bytes(page + 1 == pages_.size());
  }

  std::filesystem::path path_;
  TiffOptions options_;
  BuildInfo info_;
  Volume volume_;
  std::optional<HeadedFile> file_;
  std::vector<Page> pages_;
};

}  // namespace

std::unique_ptr<LayerSink> make_tiff_sink(const std::filesystem::path& file, const TiffOptions& options) {
  return make_volume_sink(std::make_unique<TiffFile>(file, options), options.volume, "TIFF");
}

}  // namespace lamella
