#include "materials/position_field.h"

#include <algorithm>
#include <utility>

#include "materials/distance_row.h"
#include "materials/part_distance.h"

namespace lamella {

namespace {

/// Samples stops at what `Position` makes of a point.
template <class Position>
class StopsProbe final : public FieldProbe {
 public:
  StopsProbe(const Stops& stops, Position position) : stops_(stops), position_(std::move(position)) {}
  double sample(const Vec3& point, std::span<double> fractions) override {
    stops_.sample(position_(point), fractions);
    return 0.0;
  }

 private:
  const Stops& stops_;
  Position position_;
};

/// mm: where fractions jump, the distance needs to be no more exact than this.
constexpr double kFinest = 1e-4;

/// Samples stops at the distance from faces.
class DistanceProbe final : public FieldProbe {
 public:
  /// Behind the last stop nothing changes, so no one needs to know how far it is.
  DistanceProbe(const Stops& stops, const PartDistance& distance)
      : stops_(stops),
        distance_(distance),
        row_(distance, {std::max(stops.last(), kFinest),
                        std::max(0.25 * kMixTolerance / std::max(stops.steepest(), kMixTolerance), kFinest)}) {}

  double sample(const Vec3& point, std::span<double> fractions) override {
    stops_.sample(is_row_ ? row_.at((point - piece_.origin).dot(piece_.along)) : exact(point), fractions);
    return 0.0;
  }
  void start_points() override { is_row_ = false; }
  void start_row(const RowPiece& piece) override {
    piece_ = piece;
    is_row_ = true;
    row_.build(piece);
  }

 private:
  [[nodiscard]] double exact(const Vec3& point) const {
    const auto found = distance_.find(point, stops_.last());
    return found ? found->distance : stops_.last();
  }

  const Stops& stops_;
  const PartDistance& distance_;
  DistanceRow row_;
  RowPiece piece_;
  bool is_row_ = false;
};

/// A field that is the same for every solid: `Position` needs no state.
template <class Position>
class PositionField final : public Field {
 public:
  PositionField(Stops stops, Position position) : stops_(std::move(stops)), position_(std::move(position)) {}
  [[nodiscard]] std::unique_ptr<FieldProbe> probe() const override {
    return std::make_unique<StopsProbe<Position>>(stops_, position_);
  }
  [[nodiscard]] double detail() const override { return stops_.detail(); }

 private:
  Stops stops_;
  Position position_;
};

class SameForAll final : public FieldSource {
 public:
  explicit SameForAll(std::shared_ptr<const Field> field) : field_(std::move(field)) {}
  [[nodiscard]] std::shared_ptr<const Field> bind(const Scene&, SolidId) const override { return field_; }

 private:
  std::shared_ptr<const Field> field_;
};

template <class Position>
std::shared_ptr<const FieldSource> same_for_all(Stops stops, Position position) {
  return std::make_shared<SameForAll>(std::make_shared<PositionField<Position>>(std::move(stops), std::move(position)));
}

class DistanceField final : public Field {
 public:
  DistanceField(Stops stops, std::shared_ptr<const PartDistance> distance)
      : stops_(std::move(stops)), distance_(std::move(distance)) {}
  [[nodiscard]] std::unique_ptr<FieldProbe> probe() const override {
    return std::make_unique<DistanceProbe>(stops_, *distance_);
  }
  [[nodiscard]] double detail() const override { return stops_.detail(); }

 private:
  Stops stops_;
  std::shared_ptr<const PartDistance> distance_;
};

class DistanceSource final : public FieldSource {
 public:
  DistanceSource(std::optional<std::string> faces, Stops stops, std::string where)
      : faces_(std::move(faces)), stops_(std::move(stops)), where_(std::move(where)) {}
  [[nodiscard]] std::shared_ptr<const Field> bind(const Scene& scene, SolidId solid) const override {
    return std::make_shared<DistanceField>(stops_, std::make_shared<PartDistance>(scene, solid, faces_, where_));
  }

 private:
  std::optional<std::string> faces_;
  Stops stops_;
  std::string where_;
};

}  // namespace

std::shared_ptr<const FieldSource> make_axis_field(const Vec3& origin, const Vec3& direction, Stops stops) {
  return same_for_all(std::move(stops),
                      [origin, direction](const Vec3& point) { return direction.dot(point - origin); });
}

std::shared_ptr<const FieldSource> make_radial_field(const Vec3& origin, const std::optional<Vec3>& direction,
                                                     Stops stops) {
  if (!direction) {
    return same_for_all(std::move(stops), [origin](const Vec3& point) { return (point - origin).norm(); });
  }
  return same_for_all(std::move(stops), [origin, direction = *direction](const Vec3& point) {
    return direction.cross(point - origin).norm();
  });
}

std::shared_ptr<const FieldSource> make_distance_field(std::optional<std::string> faces, Stops stops,
                                                       std::string where) {
  return std::make_shared<DistanceSource>(std::move(faces), std::move(stops), std::move(where));
}

}  // namespace lamella
