#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "slicing/adaptive/thin_places.h"

namespace lamella {

namespace {

constexpr double kTouch = 1e-9;  // mm

/// Bound in mm of what layers lose of a place, between the middles of two
/// layers and about the border between them: it recedes to the middle of its
/// own layer. In the other one what faces it is nearer to the middle.
double loss_between(const ThinPlace& place, double lo, double border, double hi) {
  const bool is_upper = place.half == LayerHalf::upper;
  if (!std::isfinite(is_upper ? lo : hi)) return 0.0;  // no layer there
  if (is_upper ? place.z.lo >= border : place.z.hi <= border) return 0.0;
  const double height = is_upper ? std::min(border, place.z.hi) - lo : hi - std::max(border, place.z.lo);
  return height > 0.0 ? height * place.rate : 0.0;
}

/// The largest over all pairs of layers between whose middles both the place
/// and what faces it may lie.
double loss_of(const ThinPlace& place, const std::vector<double>& borders, const std::vector<double>& middles) {
  constexpr double kNowhere = std::numeric_limits<double>::infinity();
  double most = 0.0;
  // Between the middles k - 1 and k lies the border k.
  const auto first = std::lower_bound(middles.begin(), middles.end(), place.z.lo) - middles.begin();
  for (auto k = static_cast<std::size_t>(first); k <= middles.size(); ++k) {
    const double lo = k > 0 ? middles[k - 1] : -kNowhere;
    const double hi = k < middles.size() ? middles[k] : kNowhere;
    if (lo >= place.z.hi - kTouch) break;
    if (place.z.lo >= hi - kTouch || place.other.hi <= lo + kTouch || place.other.lo >= hi - kTouch) continue;
    most = std::max(most, loss_between(place, lo, borders[k], hi));
  }
  return most;
}

}  // namespace

std::vector<ThinLoss> lost_places(const std::vector<ThinPlace>& places, const std::vector<double>& borders,
                                  const std::vector<double>& middles, double allowed) {
  std::map<FaceId, ThinLoss> worst;
  for (const ThinPlace& place : places) {
    const double deviation = loss_of(place, borders, middles);
    if (!(deviation > allowed + kTouch)) continue;
    const auto [found, is_new] = worst.try_emplace(place.face, ThinLoss{place, deviation});
    if (!is_new && found->second.deviation < deviation) found->second = {place, deviation};
  }
  std::vector<ThinLoss> out;
  for (const auto& [face, loss] : worst) out.push_back(loss);
  return out;
}

}  // namespace lamella
