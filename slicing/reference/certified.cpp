#include "slicing/reference/certified.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lamella::reference {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Roots this far outside the unit square still count, so that one on a border shared by two sub-patches is found by at
/// least one of them; the engine drops the second copy.
constexpr double kBorderSlack = 1e-10;
/// A contracted cell whose Krawczyk box is this small, in its own parameters, goes to Newton although it sticks out of
/// the cell: the root lies on the cell's border.
constexpr double kBorderRoot = 1e-6;
/// F1, F2 varying by fewer rounding errors than this over a cell: nothing more can be learned from splitting it.
constexpr double kResolution = 8.0;
/// A cell is narrowed to its Krawczyk box and this much more, so that the root comes to lie inside the next cell.
constexpr double kInflation = 0.02;
/// Decided roots of one sense nearer than this, in parameters, are one that lies on a border shared by two cells.
constexpr double kSameRoot = 1e-9;
constexpr int kMaxNewton = 16;

struct MinMax {
  double lo;
  double hi;
};

MinMax min_max(const double* values, std::size_t count) {
  MinMax result{values[0], values[0]};
  for (std::size_t k = 1; k < count; ++k) {
    result.lo = std::min(result.lo, values[k]);
    result.hi = std::max(result.hi, values[k]);
  }
  return result;
}

/// Keeps its sign beyond the error: no zero.
bool excludes_zero(const MinMax& range, double error) { return range.lo > error || range.hi < -error; }

double max_abs(const MinMax& range) { return std::max(std::abs(range.lo), std::abs(range.hi)); }

/// Range of the derivative's Bernstein coefficients along u (stride = count_v) or v (stride = 1).
MinMax derivative_range(const double* net, int count_u, int count_v, bool along_u, double error) {
  MinMax result{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const int rows = along_u ? count_u - 1 : count_u;
  const int columns = along_u ? count_v : count_v - 1;
  const int stride = along_u ? count_v : 1;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double difference = net[i * count_v + j + stride] - net[i * count_v + j];
      result.lo = std::min(result.lo, difference);
      result.hi = std::max(result.hi, difference);
    }
  }
  const int degree = along_u ? rows : columns;
  if (degree == 0) return {0.0, 0.0};
  return {degree * (result.lo - 2.0 * error), degree * (result.hi + 2.0 * error)};
}

/// de Casteljau at t of `count` values with a stride: `left` takes the first part, `net` keeps the second; left may be
/// null.
void cut(double* net, double* left, int count, int stride, double t) {
  const double s = 1.0 - t;
  for (int level = 0; level < count; ++level) {
    if (left != nullptr) left[level * stride] = net[0];
    for (int i = 0; i + 1 < count - level; ++i) net[i * stride] = s * net[i * stride] + t * net[(i + 1) * stride];
  }
}

/// Cuts all rows or columns of a net; `left` may be null.
void cut_net(double* net, double* left, int count_u, int count_v, bool along_u, double t) {
  const int lines = along_u ? count_v : count_u;
  const int step = along_u ? 1 : count_v;
  for (int k = 0; k < lines; ++k) {
    cut(net + k * step, left == nullptr ? nullptr : left + k * step, along_u ? count_u : count_v, along_u ? count_v : 1,
        t);
  }
}

/// Mean difference between the last and the first line of a net, the mean derivative over the cell.
double mean_slope(const double* net, int count_u, int count_v, bool along_u) {
  const int lines = along_u ? count_v : count_u;
  const int step = along_u ? 1 : count_v;
  const int last = along_u ? (count_u - 1) * count_v : count_v - 1;
  double sum = 0.0;
  for (int k = 0; k < lines; ++k) sum += net[k * step + last] - net[k * step];
  return sum / lines;
}

/// Value in the middle of the unit square.
double value_at_center(const double* net, int count_u, int count_v) {
  std::array<double, kMaxDegree + 1> column;
  std::array<double, kMaxDegree + 1> row;
  for (int i = 0; i < count_u; ++i) {
    std::copy_n(net + static_cast<std::ptrdiff_t>(i) * count_v, count_v, row.begin());
    for (int level = count_v - 1; level > 0; --level) {
      for (int j = 0; j < level; ++j) row[j] = 0.5 * (row[j] + row[j + 1]);
    }
    column[i] = row[0];
  }
  for (int level = count_u - 1; level > 0; --level) {
    for (int i = 0; i < level; ++i) column[i] = 0.5 * (column[i] + column[i + 1]);
  }
  return column[0];
}

}  // namespace

