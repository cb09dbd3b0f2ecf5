#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "core/geometry.h"
#include "model/scene.h"

namespace lamella {

/// Where fractions must be put right by more than this, it is a finding of the run.
inline constexpr double kFractionSlack = 1e-6;

/// How far sampled and interpolated fractions may lie from the field, all in all.
inline constexpr double kMixTolerance = 1e-3;

/// The points origin + x along, x in a range, mm; `along` has unit length.
struct RowPiece {
  Vec3 origin = Vec3::Zero();
  Vec3 along = Vec3::UnitX();
  Interval range;
};

/// Samples a field for one thread.
class FieldProbe {
 public:
  virtual ~FieldProbe() = default;
  /// From now on only points of this piece of a row are sampled, in the part's frame. What is sampled may then be off
  /// by a quarter of kMixTolerance.
  virtual void start_row(const RowPiece&) {}
  /// From now on any points are sampled, exactly, as at first.
  virtual void start_points() {}
  /// Volume fractions, one a component, at a point of the part's frame (mm). They are 0 or more and their sum is 1 to
  /// rounding. Returns by how much they had to be put right for that; more than kFractionSlack is a fault of the field.
  virtual double sample(const Vec3& point, std::span<double> fractions) = 0;
};

/// Volume fractions of the components of a graded material at the points of a part (docs/methods/graded-materials.md).
/// Immutable; probes of several threads may share it.
class Field {
 public:
  virtual ~Field() = default;
  [[nodiscard]] virtual std::unique_ptr<FieldProbe> probe() const = 0;
  /// mm: details of the field that are smaller than this may be overlooked by who samples it; 0 if it doesn't know.
  [[nodiscard]] virtual double detail() const = 0;
};

/// A field as it is described, before it is known which solid it is for.
class FieldSource {
 public:
  virtual ~FieldSource() = default;
  /// The field of a solid; solids that are copies of one body may share it. The scene must outlive it. Throws
  /// InputError, e.g. for face names that the solid doesn't have.
  [[nodiscard]] virtual std::shared_ptr<const Field> bind(const Scene& scene, SolidId solid) const = 0;
  /// The element of materials.xml that describes the field (docs/formats/materials.md), as whole lines that begin with
  /// `indent`, for a file in the folder `beside`: read from there it gives the same field. Tables become stops.
  [[nodiscard]] virtual std::string element(const std::string& indent, const std::filesystem::path& beside) const = 0;
};

/// ` name="value"`, the value escaped.
[[nodiscard]] std::string attribute_text(const char* name, const std::string& value);

/// Clamps fractions to 0 or more and scales them to the sum 1; numbers that aren't finite become 0, and if nothing is
/// left, all is the first component. Returns the largest change.
double repair_fractions(std::span<double> fractions);

}  // namespace lamella
