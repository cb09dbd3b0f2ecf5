#include "export/sl1_archives.h"

#include <deque>
#include <fmt/format.h>
#include <functional>
#include <span>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/xml.h"
#include "export/build_check.h"
#include "export/file_name.h"
#include "export/material_folder.h"
#include "export/material_runs.h"
#include "export/package_file.h"
#include "export/png_image.h"
#include "export/scratch_file.h"
#include "export/uniform_z.h"

namespace lamella {

namespace {

constexpr unsigned kWhite = 255;

/// `text` as the value of a key: one line.
std::string one_line(std::string text) {
  for (char& c : text) c = static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  return text;
}

/// config.ini, by which a printer knows the job. Times are neutral: they are the printer's to choose.
std::string config_text(const Material& material, const std::string& job, double height, std::int64_t layers,
                        double used_ml) {
  std::string out = "action = print\nexpTime = 0\nexpTimeFirst = 0\nexpUserProfile = 0\n";
  out += "fileCreationTimestamp = 1980-01-01 at 00:00:00 UTC\nhollow = 0\n";
  out += fmt::format("jobDir = {}\nlayerHeight = {}\nmaterialName = {}\n", job, format_double(height),
                     one_line(material.name));
  out += fmt::format("numFade = 0\nnumFast = {}\nnumSlow = 0\n", layers);
  out += "printProfile = Lamella\nprintTime = 0\nprinterModel = SL1\nprinterProfile = Lamella\n";
  out += "printerVariant = default\nprusaSlicerVersion = Lamella\n";
  return out + fmt::format("usedMaterial = {}\n", format_double(used_ml));
}

/// prusaslicer.ini, by which the archive can be imported again: the display is the raster.
std::string display_text(const Grid& grid, const Sl1Display& display, double height) {
  const auto length = [&](int axis) { return format_double(static_cast<double>(grid.size[axis]) * grid.pitch[axis]); };
  std::string out = "display_height = " + length(1) + "\n";
  out +=
      fmt::format("display_mirror_x = {}\ndisplay_mirror_y = {}\n", display.mirror_x ? 1 : 0, display.mirror_y ? 1 : 0);
  out += fmt::format("display_orientation = {}\n", display.is_portrait ? "portrait" : "landscape");
  out += fmt::format("display_pixels_x = {}\ndisplay_pixels_y = {}\n", grid.size[0], grid.size[1]);
  out += "display_width = " + length(0) + "\n";
  return out + fmt::format("initial_layer_height = {0}\nlayer_height = {0}\nprinter_technology = SLA\n",
                           format_double(height));
}

/// Beyond these printers don't read an archive; the texts, the table of contents and what is around entries are small
/// next to the second.
constexpr std::size_t kMostPictures = 65'000;
constexpr std::uint64_t kMostBytes = 0xF0000000;

/// The pictures of one material, written until the archive is made of them.
struct Pictures {
  explicit Pictures(const std::filesystem::path& archive) : target(archive), file(archive) {}

  std::filesystem::path target;
  ScratchFile file;
  std::vector<FilePart> parts;
  std::int64_t pixels = 0;  ///< white ones

  void add(const std::string& name, const std::string& png) {
    const std::uint64_t begin = parts.empty() ? 0 : parts.back().begin + parts.back().bytes;
    if (parts.size() == kMostPictures || begin + png.size() > kMostBytes) {
      throw UsageError("the archive would have more than 65000 pictures or 3.7 GiB", target.string(),
                       "export a range of --layers");
    }
    file.stream() << png;
    file.check();
    parts.push_back({name, begin, png.size()});
  }
};

/// The picture of one material in one layer.
struct Mask {
  std::string png;          ///< empty of a blank one
  std::int64_t pixels = 0;  ///< that are white
};

class Sl1Sink final : public LayerSink {
 public:
  Sl1Sink(std::filesystem::path folder, const Sl1Options& options) : folder_(std::move(folder)), options_(options) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    info_ = info;
    uniform_.emplace(info.plan, options_.z_pitch, "SL1");
    style_.pixels_per_metre = pixels_per_metre(info.plan.grid);
    if (options_.display.is_portrait) std::swap(style_.pixels_per_metre[0], style_.pixels_per_metre[1]);
    blank_ = encode_png(blank_image(), style_);
    std::vector<std::string> names;
    for (const Material& material : info.materials) names.push_back(material.name);
    jobs_ = safe_file_names(names);
    std::vector<std::string> archives;
    for (const std::string& job : jobs_) archives.push_back(job + ".sl1");
    folder_.open(archives);
    for (const std::string& archive : archives) pictures_.emplace_back(folder_.root() / archive);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    const SliceRange slices = uniform_->slices(layer.index);
    if (slices.begin == slices.end) return [] {};
    return [this, slices, masks = masks_of(layer)] {
      for (std::int64_t slice = slices.begin; slice < slices.end; ++slice) add(masks);
    };
  }

