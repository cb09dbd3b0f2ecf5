#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "materials/compositions.h"
#include "slicing/layer.h"
#include "slicing/slab.h"

namespace lamella {

/// What went wrong while fields were sampled.
struct MixFaults {
  std::uint64_t samples = 0;     ///< all that were taken
  std::uint64_t repaired = 0;    ///< fractions that had to be put right by more than kFractionSlack
  double largest_repair = 0.0;   ///< by how much at most
  std::uint64_t unresolved = 0;  ///< segments on which the knots ran out before the tolerance was met

  MixFaults& operator+=(const MixFaults& other);
};

/// Lays knots along the graded segments of a layer (docs/methods/graded-materials.md).
class Mixer {
 public:
  /// `compositions` must outlive it. `tolerance` is in volume fractions, more than 0.
  Mixer(const Compositions& compositions, const Box3& bounds, double tolerance = kMixTolerance);

  /// Memory of one thread.
  class Workspace {
   public:
    explicit Workspace(const Mixer& mixer) : probe_(mixer.compositions_) {}

   private:
    friend class Mixer;

    /// A place along the row and where in samples_ its fractions are.
    struct Knot {
      double x = 0.0;
      std::size_t sample = 0;
    };
    [[nodiscard]] Knot take(double x, MixFaults& faults);
    [[nodiscard]] const double* at(const Knot& knot) const { return samples_.data() + knot.sample; }
    /// By how much the fractions at `knot` differ from those on the straight line between two others.
    [[nodiscard]] double bend(const Knot& from, const Knot& knot, const Knot& to) const;

    Compositions::Probe probe_;
    std::size_t components_ = 0;
    Vec3 origin_ = Vec3::Zero();  ///< the point at x = 0
    Vec3 along_ = Vec3::UnitX();
    std::vector<double> samples_;
    std::vector<Knot> knots_;
  };

  /// Writes rows.mixtures. The result depends on the rows alone.
  void mix(double z, const RowLattice& lattice, SegmentRows& rows, Workspace& workspace, MixFaults& faults) const;

 private:
  struct Part;
  void lay_knots(const Segment& segment, Workspace& workspace, MixFaults& faults) const;
  bool refine(const Part& part, Workspace& workspace, MixFaults& faults) const;
  void thin_out(Workspace& workspace) const;

  const Compositions& compositions_;
  double tolerance_;
  double longest_;  ///< mm between knots at first, where a field doesn't know its details
};

/// Adds the lengths that the components take of the graded segments of `rows`, times their fractions, to sums by
/// material; `lengths` of graded materials become 0, since what they hold is counted with what they consist of.
void add_component_lengths(const SegmentRows& rows, const IdVector<MaterialId, Material>& materials,
                           std::vector<double>& lengths);

}  // namespace lamella
