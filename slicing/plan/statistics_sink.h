#pragma once

#include <optional>
#include <vector>

#include "slicing/layer_sink.h"
#include "slicing/plan/layer_statistics.h"

namespace lamella {

/// Collects what a build plan needs of the layers: a row of numbers a layer and material, and the cover of the last
/// layer.
class StatisticsSink final : public LayerSink {
 public:
  /// The machine must outlive it.
  explicit StatisticsSink(const Machine& machine);

  void begin(const BuildInfo& info) override;
  void write(const Layer& layer) override;
  void finish(const SliceReport& report) override;

  [[nodiscard]] const BuildInfo& info() const { return info_; }
  [[nodiscard]] const SliceReport& report() const { return report_; }
  [[nodiscard]] const std::vector<LayerStatistics>& layers() const { return layers_; }

 private:
  const Machine& machine_;
  StatisticsOptions options_;
  BuildInfo info_;
  SliceReport report_;
  std::optional<Cover> below_;
  std::vector<LayerStatistics> layers_;
};

}  // namespace lamella
