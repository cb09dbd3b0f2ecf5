#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "slicing/slicer.h"

namespace lamella::test {

struct Ball {
  Vec3 center;
  double radius;
};

/// Solids whose spans are known in closed form; the scene holds their names and nothing of their geometry.
class KnownScene {
 public:
  SolidId add(const std::variant<Ball, Box3>& shape, std::size_t material, int priority, const std::string& name) {
    while (table.materials.size() <= material) table.materials.push_back({"m", 2.0, {}});
    table.assignments.push_back({MaterialId{material}, priority, ""});
    shapes_.push_back(shape);
    measures.push_back(measure(shape));
    bounds.extend(measures[SolidId{measures.size() - 1}].bounds);
    Solid solid;
    solid.info.name = name;
    solid.info.path = "/" + name;
    return scene.solids.push_back(solid);
  }

  [[nodiscard]] CastFunction caster() const {
    return [this](const Ray& ray, SolidId solid, SolidCast& out, CastCounters& counters) {
      out.solid = solid;
      out.hits.clear();
      out.spans.clear();
      ++counters.rays;
      const auto span = std::visit([&](const auto& shape) { return cross(ray, shape); }, shapes_[solid.value()]);
      if (!(span.lo < span.hi)) return;
      counters.hits += 2;
      out.spans.push_back({span.lo, span.hi, solid, FaceId{}, FaceId{}});
    };
  }

  /// Casts ray by ray at the solids that a run takes.
  [[nodiscard]] SlabEngine engine(bool allow_open = false) const {
    std::vector<RayTarget> targets;
    for (const SolidId solid : choose_solids(scene, measures, allow_open)) {
      targets.push_back({solid, measures[solid].bounds});
    }
    return make_ray_engine(caster(), targets);
  }

  [[nodiscard]] LayerPlan plan(double pitch, double height, std::optional<HatchLattice> hatch = {}) const {
    PlanOptions options;
    options.pitch = Vec2(pitch, pitch);
    options.layer_height = height;
    options.hatch = hatch;
    return plan_layers(bounds, options);
  }

  Scene scene;
  MaterialTable table;
  IdVector<SolidId, SolidMeasure> measures;
  Box3 bounds;

 private:
  static Interval cross(const Ray& ray, const Ball& ball) {
    const Vec3 to = ray.origin - ball.center;
    const double half = to.dot(ray.direction);
    const double root = half * half - to.squaredNorm() + ball.radius * ball.radius;
    if (!(root > 0.0)) return {0, 0};
    return {-half - std::sqrt(root), -half + std::sqrt(root)};
  }

  static Interval cross(const Ray& ray, const Box3& box) {
    Interval inside{-1e300, 1e300};
    for (int axis = 0; axis < 3; ++axis) {
      double a = (box.min()[axis] - ray.origin[axis]) / ray.direction[axis];
      double b = (box.max()[axis] - ray.origin[axis]) / ray.direction[axis];
      if (ray.direction[axis] == 0.0) {
        if (ray.origin[axis] < box.min()[axis] || ray.origin[axis] >= box.max()[axis]) return {0, 0};
        continue;
      }
      if (a > b) std::swap(a, b);
      inside = {std::max(inside.lo, a), std::min(inside.hi, b)};
    }
    return inside;
  }

  static SolidMeasure measure(const std::variant<Ball, Box3>& shape) {
    SolidMeasure out;
    if (const Ball* ball = std::get_if<Ball>(&shape)) {
      out.volume = 4.0 / 3.0 * kPi * std::pow(ball->radius, 3);
      out.bounds = Box3(ball->center.array() - ball->radius, ball->center.array() + ball->radius);
      out.abs_normal_area.setConstant(2.0 * kPi * ball->radius * ball->radius);
    } else {
      out.bounds = std::get<Box3>(shape);
      const Vec3 size = out.bounds.sizes();
      out.volume = size.prod();
      out.abs_normal_area = 2.0 * out.volume * size.cwiseInverse();
    }
    return out;
  }

  std::vector<std::variant<Ball, Box3>> shapes_;
};

/// Keeps what it is given.
class Recorder : public LayerSink {
 public:
  void begin(const BuildInfo& info) override { build = info; }
  void write(const Layer& layer) override { layers.push_back(layer); }
  void finish(const SliceReport&) override { is_finished = true; }
  void abandon() noexcept override { is_abandoned = true; }

  BuildInfo build;
  std::vector<Layer> layers;
  bool is_finished = false;
  bool is_abandoned = false;
};

}  // namespace lamella::test
