#include "slicing/orient/axis_scan.h"

#include <cmath>

#include "core/error.h"

namespace lamella {

namespace {

constexpr double kLeastStep = 1e-3;  // degree: 360 000 heights an axis
constexpr double kLargestStep = 180.0;

/// Heights that differ by rounding alone are no gain.
constexpr double kGain = 1e-12;

void check(const AxisScan& scan) {
  if (scan.axes.empty()) throw UsageError("no axis to turn about", "--axis", "name one: --axis x");
  for (const Vec3& axis : scan.axes) {
    const double length = axis.stableNorm();
    if (!(length > 0.0) || !std::isfinite(length))
      throw UsageError("an axis has to be finite and not zero", "--axis", "e.g. --axis 1,0,0");
  }
  if (!(scan.step >= kLeastStep && scan.step <= kLargestStep))
    throw UsageError("the step has to lie between 0.001 and 180 degrees", "--step", "1 is usual");
}

class Scanner {
 public:
  Scanner(const SupportFunction& support, const AxisScan& scan, const Progress& progress)
      : support_(support), scan_(scan), progress_(progress) {}

  AxisScanResult run() {
    result_.height = height(Mat3::Identity());
    // Every round lowers the height by one of finitely many turns; the limit is against endless small gains.
    constexpr int kMostRounds = 100;
    for (int round = 0; round < kMostRounds; ++round) {
      bool is_lower = false;
      for (std::size_t axis = 0; axis < scan_.axes.size(); ++axis) is_lower = turn_about(axis) || is_lower;
      if (!is_lower || scan_.axes.size() == 1) break;
    }
    return result_;
  }

 private:
  double height(const Mat3& turn) {
    ++result_.heights;
    return support_.width(turn.row(2).transpose().normalized());
  }

  bool turn_about(std::size_t axis) {
    const Vec3 direction = scan_.axes[axis].stableNormalized();
    const Mat3 start = result_.turn;
    const auto count = static_cast<int>(std::ceil(360.0 / scan_.step - 1e-9));
    bool is_lower = false;
    for (int i = 1; i < count; ++i) {
      if (i % 64 == 0) {
        progress_.throw_if_cancelled();
        progress_.report("turning about axes", static_cast<double>(i) / count);
      }
      const double angle = i * scan_.step;
      const Mat3 turn = Eigen::AngleAxisd(angle / 180.0 * kPi, direction).toRotationMatrix() * start;
      const double lower = height(turn);
      if (!(lower < result_.height * (1.0 - kGain))) continue;
      result_.height = lower;
      result_.turn = turn;
      if (is_lower) result_.turns.pop_back();
      result_.turns.push_back({axis, angle, lower});
      is_lower = true;
    }
    return is_lower;
  }

  const SupportFunction& support_;
  const AxisScan& scan_;
  const Progress& progress_;
  AxisScanResult result_;
};

}  // namespace

AxisScanResult scan_axes(const SupportFunction& support, const AxisScan& scan, const Progress& progress) {
  check(scan);
  return Scanner(support, scan, progress).run();
}

}  // namespace lamella
