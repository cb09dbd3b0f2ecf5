#include "materials/expression_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <muParser.h>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/xml.h"
#include "materials/distance_row.h"
#include "materials/part_distance.h"

namespace lamella {

namespace {

/// A formula is a line or two; more is made to exhaust the parser.
constexpr std::size_t kMaxLength = 4096;
constexpr int kMaxNesting = 64;

/// mm, of d.
constexpr double kDistanceTolerance = 1e-4;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

constexpr const char* kHint =
    "variables are x, y, z, r and d in mm; functions those of muParser: sin, sqrt, exp, min ...";

/// The values a formula may use, in the order of kNames.
using Variables = std::array<double, 5>;
constexpr std::array<const char*, 5> kNames{"x", "y", "z", "r", "d"};

void check_text(const Formula& formula) {
  if (formula.text.size() > kMaxLength) {
    throw InputError("a formula of more than 4096 characters", formula.where, "use a table or a grid");
  }
  int open = 0;
  int deepest = 0;
  for (const char c : formula.text) {
    if (c == '(') deepest = std::max(deepest, ++open);
    if (c == ')') --open;
    if (c == '"') throw InputError("a formula with a text in it", formula.where, kHint);
  }
  if (deepest > kMaxNesting) throw InputError("a formula nested over 64 deep", formula.where, "write it flatter");
}

[[noreturn]] void refuse(const Formula& formula, const std::string& why) {
  throw InputError("the formula '" + formula.text.substr(0, 80) + "' can't be used: " + why, formula.where, kHint);
}

/// Reads a formula whose variables lie in `variables`, and tries it.
mu::Parser make_parser(const Formula& formula, Variables& variables) {
  mu::Parser parser;
  try {
    for (std::size_t i = 0; i < kNames.size(); ++i) parser.DefineVar(kNames[i], &variables[i]);
    parser.SetExpr(formula.text);
    int results = 0;
    parser.Eval(results);
    if (results != 1) refuse(formula, "it has " + std::to_string(results) + " results");
  } catch (const mu::Parser::exception_type& error) {
    refuse(formula, error.GetMsg());
  }
  return parser;
}

bool uses_distance(const Formula& formula) {
  Variables variables{};
  const mu::Parser parser = make_parser(formula, variables);
  return parser.GetUsedVar().contains("d");
}

class ExpressionProbe final : public FieldProbe {
 public:
  ExpressionProbe(const std::vector<Formula>& formulas, const PartDistance* distance) : distance_(distance) {
    if (distance != nullptr) row_.emplace(*distance, DistanceLimits{kInfinite, kDistanceTolerance});
    parsers_.reserve(formulas.size());
    for (const Formula& formula : formulas) parsers_.push_back(make_parser(formula, variables_));
  }

  double sample(const Vec3& point, std::span<double> fractions) override {
    const Variables values{point.x(), point.y(), point.z(), std::hypot(point.x(), point.y()), distance_at(point)};
    double rest = 1.0;
    for (std::size_t i = 0; i < parsers_.size(); ++i) {
      variables_ = values;
      fractions[i] = evaluate(parsers_[i]);
      rest -= fractions[i];
    }
    if (parsers_.size() < fractions.size()) fractions.back() = rest;
    return repair_fractions(fractions);
  }
  void start_points() override { is_row_ = false; }
  void start_row(const RowPiece& piece) override {
    piece_ = piece;
    is_row_ = true;
    if (row_) row_->build(piece);
  }

 private:
  [[nodiscard]] double distance_at(const Vec3& point) const {
    if (!row_) return 0.0;
    if (is_row_) return row_->at((point - piece_.origin).dot(piece_.along));
    const auto found = distance_->find(point, kInfinite);
    return found ? found->distance : kInfinite;
  }

  static double evaluate(const mu::Parser& parser) {
    try {
      return parser.Eval();
    } catch (const mu::Parser::exception_type&) {
      return std::nan("");  // counted as a fault of the field
    }
  }

  Variables variables_{};  ///< the parsers point to it
  std::vector<mu::Parser> parsers_;
  const PartDistance* distance_;
  std::optional<DistanceRow> row_;
  RowPiece piece_;
  bool is_row_ = false;
};

class ExpressionField final : public Field {
 public:
  ExpressionField(std::vector<Formula> formulas, double detail, std::shared_ptr<const PartDistance> distance)
      : formulas_(std::move(formulas)), detail_(detail), distance_(std::move(distance)) {}
  [[nodiscard]] std::unique_ptr<FieldProbe> probe() const override {
    return std::make_unique<ExpressionProbe>(formulas_, distance_.get());
  }
  [[nodiscard]] double detail() const override { return detail_; }

 private:
  std::vector<Formula> formulas_;
  double detail_;
  std::shared_ptr<const PartDistance> distance_;  ///< none if no formula uses d
};

class ExpressionSource final : public FieldSource {
 public:
  ExpressionSource(std::vector<Formula> formulas, double detail) : formulas_(std::move(formulas)), detail_(detail) {
    // All are read, so that every slip is found.
    for (const Formula& formula : formulas_) needs_distance_ = uses_distance(formula) || needs_distance_;
  }
  [[nodiscard]] std::shared_ptr<const Field> bind(const Scene& scene, SolidId solid) const override {
    std::shared_ptr<const PartDistance> distance;
    if (needs_distance_) {
      distance = std::make_shared<PartDistance>(scene, solid, std::nullopt, formulas_.front().where);
    }
    return std::make_shared<ExpressionField>(formulas_, detail_, std::move(distance));
  }
  [[nodiscard]] std::string element(const std::string& indent, const std::filesystem::path&) const override {
    std::string lines = indent + "<expression";
    if (detail_ > 0.0) lines += attribute_text("detail", format_double(detail_));
    lines += ">\n";
    for (const Formula& formula : formulas_) {
      lines += indent + "  <fraction>" + xml_escape(formula.text) + "</fraction>\n";
    }
    return lines + indent + "</expression>\n";
  }

 private:
  std::vector<Formula> formulas_;
  double detail_;
  bool needs_distance_ = false;
};

}  // namespace

std::shared_ptr<const FieldSource> make_expression_field(std::vector<Formula> formulas, std::size_t components,
                                                         double detail) {
  if (formulas.empty() || (formulas.size() != components && formulas.size() + 1 != components)) {
    throw InputError(std::to_string(formulas.size()) + " formulas for " + std::to_string(components) + " components",
                     formulas.empty() ? "" : formulas.front().where,
                     "give one for each component, or one less: the last component is what is left");
  }
  for (const Formula& formula : formulas) check_text(formula);
  return std::make_shared<ExpressionSource>(std::move(formulas), detail);
}

}  // namespace lamella
