#include "export/orient_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "export/png_image.h"

namespace lamella {

namespace {

constexpr Color kSupported{0.86, 0.20, 0.16};
constexpr Color kContact{0.16, 0.62, 0.30};
constexpr Color kPlate{0.80, 0.83, 0.87};

/// Rows: right, up and towards the eye, of an eye at the front right, 25 degrees above the plate or below.
Mat3 make_view(bool from_below) {
  const double around = -60.0 / 180.0 * kPi;
  const double above = (from_below ? -25.0 : 25.0) / 180.0 * kPi;
  const Vec3 eye(std::cos(above) * std::cos(around), std::cos(above) * std::sin(around), std::sin(above));
  const Vec3 right = Vec3::UnitZ().cross(eye).normalized();
  Mat3 view;
  view.row(0) = right;
  view.row(1) = eye.cross(right);
  view.row(2) = eye;
  return view;
}

class Painter {
 public:
  Painter(const OrientPicture& picture, const Box3& box)
      : picture_(picture),
        view_(make_view(picture.from_below)),
        image_(picture.width, picture.height, 32),
        depth_(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height),
               -std::numeric_limits<double>::infinity()) {
    Box3 seen;
    for (int corner = 0; corner < 8; ++corner) seen.extend(view_ * box.corner(static_cast<Box3::CornerType>(corner)));
    const Vec3 size = seen.sizes();
    constexpr double kMargin = 0.94;
    scale_ = kMargin * std::min(picture.width / std::max(size.x(), 1e-9), picture.height / std::max(size.y(), 1e-9));
    middle_ = seen.center();
  }

  /// A square of `side` mm at a point of the machine's frame.
  void paint(const Vec3& point, double side, const Color& color, double light) {
    const Vec3 at = view_ * point - middle_;
    const double half = std::max(0.5, 0.5 * side * scale_);
    const double x = 0.5 * picture_.width + scale_ * at.x();
    const double y = 0.5 * picture_.height - scale_ * at.y();
    const int left = std::max(0, static_cast<int>(std::floor(x - half)));
    const int right = std::min(picture_.width, static_cast<int>(std::ceil(x + half)));
    const unsigned rgba = pack(color, light);
    for (int row = std::max(0, static_cast<int>(std::floor(y - half)));
         row < std::min(picture_.height, static_cast<int>(std::ceil(y + half))); ++row) {
      for (int column = left; column < right; ++column) {
        double& depth = depth_[static_cast<std::size_t>(row) * static_cast<std::size_t>(picture_.width) +
                               static_cast<std::size_t>(column)];
        if (!(at.z() > depth)) continue;
        depth = at.z();
        image_.fill(row, column, column + 1, rgba);
      }
    }
  }

  [[nodiscard]] double light_on(const Vec3& normal) const {
    const Vec3 lamp = (view_.transpose() * Vec3(-0.4, 0.6, 0.7)).normalized();
    return 0.45 + 0.55 * std::max(0.0, normal.dot(lamp));
  }
  [[nodiscard]] bool is_turned_away(const Vec3& normal) const { return normal.dot(view_.row(2)) < 0.0; }
  [[nodiscard]] double pixel() const { return 1.0 / scale_; }
  [[nodiscard]] std::string png() const { return encode_png(image_, {}); }

 private:
  static unsigned pack(const Color& color, double light) {
    unsigned value = 0;
    for (const double part : color)
      value = (value << 8) | static_cast<unsigned>(std::lround(255.0 * std::clamp(part * light, 0.0, 1.0)));
    return (value << 8) | 255U;
  }

  const OrientPicture& picture_;
  const Mat3 view_;
  PackedImage image_;
  std::vector<double> depth_;
  double scale_ = 1.0;
  Vec3 middle_ = Vec3::Zero();
};

void paint_plate(Painter& painter, const Box3& box) {
  const double step = std::max(painter.pixel(), 2e-3 * box.diagonal().norm());
  const Vec3 size = box.sizes();
  for (double x = 0.0; x <= size.x(); x += step) {
    for (double y = 0.0; y <= size.y(); y += step)
      painter.paint(Vec3(box.min().x() + x, box.min().y() + y, box.min().z()), 1.2 * step, kPlate, 1.0);
  }
}

}  // namespace

std::string draw_orientation(const SurfaceSamples& samples, std::span<const Color> colors,
                             const OrientPicture& picture) {
  if (samples.samples.empty() || colors.size() != samples.samples.size()) return {};
  Box3 box;
  for (const SurfaceSample& sample : samples.samples) box.extend(picture.turn * sample.point);
  const double plate = box.min().z();
  const double near = 1e-3 * box.diagonal().norm();
  Box3 stage = box;
  stage.min().head<2>() -= Vec2::Constant(0.06 * box.diagonal().norm());
  stage.max().head<2>() += Vec2::Constant(0.06 * box.diagonal().norm());
  Painter painter(picture, stage);
  if (!picture.from_below) paint_plate(painter, stage);
  const double steepest = std::cos(picture.critical_angle);
  for (std::size_t i = 0; i < samples.samples.size(); ++i) {
    const SurfaceSample& sample = samples.samples[i];
    const Vec3 point = picture.turn * sample.point;
    const Vec3 normal = picture.turn * sample.normal;
    const bool is_low = point.z() - plate <= near;
    const bool is_under = -normal.z() > steepest;
    if (painter.is_turned_away(normal)) continue;
    const Color& color = !is_under ? colors[i] : is_low ? kContact : kSupported;
    painter.paint(point, 1.7 * std::sqrt(sample.area), color, is_under ? 0.9 : painter.light_on(normal));
  }
  return painter.png();
}

}  // namespace lamella
