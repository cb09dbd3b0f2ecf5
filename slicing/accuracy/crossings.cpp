#include "slicing/accuracy/crossings.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::accuracy {

namespace {

using Row = std::span<const Crossing>;

/// Hands out the crossings of one ray of both lists in one order; of equal ones the exact first.
class Merged {
 public:
  Merged(Row exact, Row found) : exact_(exact), found_(found) {}

  struct Item {
    double x;
    bool is_exact;
  };
  [[nodiscard]] bool empty() const { return exact_.empty() && found_.empty(); }
  Item take() {
    const bool is_exact = found_.empty() || (!exact_.empty() && exact_.front().x <= found_.front().x);
    Row& from = is_exact ? exact_ : found_;
    const Item item{from.front().x, is_exact};
    from = from.subspan(1);
    return item;
  }

 private:
  Row exact_;
  Row found_;
};

void compare_row(Row exact, Row found, CrossingErrors& errors) {
  Merged merged(exact, found);
  while (!merged.empty()) {
    const Merged::Item first = merged.take();
    const Merged::Item second = merged.take();  // both lists have even numbers
    const double length = second.x - first.x;
    errors.differing += length;
    if (first.is_exact != second.is_exact) {
      ++errors.matched;
      errors.sum += length;
      errors.squares += length * length;
      errors.largest = std::max(errors.largest, length);
    } else if (first.is_exact) {
      errors.missed += 2;
      errors.longest_missed = std::max(errors.longest_missed, length);
    } else {
      errors.false_ += 2;
      errors.longest_false = std::max(errors.longest_false, length);
    }
  }
}

/// The crossings of the ray that begins at `at`; moves `at` past them.
Row take_ray(const Crossings& all, std::size_t& at, std::uint32_t ray) {
  const std::size_t first = at;
  while (at < all.size() && all[at].ray == ray) ++at;
  return {all.data() + first, at - first};
}

}  // namespace

RayLattice lattice_of(const LayerPlan& plan) {
  RayLattice lattice;
  for (std::int64_t row = 0; row < plan.grid.size[1]; ++row) lattice.y.push_back(plan.row_y(row));
  for (const LayerSpan& layer : plan.layers) lattice.z.push_back(layer.z_sample);
  return lattice;
}

double CrossingErrors::rms() const { return matched > 0 ? std::sqrt(squares / static_cast<double>(matched)) : 0.0; }

CrossingErrors& CrossingErrors::operator+=(const CrossingErrors& other) {
  matched += other.matched;
  sum += other.sum;
  squares += other.squares;
  largest = std::max(largest, other.largest);
  missed += other.missed;
  false_ += other.false_;
  longest_missed = std::max(longest_missed, other.longest_missed);
  longest_false = std::max(longest_false, other.longest_false);
  differing += other.differing;
  return *this;
}

CrossingErrors compare_crossings(const Crossings& exact, const Crossings& found) {
  CrossingErrors errors;
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < exact.size() || j < found.size()) {
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    const std::uint32_t ray =
        std::min(i < exact.size() ? exact[i].ray : kNone, j < found.size() ? found[j].ray : kNone);
    const Row exact_row = take_ray(exact, i, ray);
    const Row found_row = take_ray(found, j, ray);
    compare_row(exact_row, found_row, errors);
  }
  return errors;
}

}  // namespace lamella::accuracy