  void finish(const SliceReport&) override {
    const Vec3& pitch = info_.plan.grid.pitch;
    const double pixel_ml = pitch.x() * pitch.y() * uniform_->pitch() / 1000.0;
    for (std::size_t m = 0; m < pictures_.size(); ++m) {
      Pictures& pictures = pictures_[m];
      const double used = static_cast<double>(pictures.pixels) * pixel_ml;
      const Material& material = info_.materials[MaterialId{m}];
      PackageParts parts;
      parts.texts = {{"config.ini", config_text(material, jobs_[m], uniform_->pitch(), written_, used)},
                     {"prusaslicer.ini", display_text(info_.plan.grid, options_.display, uniform_->pitch())}};
      pictures.file.close();
      parts.images = pictures.file.path();
      parts.image_parts = std::move(pictures.parts);
      write_package(pictures.target, parts);
      folder_.add(pictures.target);
    }
    pictures_.clear();  // the folder holds archives only, once they are whole
  }

  void abandon() noexcept override { folder_.abandon(); }

 private:
  [[nodiscard]] PackedImage blank_image() const {
    const auto& size = info_.plan.grid.size;
    const bool is_portrait = options_.display.is_portrait;
    return {size[is_portrait ? 1 : 0], size[is_portrait ? 0 : 1], 8};
  }

  /// Paints a run where the display has it.
  void paint(const RowRun& run, PackedImage& image) const {
    const Sl1Display& display = options_.display;
    const auto& size = info_.plan.grid.size;
    const std::int64_t begin = run.pixels.begin;
    const std::int64_t end = run.pixels.end;
    if (!display.is_portrait) {
      const std::int64_t row = display.mirror_y ? size[1] - 1 - run.picture_row : run.picture_row;
      image.fill(row, display.mirror_x ? size[0] - end : begin, display.mirror_x ? size[0] - begin : end, kWhite);
      return;
    }
    // The picture's row of the largest y is its leftmost column.
    const std::int64_t column = display.mirror_x ? size[1] - 1 - run.picture_row : run.picture_row;
    for (std::int64_t i = begin; i < end; ++i) image.set(display.mirror_y ? i : size[0] - 1 - i, column, kWhite);
  }

  /// Rows are gone over once for all materials, and only pictures that show something are kept until they are written.
  [[nodiscard]] std::vector<Mask> masks_of(const Layer& layer) const {
    const auto runs = runs_by_material(layer, info_);
    std::vector<Mask> masks(runs.size());
    parallel_for_within(masks.size(), [&](std::size_t m) { masks[m] = mask_of(runs[m]); });
    return masks;
  }

  [[nodiscard]] Mask mask_of(std::span<const RowRun> runs) const {
    Mask mask;
    if (runs.empty()) return mask;
    PackedImage image = blank_image();
    for (const RowRun& run : runs) {
      paint(run, image);
      mask.pixels += run.pixels.end - run.pixels.begin;
    }
    mask.png = encode_png(image, style_);
    return mask;
  }

  void add(const std::vector<Mask>& masks) {
    for (std::size_t m = 0; m < masks.size(); ++m) {
      pictures_[m].add(fmt::format("{}{:05}.png", jobs_[m], written_), masks[m].png.empty() ? blank_ : masks[m].png);
      pictures_[m].pixels += masks[m].pixels;
    }
    ++written_;
  }

  MaterialFolder folder_;  // outlives what is in it
  Sl1Options options_;
  BuildInfo info_;
  std::optional<UniformZ> uniform_;
  PngStyle style_;
  std::string blank_;  // most layers lack some material
  std::vector<std::string> jobs_;
  std::deque<Pictures> pictures_;  ///< by material; they don't move
  std::int64_t written_ = 0;
};

}  // namespace

std::unique_ptr<LayerSink> make_sl1_sink(const std::filesystem::path& folder, const Sl1Options& options) {
  return std::make_unique<Sl1Sink>(folder, options);
}

}  // namespace lamella
