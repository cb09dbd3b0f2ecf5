#include "export/image_folder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <system_error>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/xml.h"
#include "export/file_name.h"

namespace lamella {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMaterialsHeader = "value,name,folder,density_g_cm3,red,green,blue";
constexpr std::string_view kLayersHeader = "index,z_bottom,z_sample,z_top,file";
constexpr std::string_view kGridHeader = "axis,origin_mm,pitch_mm,size";
constexpr std::array<std::string_view, 4> kTables = {"materials.csv", "grid.csv", "layers.csv", "layers.pvd"};

/// A field of a comma-separated table, quoted when it has to be (RFC 4180).
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

/// `name` without the suffix that AtomicFile gives to files in the making; a killed run leaves some.
std::string_view without_part(std::string_view name) { return name.substr(0, name.rfind(".part-")); }

bool is_image_name(std::string_view name, std::string_view extension) {
  name = without_part(name);
  if (!name.starts_with("layer_") || !name.ends_with(extension)) return false;
  name.remove_prefix(6);
  name.remove_suffix(extension.size());
  return !name.empty() && name.find_first_not_of("0123456789") == std::string_view::npos;
}

bool is_table_name(std::string_view name) {
  return std::find(kTables.begin(), kTables.end(), without_part(name)) != kTables.end();
}

bool holds_stack(const fs::path& root) {
  std::ifstream stream(root / "materials.csv");
  std::string line;
  return std::getline(stream, line) && line == kMaterialsHeader;
}

[[noreturn]] void refuse(const fs::path& entry) {
  throw ExportError("the output folder holds files that are not of an image stack", entry.string(),
                    "choose a new or empty folder");
}

/// The files of an earlier stack; refuses anything else. Links are never followed.
std::vector<fs::path> old_files(const fs::path& root, const std::string& extension) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(root)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_symlink()) refuse(entry.path());
    if (entry.is_directory()) {
      for (const fs::directory_entry& inner : fs::directory_iterator(entry.path())) {
        if (inner.is_symlink() || !inner.is_regular_file()) refuse(inner.path());
        if (!is_image_name(inner.path().filename().string(), extension)) refuse(inner.path());
        files.push_back(inner.path());
      }
    } else if (!entry.is_regular_file() || !(is_table_name(name) || is_image_name(name, extension))) {
      refuse(entry.path());
    }
    files.push_back(entry.path());  // a sub-folder after its files
  }
  if (!files.empty() && !holds_stack(root)) refuse(files.front());
  return files;
}

void empty_folder(const fs::path& root, const std::string& extension) {
  try {
    if (!fs::exists(root)) return;
    for (const fs::path& file : old_files(root, extension)) fs::remove(file);
  } catch (const fs::filesystem_error& failure) {
    throw ExportError("can't use the output folder: " + failure.code().message(), root.string());
  }
}

}  // namespace

ImageFolder::ImageFolder(fs::path root, ImageFolderOptions options)
    : root_(std::move(root)), options_(std::move(options)) {
  layers_csv_ = fmt::format("{}\n", kLayersHeader);
}

void ImageFolder::open(const BuildInfo& info) {
  if (options_.folder_per_material) {
    std::vector<std::string> names;
    for (const Material& material : info.materials) names.push_back(material.name);
    subfolders_ = safe_file_names(names, {kTables.begin(), kTables.end()});
  }
  empty_folder(root_, options_.extension);
  made_root_ = !fs::exists(root_);
  make_folder(root_);
  is_open_ = true;
  write_tables(info);
  for (const std::string& name : subfolders_) make_folder(root_ / name);
}

void ImageFolder::write_image(std::uint32_t number, std::size_t subfolder, std::string_view bytes) const {
  const fs::path folder = options_.folder_per_material ? root_ / subfolders_[subfolder] : root_;
  write_file_atomically(folder / image_name(number), bytes);
}

void ImageFolder::add_layer(std::uint32_t number, const LayerSpan& span) {
  layers_csv_ += fmt::format("{},{},{},{},{}\n", number, format_double(span.z_bottom), format_double(span.z_sample),
                             format_double(span.z_top), image_name(number));
}

void ImageFolder::close() const { write_file_atomically(root_ / "layers.csv", layers_csv_); }

void ImageFolder::abandon() noexcept {
  if (!is_open_) return;
  is_open_ = false;
  try {
    empty_folder(root_, options_.extension);
    if (made_root_) fs::remove(root_);
  } catch (const std::exception&) {
    // The failure that ended the run is the one to tell.
  }
}

std::string ImageFolder::image_name(std::uint32_t number) const {
  return fmt::format("layer_{:0{}}{}", number, options_.pads_number ? 6 : 1, options_.extension);
}

void ImageFolder::write_tables(const BuildInfo& info) const {
  std::string materials = fmt::format("{}\n", kMaterialsHeader);
  for (MaterialId id : info.materials.ids()) {
    const Material& material = info.materials[id];
    const unsigned value = options_.folder_per_material ? options_.value : 1 + id.value();
    const std::string folder = options_.folder_per_material ? subfolders_[id.value()] : ".";
    const std::string density = material.density ? format_double(*material.density) : "";
    materials += fmt::format("{},{},{},{}", value, csv_field(material.name), csv_field(folder), density);
    for (double channel : material.color)
      materials += fmt::format(",{}", std::lround(std::clamp(channel, 0.0, 1.0) * 255.0));
    materials += '\n';
  }
  write_file_atomically(root_ / "materials.csv", materials);

  std::string grid = fmt::format("{}\n", kGridHeader);
  for (int axis = 0; axis < 3; ++axis) {
    grid += fmt::format("{},{},{},{}\n", "xyz"[axis], format_double(info.plan.grid.origin[axis]),
                        format_double(info.plan.grid.pitch[axis]), info.plan.grid.size[axis]);
  }
  write_file_atomically(root_ / "grid.csv", grid);
}

}  // namespace lamella
