#include "export/slc_sink.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <fmt/format.h>
#include <optional>
#include <utility>
#include <vector>

#include "core/error.h"
#include "export/build_check.h"
#include "export/byte_order.h"
#include "export/file_name.h"
#include "export/material_contours.h"
#include "export/material_folder.h"
#include "export/output_file.h"

namespace lamella {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kReserved = 256;         // bytes between header and table
constexpr std::size_t kMostThicknesses = 255;  // the table's size is one byte
constexpr std::uint32_t kEnd = 0xFFFFFFFF;

/// Thicknesses that differ by less are one: they come of the same plan by rounding.
constexpr double kSameThickness = 1e-9;  // mm

/// What is known of a file only at its end, as wide as it will ever be.
std::string header_text(const Box3& box) {
  const Vec3 low = box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.min());
  const Vec3 high = box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.max());
  return fmt::format(
      "-SLCVER 2.0 -UNIT MM -TYPE PART -PACKAGE Lamella -EXTENTS {:018.6f},{:018.6f} {:018.6f},{:018.6f} "
      "{:018.6f},{:018.6f} \r\n\x1A",
      low.x(), high.x(), low.y(), high.y(), low.z(), high.z());
}

/// One entry where the thickness changes: lowest z, thickness, compensation of the line's width, reserved.
std::string table_of(const LayerPlan& plan) {
  std::string entries;
  std::size_t count = 0;
  double last = 0.0;
  for (const LayerSpan& span : plan.layers) {
    const double thickness = span.z_top - span.z_bottom;
    if (std::abs(thickness - last) <= kSameThickness) continue;
    last = thickness;
    for (const double value : {span.z_bottom, thickness, 0.0, 0.0})
      append_little_endian(entries, static_cast<float>(value));
    ++count;
  }
  if (count > kMostThicknesses) {
    throw UsageError("slc holds at most 255 changes of the layers' thickness, this build has " + std::to_string(count),
                     {}, "use layers of one thickness");
  }
  std::string table;
  append_little_endian(table, static_cast<std::uint8_t>(count));
  return table + entries;
}

void append_boundary(const MaterialLoop& loop, std::string& out) {
  append_little_endian(out, static_cast<std::uint32_t>(loop.points.size() + 1));
  append_little_endian(out, std::uint32_t{0});
  const auto append = [&](const Vec2& point) {
    append_little_endian(out, static_cast<float>(point.x()));
    append_little_endian(out, static_cast<float>(point.y()));
  };
  for (const Vec2& point : loop.points) append(point);
  append(loop.points.front());
}

/// The file of one material.
struct MaterialFile {
  MaterialId material;
  fs::path path;
  OutputFile file;
  Box3 box;
};

class SlcSink final : public LayerSink {
 public:
  explicit SlcSink(fs::path folder) : folder_(std::move(folder)) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    combiner_.emplace(info, "slc");
    info_ = info;
    const std::string table = table_of(info.plan);
    const std::vector<std::pair<MaterialId, std::string>> names = used_names();
    std::vector<std::string> file_names;
    for (const auto& [material, name] : names) file_names.push_back(name);
    folder_.open(file_names);
    for (const auto& [material, name] : names) {
      const fs::path path = folder_.root() / name;
      MaterialFile& file = files_.emplace_back(material, path, OutputFile(path), Box3());
      file.file.stream() << header_text({}) << std::string(kReserved, '\0') << table;
    }
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    return [this, &layer, contours = combiner_->combine(*layer.contours)] {
      for (MaterialFile& file : files_) add(file, layer, contours[file.material]);
      top_ = layer.z_top;
    };
  }

  void finish(const SliceReport&) override {
    std::string end;
    append_little_endian(end, static_cast<float>(top_));
    append_little_endian(end, kEnd);
    for (MaterialFile& file : files_) {
      file.file.stream() << end;
      file.file.stream().seekp(0);
      file.file.stream() << header_text(file.box);
    }
    for (MaterialFile& file : files_) {
      file.file.commit();
      folder_.add(file.path);
    }
  }

  void abandon() noexcept override { folder_.abandon(); }

 private:
  /// Of the materials that solids are made of.
  [[nodiscard]] std::vector<std::pair<MaterialId, std::string>> used_names() const {
    std::vector<std::string> names;
    for (const Material& material : info_.materials) names.push_back(material.name);
    names = safe_file_names(names);
    std::vector<std::pair<MaterialId, std::string>> used;
    for (const MaterialId id : info_.materials.ids()) {
      const bool is_used = std::any_of(info_.solids.begin(), info_.solids.end(),
                                       [&](const BuildSolid& solid) { return solid.material == id; });
      if (is_used) used.emplace_back(id, names[id.value()] + ".slc");
    }
    return used;
  }

  static void add(MaterialFile& file, const Layer& layer, const std::vector<MaterialLoop>& loops) {
    std::string bytes;
    append_little_endian(bytes, static_cast<float>(layer.z_bottom));
    append_little_endian(bytes, static_cast<std::uint32_t>(loops.size()));
    for (const MaterialLoop& loop : loops) {
      append_boundary(loop, bytes);
      for (const Vec2& point : loop.points) {
        file.box.extend(Vec3(point.x(), point.y(), layer.z_bottom));
        file.box.extend(Vec3(point.x(), point.y(), layer.z_top));
      }
    }
    file.file.stream() << bytes;
    file.file.check();
  }

  MaterialFolder folder_;  // outlives what is in it
  BuildInfo info_;
  std::optional<ContourCombiner> combiner_;
  std::deque<MaterialFile> files_;
  double top_ = 0.0;  ///< mm: of the last layer
};

}  // namespace

std::unique_ptr<LayerSink> make_slc_sink(const fs::path& folder) { return std::make_unique<SlcSink>(folder); }

}  // namespace lamella