void CertifiedSolver::solve(const PlaneNets& nets, double accuracy, std::vector<PatchRoot>& roots,
                            std::uint64_t& iterations) {
  count_u_ = nets.count_u;
  count_v_ = nets.count_v;
  size_ = nets.f1.size();
  g1_.resize(size_);
  g2_.resize(size_);
  undecided_.clear();
  roots.clear();
  cells_.assign(1, {0.0, 1.0, 0.0, 1.0, nets.error, false});
  nets_.resize(std::max(nets_.size(), 2 * size_ * 2));
  std::copy(nets.f1.begin(), nets.f1.end(), f1(0));
  std::copy(nets.f2.begin(), nets.f2.end(), f2(0));
  int boxes = 0;
  for (; !cells_.empty() && boxes < kMaxBoxes; ++boxes) {
    switch (examine(nets, accuracy, roots)) {
      case Verdict::empty:
      case Verdict::root:
        cells_.pop_back();
        break;
      case Verdict::undecided:
        report_undecided(cells_.back());
        cells_.pop_back();
        break;
      case Verdict::contracted:
        break;
      case Verdict::split:
        split();
        break;
    }
  }
  for (const Cell& cell : cells_) report_undecided(cell);
  iterations += static_cast<std::uint64_t>(boxes);
  for (const Cell& cell : undecided_) {
    roots.push_back({0.5 * (cell.u0 + cell.u1), 0.5 * (cell.v0 + cell.v1), 0.5 * (cell.u1 - cell.u0),
                     0.5 * (cell.v1 - cell.v0), true, false});
  }
}

CertifiedSolver::Verdict CertifiedSolver::examine(const PlaneNets& nets, double accuracy,
                                                  std::vector<PatchRoot>& roots) {
  const std::size_t top = cells_.size() - 1;
  const double error = cells_[top].error;
  const MinMax range1 = min_max(f1(top), size_);
  if (excludes_zero(range1, error)) return Verdict::empty;
  const MinMax range2 = min_max(f2(top), size_);
  if (excludes_zero(range2, error)) return Verdict::empty;
  if (std::max(range1.hi - range1.lo, range2.hi - range2.lo) <= kResolution * error) {
    // Every point of the cell is a zero within rounding; if it may hold one only, that is a decided one.
    const Cell& cell = cells_[top];
    const bool found =
        cell.single && polish(nets, accuracy, cell, 1.0, 0.5 * (cell.u0 + cell.u1), 0.5 * (cell.v0 + cell.v1), roots);
    return found ? Verdict::root : Verdict::undecided;
  }
  double error1 = 0.0;
  double error2 = 0.0;
  if (!precondition(error1, error2)) return Verdict::split;
  if (excludes_zero(min_max(g1_.data(), size_), error1)) return Verdict::empty;
  if (excludes_zero(min_max(g2_.data(), size_), error2)) return Verdict::empty;
  return prove(nets, accuracy, error1, error2, roots);
}

/// G = J^-1 F with J the mean Jacobian of the cell, so that G is about (u - u*, v - v*). False where J is singular.
bool CertifiedSolver::precondition(double& error1, double& error2) {
  const std::size_t top = cells_.size() - 1;
  const double* n1 = f1(top);
  const double* n2 = f2(top);
  const double a = mean_slope(n1, count_u_, count_v_, true);
  const double b = mean_slope(n1, count_u_, count_v_, false);
  const double c = mean_slope(n2, count_u_, count_v_, true);
  const double d = mean_slope(n2, count_u_, count_v_, false);
  const double determinant = a * d - b * c;
  // Below this the inverse is mostly rounding error; also false for NaN.
  if (!(std::abs(determinant) > 1e-12 * (std::abs(a * d) + std::abs(b * c)))) return false;
  const double i11 = d / determinant, i12 = -b / determinant;
  const double i21 = -c / determinant, i22 = a / determinant;
  double largest = 0.0;
  for (std::size_t k = 0; k < size_; ++k) {
    g1_[k] = i11 * n1[k] + i12 * n2[k];
    g2_[k] = i21 * n1[k] + i22 * n2[k];
    largest = std::max({largest, std::abs(n1[k]), std::abs(n2[k])});
  }
  // The coefficients of the combination count as exact numbers; only the products and the sum are rounded.
  const double error = cells_[top].error + 2.0 * kEpsilon * largest;
  error1 = (std::abs(i11) + std::abs(i12)) * error;
  error2 = (std::abs(i21) + std::abs(i22)) * error;
  return std::isfinite(error1) && std::isfinite(error2);
}

