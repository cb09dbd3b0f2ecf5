#include "datasets/generator/tray.h"

#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Mat.hxx>
#include <gp_Quaternion.hxx>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "datasets/generator/shapes.h"

namespace lamella::datasets {
namespace {

/// More instances than this would be a slip of the pen.
constexpr double kMostCopies = 100000;

/// Bounds are those of OpenCASCADE, which are good to about this: what fits up to it does fit.
constexpr double kBoundsSlack = 1e-6;  // mm

struct Extent {
  std::array<double, 3> low{};
  std::array<double, 3> size{};
};

Extent extent_of(const DataSet& set, const gp_Trsf& turn) {
  Bnd_Box box;
  for (const PlacedPart& placed : placed_parts(set)) {
    const TopoDS_Shape shape = moved(set.parts[static_cast<std::size_t>(placed.part)].shape, turn * placed.placement);
    BRepBndLib::AddOptimal(shape, box, false, false);
  }
  Extent extent;
  box.SetGap(0.0);  // the faces themselves, without tolerances
  std::array<double, 3> high{};
  box.Get(extent.low[0], extent.low[1], extent.low[2], high[0], high[1], high[2]);
  for (std::size_t i = 0; i < 3; ++i) extent.size[i] = high[i] - extent.low[i];
  return extent;
}

/// The rotation that lays the part's axis `order[i]` along axis i of the tray, one of them reversed if it must be.
gp_Trsf turn_of(const std::array<int, 3>& order) {
  gp_Mat matrix(0, 0, 0, 0, 0, 0, 0, 0, 0);
  for (int i = 0; i < 3; ++i) matrix.SetValue(i + 1, order[static_cast<std::size_t>(i)] + 1, 1);
  if (matrix.Determinant() < 0) matrix.SetValue(3, order[2] + 1, -1);
  gp_Trsf turn;
  turn.SetRotation(gp_Quaternion(matrix));
  return turn;
}

int count_along(double room, double size, double gap) {
  return static_cast<int>(std::min(kMostCopies, std::floor((room + gap + kBoundsSlack) / (size + gap))));
}

std::string text_of(const std::array<double, 3>& size) {
  std::ostringstream out;
  out << size[0] << " x " << size[1] << " x " << size[2] << " mm";
  return out.str();
}

void check(const TrayOptions& options) {
  // Written so that NaN fails.
  for (const double size : options.size) {
    if (!(size > 0 && size <= std::numeric_limits<float>::max()))
      throw std::invalid_argument("the sizes of the volume must be positive");
  }
  if (!(options.gap >= 0 && options.gap <= std::numeric_limits<float>::max()))
    throw std::invalid_argument("the gap must not be negative");
}

/// The grid of copies that are turned in one way.
struct Layout {
  gp_Trsf turn;
  Extent part;
  std::array<int, 3> copies{};
  [[nodiscard]] double count() const { return 1.0 * copies[0] * copies[1] * copies[2]; }
};

Layout layout_of(const DataSet& unit, const TrayOptions& options, const std::array<int, 3>& order) {
  Layout layout;
  layout.turn = turn_of(order);
  layout.part = extent_of(unit, layout.turn);
  for (std::size_t i = 0; i < 3; ++i) layout.copies[i] = count_along(options.size[i], layout.part.size[i], options.gap);
  return layout;
}

Layout best_layout(const DataSet& unit, const TrayOptions& options) {
  std::array<int, 3> order{0, 1, 2};
  const Layout unturned = layout_of(unit, options, order);
  Layout best = unturned;
  while (std::next_permutation(order.begin(), order.end())) {
    const Layout other = layout_of(unit, options, order);
    if (other.count() > best.count()) best = other;
  }
  if (best.count() < 1)
    throw std::invalid_argument(unit.name + " is " + text_of(unturned.part.size) + ": not one fits into " +
                                text_of(options.size));
  if (best.count() > kMostCopies) throw std::invalid_argument("more than 100000 copies would fit");
  return best;
}

}  // namespace

Tray make_tray(const DataSet& unit, const TrayOptions& options) {
  check(options);
  const Layout layout = best_layout(unit, options);
  Tray tray;
  tray.copies = layout.copies;
  tray.part_size = layout.part.size;
  for (std::size_t i = 0; i < 3; ++i) {
    const int n = layout.copies[i];
    if (n > 1) tray.distance[i] = (options.size[i] - n * layout.part.size[i]) / (n - 1);
  }
  tray.set = {unit.name + "_tray", "Tray of: " + unit.description, unit.unit, unit.parts, {}, {}, unit.mirrored, {}};
  tray.set.root.name = "Tray";
  tray.set.shared = unit.shared;
  tray.set.shared.push_back(unit.root);
  const int shared = static_cast<int>(tray.set.shared.size()) - 1;
  const auto offset = [&](std::size_t axis, int i) {
    return i * (tray.part_size[axis] + tray.distance[axis]) - layout.part.low[axis];
  };
  for (int k = 0; k < tray.copies[2]; ++k) {
    for (int j = 0; j < tray.copies[1]; ++j) {
      for (int i = 0; i < tray.copies[0]; ++i) {
        const std::string name =
            unit.name + " " + std::to_string(i + 1) + "." + std::to_string(j + 1) + "." + std::to_string(k + 1);
        const gp_Trsf place = translation(offset(0, i), offset(1, j), offset(2, k)) * layout.turn;
        tray.set.root.children.push_back({name, -1, place, {}, shared});
      }
    }
  }
  const std::size_t solids = placed_parts(unit).size();
  for (std::size_t copy = 0; copy < tray.set.root.children.size(); ++copy) {
    for (const Overlap& overlap : unit.overlaps)
      tray.set.overlaps.push_back({overlap.first + copy * solids, overlap.second + copy * solids, overlap.volume});
  }
  return tray;
}

}  // namespace lamella::datasets
