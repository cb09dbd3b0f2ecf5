// Cuts hand-built solids and prints the level of the kernels, a digest of the counts and one of every byte of the
// spans. Runs on any x86-64-v2 machine; the test of the same name compares it with a run on an emulated old one.

#include <bit>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "slicing/span/cpu_level.h"
#include "tests/support/cut_scene.h"
#include "tests/support/spline_form.h"
#include "tests/support/swept_solids.h"
#include "tests/support/transform_scene.h"

using namespace lamella;

namespace {

/// FNV-1a over 64-bit words.
class Digest {
 public:
  void add(std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) state_ = (state_ ^ (word >> (8 * byte) & 0xff)) * 0x100000001b3;
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};

void add_scene(const Scene& scene, Digest& counts, Digest& bytes) {
  const Box3 box = test::solid_box(scene, SolidId{0});
  std::vector<LayerRequest> requests;
  for (std::size_t k = 0; k < 2 * kSlabLayers; ++k) {
    const double part = (static_cast<double>(k) + 0.37) / (2.0 * kSlabLayers);
    LayerRequest request{k, box.min().z() + part * box.sizes().z(), {}};
    for (const double angle : {0.0, 0.3}) request.lattices.push_back(test::lattice_over(box, angle, 61, 0.41));
    requests.push_back(std::move(request));
  }
  for (const LayerSpans& layer : test::cut_layers(SpanEngine(scene, test::all_solids(scene), {1e-7, 1}), requests)) {
    for (const SpanRows& rows : layer.lattices) {
      for (const std::uint64_t start : rows.row_start) counts.add(start);
      for (const Span& span : rows.spans) {
        bytes.add(std::bit_cast<std::uint64_t>(span.begin));
        bytes.add(std::bit_cast<std::uint64_t>(span.end));
      }
    }
  }
}

}  // namespace

int main() {
  Digest counts;
  Digest bytes;
  const auto add = [&](const auto& build) {
    Scene upright;
    build(upright);
    const Scene tilted = test::placed(upright, test::random_rotation(4));
    for (const Scene& scene : std::vector<Scene>{upright, tilted}) {
      add_scene(scene, counts, bytes);
      add_scene(test::as_splines(scene), counts, bytes);
    }
  };
  add([](Scene& s) { test::add_box(s, {-1, -1, -1}, {1, 1.5, 1}); });
  add([](Scene& s) { test::add_sphere(s, 1.0); });
  add([](Scene& s) { test::add_cone(s, 1.0, 1.25); });
  add([](Scene& s) { test::add_torus(s, 1.0, 0.5); });
  add([](Scene& s) { test::add_dome(s, 2.0, 1.5, 1.0, 0.5); });
  add([](Scene& s) { test::add_box_with_hole(s, {-1, -1, 0}, {1, 1, 2}, 0.5); });
  add([](Scene& s) { test::add_revolved_ring(s, 1.25, 0.25, 0.5); });
  std::printf("level %s counts %016llx bytes %016llx\n", span::cpu_levels().back(),
              static_cast<unsigned long long>(counts.value()), static_cast<unsigned long long>(bytes.value()));
  return 0;
}
