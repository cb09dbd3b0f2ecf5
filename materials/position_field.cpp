#include "materials/position_field.h"

#include <algorithm>
#include <utility>

#include "core/xml.h"
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

std::string vector_text(const Vec3& vector) {
  return format_double(vector.x()) + " " + format_double(vector.y()) + " " + format_double(vector.z());
}

std::string element_of_stops(const std::string& name, const std::string& attributes, const Stops& stops,
                             const std::string& indent) {
  return indent + "<" + name + attributes + ">\n" + stops.elements(indent + "  ") + indent + "</" + name + ">\n";
}

class SameForAll final : public FieldSource {
 public:
  SameForAll(std::shared_ptr<const Field> field, std::string name, std::string attributes, Stops stops)
      : field_(std::move(field)),
        name_(std::move(name)),
        attributes_(std::move(attributes)),
        stops_(std::move(stops)) {}
  [[nodiscard]] std::shared_ptr<const Field> bind(const Scene&, SolidId) const override { return field_; }
  [[nodiscard]] std::string element(const std::string& indent, const std::filesystem::path&) const override {
    return element_of_stops(name_, attributes_, stops_, indent);
  }

 private:
  std::shared_ptr<const Field> field_;
  std::string name_;
  std::string attributes_;
  Stops stops_;
};

template <class Position>
std::shared_ptr<const FieldSource> same_for_all(std::string name, std::string attributes, const Stops& stops,
                                                Position position) {
  return std::make_shared<SameForAll>(std::make_shared<PositionField<Position>>(stops, std::move(position)),
                                      std::move(name), std::move(attributes), stops);
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
  [[nodiscard]] std::string element(const std::string& indent, const std::filesystem::path&) const override {
    return element_of_stops("distance", faces_ ? attribute_text("faces", *faces_) : "", stops_, indent);
  }

 private:
  std::optional<std::string> faces_;
  Stops stops_;
  std::string where_;
};

}  // namespace

std::shared_ptr<const FieldSource> make_axis_field(const Vec3& origin, const Vec3& direction, Stops stops) {
  const std::string attributes =
      attribute_text("origin", vector_text(origin)) + attribute_text("direction", vector_text(direction));
  return same_for_all("axis", attributes, stops,
                      [origin, direction](const Vec3& point) { return direction.dot(point - origin); });
}

std::shared_ptr<const FieldSource> make_radial_field(const Vec3& origin, const std::optional<Vec3>& direction,
                                                     Stops stops) {
  std::string attributes = attribute_text("origin", vector_text(origin));
  if (!direction) {
    return same_for_all("radial", attributes, stops, [origin](const Vec3& point) { return (point - origin).norm(); });
  }
  attributes += attribute_text("direction", vector_text(*direction));
  return same_for_all("radial", attributes, stops, [origin, direction = *direction](const Vec3& point) {
    return direction.cross(point - origin).norm();
  });
}

std::shared_ptr<const FieldSource> make_distance_field(std::optional<std::string> faces, Stops stops,
                                                       std::string where) {
  return std::make_shared<DistanceSource>(std::move(faces), std::move(stops), std::move(where));
}

}  // namespace lamella
