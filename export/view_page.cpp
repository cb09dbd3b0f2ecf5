#include "export/view_page.h"

#include <optional>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "export/build_check.h"
#include "export/output_file.h"
#include "export/view_chunk.h"
#include "export/view_header.h"
#include "slicing/compensated_sum.h"

// viewer/dist/viewer.html, which the linker made an object of (export/CMakeLists.txt).
extern "C" const char _binary_viewer_html_start[];
extern "C" const char _binary_viewer_html_end[];

namespace lamella {

namespace {

/// Where in the page the data go.
constexpr std::string_view kPlace = "<!--lamella:data-->";

std::string_view page() {
  return {_binary_viewer_html_start, static_cast<std::size_t>(_binary_viewer_html_end - _binary_viewer_html_start)};
}

class ViewSink final : public LayerSink {
 public:
  ViewSink(std::filesystem::path path, const ViewPageOptions& options) : path_(std::move(path)), options_(options) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    info_ = info;
    if (options_.hatches && !info.plan.hatch) {
      throw UsageError("the build has no hatch rows", path_.string(), "slice with --hatch-spacing");
    }
    if (!options_.hatches) info_.plan.hatch.reset();
    chunk_.emplace(info.plan.grid, info_.plan.hatch);
    file_.emplace(path_);
    file_->stream() << page().substr(0, page().find(kPlace));
  }

  void write(const Layer& layer) override {
    if (offered_++ % options_.every != 0) return;
    check_layer(layer, info_);
    count(layer);
    layers_.push_back({layer.index, layer.raster.segments.size(), areas(layer)});
    if (options_.hatches) {
      layers_.back().hatch_first = layer.hatch->first_row;
      layers_.back().hatch_rows = layer.hatch->rows.rows();
    }
    chunk_->add(layer);
    if (chunk_->is_full()) write_chunk();
  }

  void finish(const SliceReport& report) override {
    if (chunk_->sizes().layers > 0) write_chunk();
    file_->stream() << "<script type=\"application/json\" id=\"build\">" << view_header(info_, report, layers_, chunks_)
                    << "</script>\n"
                    << page().substr(page().find(kPlace) + kPlace.size());
    file_->commit();
  }

 private:
  void count(const Layer& layer) {
    segments_ += layer.raster.segments.size();
    rows_ += layer.raster.rows();
    if (options_.hatches) {
      segments_ += layer.hatch->rows.segments.size();
      rows_ += layer.hatch->rows.rows();
    }
    if (segments_ <= kMostViewSegments && rows_ <= kMostViewRows) return;
    throw UsageError("a page of more than " + std::to_string(kMostViewSegments) + " segments or " +
                         std::to_string(kMostViewRows) + " rows is too much for a browser",
                     path_.string(), "take fewer layers with --layers A:B or --every N");
  }

  [[nodiscard]] std::vector<double> areas(const Layer& layer) const {
    std::vector<CompensatedSum> sums(info_.materials.size());
    for (const Segment& segment : layer.raster.segments) {
      sums[segment.material.value()].add(segment.x_end - segment.x_begin);
    }
    std::vector<double> areas;
    for (const CompensatedSum& sum : sums) areas.push_back(sum.value() * info_.plan.grid.pitch.y());
    return areas;
  }

  void write_chunk() {
    chunks_.push_back(chunk_->sizes());
    file_->stream() << "<script type=\"text/plain\" class=\"chunk\">" << chunk_->take() << "</script>\n";
    file_->check();
  }

  std::filesystem::path path_;
  ViewPageOptions options_;
  BuildInfo info_;
  std::optional<OutputFile> file_;
  std::optional<ViewChunk> chunk_;
  std::vector<ViewLayer> layers_;
  std::vector<ViewChunkSizes> chunks_;
  std::uint64_t offered_ = 0;
  std::uint64_t segments_ = 0;
  std::uint64_t rows_ = 0;
};

}  // namespace

std::unique_ptr<LayerSink> make_view_sink(const std::filesystem::path& file, const ViewPageOptions& options) {
  if (options.every == 0) throw UsageError("every 0th layer is none");
  return std::make_unique<ViewSink>(file, options);
}

}  // namespace lamella
