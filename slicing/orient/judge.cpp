#include "slicing/orient/judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/tolerances.h"
#include "slicing/orient/flat_face.h"
#include "slicing/orient/sphere.h"

namespace lamella {

namespace {

/// Unit vectors whose cosine differs from 1 by less are parallel: 1e-5 rad, what rounding in files leaves of a flat
/// face.
constexpr double kParallel = 5e-11;

/// Of the solids' size: a plane face that near to the lowest point lies on the plate.
constexpr double kOnPlate = 1e-6;

long count_layers(double height, double layer_height) {
  return std::max(1L, static_cast<long>(std::ceil(height / layer_height - tolerance::kGridSlack)));
}

}  // namespace

OrientationJudge::OrientationJudge(const Scene& scene, std::span<const SolidId> solids, const MaterialTable& table,
                                   const IdVector<SolidId, SolidMeasure>& measures, const SupportFunction& support,
                                   SurfaceSamples samples, JudgeOptions options, const Progress& progress, int threads)
    : support_(support), samples_(std::move(samples)), options_(std::move(options)), is_free_(scene.faces.size(), 0) {
  for (const FaceId face : options_.free_faces) is_free_[face.value()] = 1;
  find_planes(scene, solids);
  std::set<MaterialId> materials;
  for (const SolidId solid : solids) materials.insert(table.assignments[solid].material);
  materials_ = materials.size();
  if (materials_ > 1 && options_.counts_tools) {
    for (const SolidId solid : solids) {
      const std::array<SolidId, 1> one{solid};
      parts_.push_back({table.assignments[solid].material, SupportFunction(scene, one, progress, threads)});
    }
  }
  set_scale(measures, solids);
}

void OrientationJudge::find_planes(const Scene& scene, std::span<const SolidId> solids) {
  std::map<FaceId, std::pair<double, Vec3>> areas;  // and a point
  for (const SurfaceSample& sample : samples_.samples) {
    auto& [area, point] = areas.try_emplace(sample.face, 0.0, sample.point).first->second;
    area += sample.area;
  }
  for (const SolidId solid : solids) {
    for (const ShellId shell : scene.solids[solid].shells) {
      for (const FaceId id : scene.shells[shell].faces) {
        const auto found = areas.find(id);
        const auto normal = found == areas.end() ? std::nullopt : flat_normal(scene.faces[id]);
        if (normal) planes_.push_back({id, *normal, found->second.second, found->second.first});
      }
    }
  }
}

void OrientationJudge::set_scale(const IdVector<SolidId, SolidMeasure>& measures, std::span<const SolidId> solids) {
  double volume = 0.0;
  for (const SolidId solid : solids) volume += std::abs(measures[solid].volume);
  const double reach = std::max(support_.bounds().diagonal().norm(), 1e-9);
  scale_.height = reach;
  scale_.layers = count_layers(reach, options_.layer_height);
  scale_.support_area = std::max(samples_.area, 1e-18);
  scale_.support_volume = std::max(volume, 1e-18);
  scale_.cusp_error = scale_.largest_cusp = options_.layer_height;
  scale_.contact_area = 1e-18;
  for (const PlaneFace& plane : planes_) scale_.contact_area = std::max(scale_.contact_area, plane.area);
  scale_.tool_changes = std::max(1L, scale_.layers * std::max<long>(1, static_cast<long>(materials_) - 1));
}

std::vector<Vec3> OrientationJudge::outline_points() const {
  std::vector<Vec3> points = support_.points();
  for (const SurfaceSample& sample : samples_.samples) points.push_back(sample.point);
  return points;
}

std::vector<std::pair<Vec3, double>> OrientationJudge::plane_areas() const {
  std::vector<std::pair<Vec3, double>> planes;
  for (const PlaneFace& plane : planes_) planes.emplace_back(plane.normal, plane.area);
  return planes;
}

OrientationFigures OrientationJudge::judge(const Vec3& up) const {
  OrientationFigures figures;
  const double top = support_(up).value;
  const double plate = -support_(-up).value;
  figures.height = top - plate;
  figures.layers = count_layers(figures.height, options_.layer_height);
  figures.contact_area = contact_area(up, plate);
  add_cusps(up, figures);
  const SupportNeed need = support_need(up, plate, 0, 1);
  figures.support_area = need.area;
  figures.support_volume = need.volume;
  figures.touched_area = need.touched;
  figures.tool_changes = count_tool_changes(up, plate, figures.layers);
  return figures;
}

double OrientationJudge::support_error(const Vec3& up) const {
  const double plate = -support_(-up).value;
  return 0.5 * std::abs(support_need(up, plate, 0, 2).volume - support_need(up, plate, 1, 2).volume);
}

double OrientationJudge::contact_area(const Vec3& up, double plate) const {
  const double near = kOnPlate * support_.bounds().diagonal().norm();
  double area = 0.0;
  for (const PlaneFace& plane : planes_) {
    const bool is_flat = -plane.normal.dot(up) > 1.0 - kParallel;
    if (is_flat && std::abs(up.dot(plane.point) - plate) <= near) area += plane.area;
  }
  return area;
}

void OrientationJudge::add_cusps(const Vec3& up, OrientationFigures& figures) const {
  // The cusp of a layer on a surface is its thickness times |n . up| (Dolenc and Makela 1994); flat faces have none.
  double sum = 0.0;
  for (const SurfaceSample& sample : samples_.samples) {
    const double slope = std::abs(sample.normal.dot(up));
    if (slope > 1.0 - kParallel) continue;
    sum += slope * sample.area;
    figures.largest_cusp = std::max(figures.largest_cusp, slope * options_.layer_height);
  }
  if (samples_.area > 0.0) figures.cusp_error = sum / samples_.area * options_.layer_height;
}

namespace {

/// Samples seen from above: a square of the plate each, sorted by square and height.
struct Seen {
  std::uint64_t square = 0;
  double height = 0.0;
  std::uint32_t sample = 0;
};

}  // namespace

OrientationJudge::SupportNeed OrientationJudge::support_need(const Vec3& up, double plate, std::size_t first,
                                                             std::size_t stride) const {
  SupportNeed need;
  const auto& samples = samples_.samples;
  if (samples.empty() || !(samples_.area > 0.0)) return need;
  const Mat3 turn = turn_upright(up);
  // Squares about as large as a sample, so that each column has one of every surface it meets.
  const double side =
      1.5 * std::sqrt(samples_.area * static_cast<double>(stride) / static_cast<double>(samples.size()));
  std::vector<Seen> seen;
  seen.reserve(samples.size() / stride + 1);
  for (std::size_t i = first; i < samples.size(); i += stride) {
    const Vec3 at = turn * samples[i].point;
    const auto column = static_cast<std::int32_t>(std::floor(at.x() / side));
    const auto row = static_cast<std::int32_t>(std::floor(at.y() / side));
    const std::uint64_t square =
        (std::uint64_t{static_cast<std::uint32_t>(row)} << 32) | static_cast<std::uint32_t>(column);
    seen.push_back({square, at.z(), static_cast<std::uint32_t>(i)});
  }
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
    return a.square != b.square ? a.square < b.square : a.height < b.height;
  });
  const double steepest = std::cos(options_.critical_angle);
  const double on_plate = kOnPlate * support_.bounds().diagonal().norm();
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const SurfaceSample& sample = samples[seen[i].sample];
    const double down = -sample.normal.dot(up);
    if (!(down > steepest) || seen[i].height <= plate + on_plate) continue;
    const double area = sample.area * static_cast<double>(stride);
    // The next surface below that looks up carries the support, else the plate.
    double floor = plate;
    const SurfaceSample* carrier = nullptr;
    for (std::size_t j = i; j-- > 0 && seen[j].square == seen[i].square;) {
      const SurfaceSample& below = samples[seen[j].sample];
      if (!(below.normal.dot(up) > 0.0)) continue;
      floor = seen[j].height;
      carrier = &below;
      break;
    }
    need.area += area;
    need.volume += area * down * (seen[i].height - floor);
    const bool is_touched = is_free_[sample.face.value()] || (carrier != nullptr && is_free_[carrier->face.value()]);
    if (is_touched) need.touched += area;
  }
  return need;
}

long OrientationJudge::count_tool_changes(const Vec3& up, double plate, long layers) const {
  if (parts_.empty()) return 0;
  // A layer holds the materials of all solids between whose lowest and highest point it lies. What is in use already
  // goes first, so a layer of n materials takes n - 1 changes, and one more if it hasn't that material.
  std::map<MaterialId, std::vector<Interval>> reach;
  for (const Part& part : parts_)
    reach[part.material].push_back({-part.support(-up).value - plate, part.support(up).value - plate});
  long changes = 0;
  std::set<MaterialId> before;
  for (long layer = 0; layer < layers; ++layer) {
    const double z = (static_cast<double>(layer) + 0.5) * options_.layer_height;
    std::set<MaterialId> here;
    for (const auto& [material, intervals] : reach) {
      if (std::any_of(intervals.begin(), intervals.end(), [z](const Interval& i) { return i.contains(z); }))
        here.insert(material);
    }
    if (here.empty()) continue;
    changes += static_cast<long>(here.size()) - 1;
    const bool shares = std::any_of(here.begin(), here.end(), [&](MaterialId m) { return before.count(m) > 0; });
    if (!before.empty() && !shares) ++changes;
    before = std::move(here);
  }
  return changes;
}

}  // namespace lamella