/// The uniqueness and existence tests on the preconditioned functions.
CertifiedSolver::Verdict CertifiedSolver::prove(const PlaneNets& nets, double accuracy, double error1, double error2,
                                                std::vector<PatchRoot>& roots) {
  const MinMax a = derivative_range(g1_.data(), count_u_, count_v_, true, error1);
  const MinMax d = derivative_range(g2_.data(), count_u_, count_v_, false, error2);
  if (!(a.lo > 0.0 && d.lo > 0.0)) return Verdict::split;
  const double b = max_abs(derivative_range(g1_.data(), count_u_, count_v_, false, error1));
  const double c = max_abs(derivative_range(g2_.data(), count_u_, count_v_, true, error2));
  // Every matrix in the interval Jacobian is regular: at most one zero in the cell.
  if (!(a.lo * d.lo > b * c * (1.0 + 1e-12))) return Verdict::split;

  const double center1 = value_at_center(g1_.data(), count_u_, count_v_);
  const double center2 = value_at_center(g2_.data(), count_u_, count_v_);
  // Krawczyk: K = m - G(m) + (I - G'(X)) (X - m), |X - m| <= 1/2, in the cell's own unit square.
  const double radius_u = 0.5 * (std::max(std::abs(1.0 - a.lo), std::abs(1.0 - a.hi)) + b) + error1 + 4.0 * kEpsilon;
  const double radius_v = 0.5 * (std::max(std::abs(1.0 - d.lo), std::abs(1.0 - d.hi)) + c) + error2 + 4.0 * kEpsilon;
  const Range ku{0.5 - center1 - radius_u, 0.5 - center1 + radius_u};
  const Range kv{0.5 - center2 - radius_v, 0.5 - center2 + radius_v};
  const Cell cell = cells_.back();
  // In a cell at the border of the sub-patch the slack is part of the domain, whatever the size of the cell.
  const double slack_u = kBorderSlack / (cell.u1 - cell.u0);
  const double slack_v = kBorderSlack / (cell.v1 - cell.v0);
  if (ku.hi < -slack_u || ku.lo > 1.0 + slack_u || kv.hi < -slack_v || kv.lo > 1.0 + slack_v) return Verdict::empty;

  const bool inside = ku.lo > 0.0 && ku.hi < 1.0 && kv.lo > 0.0 && kv.hi < 1.0;
  const bool tiny = std::max(radius_u, radius_v) < kBorderRoot;
  if (inside || tiny) {
    const double slack = std::max({error1, error2, kBorderRoot});
    const double u = cell.u0 + (cell.u1 - cell.u0) * (0.5 - center1);
    const double v = cell.v0 + (cell.v1 - cell.v0) * (0.5 - center2);
    if (polish(nets, accuracy, cell, slack, u, v, roots)) return Verdict::root;
    // A proved root that Newton can't reach to the accuracy: as doubtful as a tangency.
    return inside ? Verdict::undecided : Verdict::empty;
  }
  const auto inflated = [](Range k) {
    return Range{std::clamp(k.lo - kInflation, 0.0, 1.0), std::clamp(k.hi + kInflation, 0.0, 1.0)};
  };
  const Range cu = inflated(ku);
  const Range cv = inflated(kv);
  if ((cu.hi - cu.lo) * (cv.hi - cv.lo) > 0.5) return Verdict::split;
  contract(cu, cv);
  return Verdict::contracted;
}

/// Newton on the whole sub-patch from a start in `cell`; false if it leaves the cell (widened by `slack` of its size)
/// or the sub-patch, or doesn't reach the accuracy.
bool CertifiedSolver::polish(const PlaneNets& nets, double accuracy, const Cell& cell, double slack, double u, double v,
                             std::vector<PatchRoot>& roots) const {
  double best = std::numeric_limits<double>::infinity();
  double best_u = u;
  double best_v = v;
  double determinant = 0.0;
  for (int step = 0; step < kMaxNewton; ++step) {
    const PlaneValues f = evaluate(nets, u, v);
    const double residual = std::max(std::abs(f.f1), std::abs(f.f2));
    // Not less than half of the last: rounding has been reached.
    if (!(residual < 0.5 * best)) break;
    best = residual;
    best_u = u;
    best_v = v;
    determinant = f.determinant();
    if (residual == 0.0) break;
    u -= (f.f1 * f.f2_v - f.f2 * f.f1_v) / determinant;
    v -= (f.f2 * f.f1_u - f.f1 * f.f2_u) / determinant;
  }
  if (!(best <= accuracy + nets.error)) return false;
  const double slack_u = kBorderSlack + slack * (cell.u1 - cell.u0);
  const double slack_v = kBorderSlack + slack * (cell.v1 - cell.v0);
  if (best_u < cell.u0 - slack_u || best_u > cell.u1 + slack_u) return false;
  if (best_v < cell.v0 - slack_v || best_v > cell.v1 + slack_v) return false;
  const PatchRoot root{best_u, best_v, 0.0, 0.0, false, determinant > 0.0};
  const auto is_same = [&](const PatchRoot& other) {
    return !other.undecided && other.enters == root.enters && std::abs(other.u - root.u) < kSameRoot &&
           std::abs(other.v - root.v) < kSameRoot;
  };
  if (std::none_of(roots.begin(), roots.end(), is_same)) roots.push_back(root);
  return true;
}

