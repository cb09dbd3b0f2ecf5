#pragma once

#include <cstdint>
#include <vector>

#include "slicing/reference/plane_nets.h"

namespace lamella::reference {

/// Finds every zero of eq. (7) on a sub-patch, each with a proof, by interval subdivision.
///
/// A box of the unit square is discarded when the Bernstein coefficients of F1, F2, or of their combinations by the
/// inverse of the mean Jacobian, keep one sign beyond their rounding error; it holds at most one zero when the interval
/// Jacobian is regular; the Krawczyk operator then proves existence or absence, or narrows the box. What stays open
/// when F1 and F2 vary by no more than their own rounding error is reported as undecided: a tangency. The derivation is
/// in docs/methods/reference-engine.md.
class CertifiedSolver {
 public:
  /// Replaces `roots` by the roots on the unit square, widened by 1e-10, in no particular order; undecided boxes that
  /// touch are one. `accuracy` is the distance in mm from the ray at which Newton's iteration stops. `iterations`
  /// counts boxes. Work is bounded by kMaxBoxes; the rest is then reported as undecided.
  void solve(const PlaneNets& nets, double accuracy, std::vector<PatchRoot>& roots, std::uint64_t& iterations);

  static constexpr int kMaxBoxes = 6000;

 private:
  struct Cell {
    double u0, u1, v0, v1;
    double error;         ///< of the coefficients of this cell
    bool single = false;  ///< proved to hold at most one zero
  };
  struct Range {
    double lo, hi;
  };
  enum class Verdict { empty, root, contracted, split, undecided };

  Verdict examine(const PlaneNets& nets, double accuracy, std::vector<PatchRoot>& roots);
  Verdict prove(const PlaneNets& nets, double accuracy, double error1, double error2, std::vector<PatchRoot>& roots);
  bool precondition(double& error1, double& error2);
  bool polish(const PlaneNets& nets, double accuracy, const Cell& cell, double slack, double u, double v,
              std::vector<PatchRoot>& roots) const;
  void contract(Range ku, Range kv);
  void split();
  void report_undecided(const Cell& cell);
  [[nodiscard]] bool varies_more_along_u() const;

  double* f1(std::size_t cell) { return nets_.data() + 2 * size_ * cell; }
  double* f2(std::size_t cell) { return f1(cell) + size_; }

  int count_u_ = 0;
  int count_v_ = 0;
  std::size_t size_ = 0;
  std::vector<Cell> cells_;      ///< open cells, the last one is examined next
  std::vector<double> nets_;     ///< coefficients of F1, F2 on each open cell
  std::vector<double> g1_, g2_;  ///< the preconditioned functions on the last cell
  std::vector<Cell> undecided_;
};

}  // namespace lamella::reference
