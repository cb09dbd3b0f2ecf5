#include "model/project.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "model/evaluate.h"

namespace lamella {

namespace {

constexpr int kFewCells = 16;
constexpr int kManyCells = 128;
constexpr std::size_t kStarts = 32;
constexpr int kSteps = 50;

struct Place {
  Vec2 uv = Vec2::Zero();
  double distance = std::numeric_limits<double>::infinity();  ///< mm
};

Place place_at(const Surface& surface, const Vec2& uv, const Vec3& point) {
  return {uv, (evaluate_point(surface, uv) - point).norm()};
}

/// Distances at the nodes of a grid of `cells` by `cells`, row by row along v.
std::vector<Place> sample(const Surface& surface, const Box2& box, const Vec3& point, int cells) {
  std::vector<Place> places;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      const Vec2 part(static_cast<double>(i) / cells, static_cast<double>(j) / cells);
      places.push_back(place_at(surface, box.min() + part.cwiseProduct(box.sizes()), point));
    }
  }
  return places;
}

/// The nodes that are no farther than their neighbours, nearest first.
std::vector<Place> find_starts(const Surface& surface, const Box2& box, const Vec3& point, int cells) {
  const std::vector<Place> places = sample(surface, box, point, cells);
  const auto distance = [&](int i, int j) {
    return i < 0 || j < 0 || i > cells || j > cells ? std::numeric_limits<double>::infinity()
                                                    : places[static_cast<std::size_t>(i * (cells + 1) + j)].distance;
  };
  std::vector<Place> starts;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      const double least = std::min({distance(i - 1, j), distance(i + 1, j), distance(i, j - 1), distance(i, j + 1)});
      if (distance(i, j) <= least) starts.push_back(places[static_cast<std::size_t>(i * (cells + 1) + j)]);
    }
  }
  std::sort(starts.begin(), starts.end(), [](const Place& a, const Place& b) { return a.distance < b.distance; });
  if (starts.size() > kStarts) starts.resize(kStarts);
  return starts;
}

/// Levenberg's damping makes steps where the surface has no normal (a pole, an apex) and where a full one overshoots.
Place descend(const Surface& surface, const Box2& box, const Vec3& point, Place at) {
  double damping = 0.0;
  for (int step = 0; step < kSteps && at.distance > 0.0; ++step) {
    const SurfacePoint s = evaluate(surface, at.uv);
    const Vec3 residual = point - s.point;
    Eigen::Matrix2d normal;
    normal << s.du.squaredNorm(), s.du.dot(s.dv), s.du.dot(s.dv), s.dv.squaredNorm();
    const double scale = normal.trace();
    normal.diagonal().array() += std::max(damping, std::numeric_limits<double>::epsilon()) * scale;
    const Vec2 change = normal.ldlt().solve(Vec2(s.du.dot(residual), s.dv.dot(residual)));
    const Place next = place_at(surface, (at.uv + change).cwiseMax(box.min()).cwiseMin(box.max()), point);
    // Comparisons are written so that NaN fails.
    if (next.distance < at.distance) {
      at = next;
      damping *= 0.1;
      if (damping < 1e-9) damping = 0.0;
    } else if (damping < 1.0) {
      damping = std::max(10.0 * damping, 1e-6);
    } else {
      break;
    }
  }
  return at;
}

}  // namespace

Vec2 project(const Surface& surface, const Box2& box, const Vec3& point, double near) {
  Place best;
  for (int cells = kFewCells; cells <= kManyCells; cells *= 2) {
    for (const Place& start : find_starts(surface, box, point, cells)) {
      const Place found = descend(surface, box, point, start);
      if (found.distance < best.distance) best = found;
      if (best.distance <= near) return best.uv;
    }
  }
  return best.uv;
}

}  // namespace lamella