/// Replaces the last cell by a part of it, given in its own unit square.
void CertifiedSolver::contract(Range ku, Range kv) {
  const std::size_t top = cells_.size() - 1;
  Cell& cell = cells_[top];
  double largest = 0.0;
  for (double* net : {f1(top), f2(top)}) {
    for (std::size_t k = 0; k < size_; ++k) largest = std::max(largest, std::abs(net[k]));
  }
  const auto keep = [&](double* net, bool along_u, Range part) {
    const int lines = along_u ? count_v_ : count_u_;
    const int count = along_u ? count_u_ : count_v_;
    const int step = along_u ? 1 : count_v_;
    const int stride = along_u ? count_v_ : 1;
    for (int k = 0; k < lines; ++k) {
      double* line = net + k * step;
      std::array<double, kMaxDegree + 1> kept;
      if (part.lo > 0.0) cut(line, nullptr, count, stride, part.lo);
      if (part.hi >= 1.0) continue;
      std::array<double, kMaxDegree + 1> rest;
      for (int i = 0; i < count; ++i) rest[i] = line[i * stride];
      cut(rest.data(), kept.data(), count, 1, (part.hi - part.lo) / (1.0 - part.lo));
      for (int i = 0; i < count; ++i) line[i * stride] = kept[i];
    }
  };
  for (double* net : {f1(top), f2(top)}) {
    keep(net, true, ku);
    keep(net, false, kv);
  }
  // Two cuts along each direction, each with at most `degree` roundings of convex combinations.
  cell.error += 4.0 * (count_u_ + count_v_) * kEpsilon * largest;
  const double width_u = cell.u1 - cell.u0;
  const double width_v = cell.v1 - cell.v0;
  cell = {cell.u0 + width_u * ku.lo,
          cell.u0 + width_u * ku.hi,
          cell.v0 + width_v * kv.lo,
          cell.v0 + width_v * kv.hi,
          cell.error,
          true};
}

/// Halves the last cell where F1 and F2 vary more, so that a ray that runs along the surface for a while costs one
/// column of cells and not a square of them.
void CertifiedSolver::split() {
  const bool along_u = varies_more_along_u();
  const std::size_t top = cells_.size() - 1;
  nets_.resize(std::max(nets_.size(), 2 * size_ * (top + 2)));
  Cell& cell = cells_[top];
  double largest = 0.0;
  for (std::size_t k = 0; k < 2 * size_; ++k) largest = std::max(largest, std::abs(f1(top)[k]));
  cell.error += (along_u ? count_u_ : count_v_) * kEpsilon * largest;
  cut_net(f1(top), f1(top + 1), count_u_, count_v_, along_u, 0.5);
  cut_net(f2(top), f2(top + 1), count_u_, count_v_, along_u, 0.5);
  Cell first = cell;
  if (along_u) {
    first.u1 = cell.u0 = 0.5 * (cell.u0 + cell.u1);
  } else {
    first.v1 = cell.v0 = 0.5 * (cell.v0 + cell.v1);
  }
  cells_.push_back(first);
}

bool CertifiedSolver::varies_more_along_u() const {
  const double* net = nets_.data() + 2 * size_ * (cells_.size() - 1);
  const auto variation = [&](bool along_u) {
    double largest = 0.0;
    for (const double* f : {net, net + size_}) {
      const int stride = along_u ? count_v_ : 1;
      const int rows = along_u ? count_u_ - 1 : count_u_;
      const int columns = along_u ? count_v_ : count_v_ - 1;
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
          const int k = i * count_v_ + j;
          largest = std::max(largest, std::abs(f[k + stride] - f[k]));
        }
      }
    }
    return largest * (along_u ? count_u_ - 1 : count_v_ - 1);
  };
  return variation(true) >= variation(false);
}

/// Joins cells that touch, so that one tangency is one report.
void CertifiedSolver::report_undecided(const Cell& cell) {
  const auto touches = [&](const Cell& other) {
    return cell.u0 <= other.u1 + kBorderSlack && other.u0 <= cell.u1 + kBorderSlack &&
           cell.v0 <= other.v1 + kBorderSlack && other.v0 <= cell.v1 + kBorderSlack;
  };
  const auto found = std::find_if(undecided_.begin(), undecided_.end(), touches);
  if (found == undecided_.end()) {
    undecided_.push_back(cell);
    return;
  }
  *found = {std::min(found->u0, cell.u0),
            std::max(found->u1, cell.u1),
            std::min(found->v0, cell.v0),
            std::max(found->v1, cell.v1),
            cell.error,
            false};
}

}  // namespace lamella::reference
