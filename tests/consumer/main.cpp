#include <cstdio>
#include <filesystem>

#include "export/png_stack.h"
#include "export/vdb/vdb_sink.h"
#include "model/step/read_step.h"
#include "slicing/layer_plan.h"
#include "slicing/layer_sink.h"
#include "slicing/store/store.h"

// Writes one solid 2 x 2 x 1 layer with every kind of sink, so that each library and third party gets linked, and
// reads it back from the store.
int main() {
  using namespace lamella;
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "lamella-consumer";
  std::filesystem::remove_all(folder);

  BuildInfo info;
  info.materials.push_back({"resin", 1.2, {0.2, 0.4, 0.8}});
  info.solids.push_back({"block", "/block", MaterialId{0}, 0, 4.0, Box3(Vec3(0, 0, 0), Vec3(2, 2, 1))});
  PlanOptions options;
  options.layer_height = 1.0;
  options.pitch = Vec2(1.0, 1.0);
  info.plan = plan_layers(Box3(Vec3(0, 0, 0), Vec3(2, 2, 1)), options);

  Layer layer;
  layer.z_sample = 0.5;
  layer.z_top = 1.0;
  layer.raster.segments.assign(2, {0.0, 2.0, MaterialId{0}, SolidId{0}});
  layer.raster.row_start = {0, 1, 2};

  TeeSink sinks;
  sinks.add(make_store_sink(folder / "build"));
  sinks.add(make_png_sink(folder / "png"));
  sinks.add(make_vdb_sink(folder / "voxels.vdb"));
  sinks.begin(info);
  sinks.write(layer);
  SliceReport report;
  report.solids = IdVector<SolidId, SolidReport>(1);
  report.materials = IdVector<MaterialId, MaterialReport>(1);
  sinks.finish(report);

  const bool same = StoreReader(folder / "build").read_layer(0) == layer;
  bool refused = false;
  try {
    const std::filesystem::path missing = folder / "missing.step";
    (void)read_step({&missing, 1});
  } catch (const InputError&) {
    refused = true;
  }
  std::filesystem::remove_all(folder);
  std::puts(same && refused ? "ok" : "failed");
  return same && refused ? 0 : 1;
}
