#include "materials/stops.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "core/xml.h"
#include "materials/field.h"

namespace lamella {

namespace {

/// A table is a curve, not a voxel model.
constexpr std::size_t kMaxStops = 100'000;
constexpr std::size_t kMaxLine = 64 * 1024;
constexpr std::string_view kBetween = ",; \t\r";

/// The numbers of a line, or nothing where something else stands between them.
std::optional<std::vector<double>> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  for (;;) {
    line.remove_prefix(std::min(line.find_first_not_of(kBetween), line.size()));
    if (line.empty()) return numbers;
    if (line.front() == '+') line.remove_prefix(1);
    double number = 0.0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
    if (error != std::errc{}) return std::nullopt;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    if (!line.empty() && kBetween.find(line.front()) == std::string_view::npos) return std::nullopt;
    numbers.push_back(number);
  }
}

}  // namespace

void Stops::add(double position, std::span<const double> fractions, const std::string& where) {
  if (!std::isfinite(position)) throw InputError("a position that is no finite number", where);
  if (!positions_.empty() && position < positions_.back()) {
    throw InputError("position " + format_double(position) + " lies before the one above it", where,
                     "list the stops by ascending position");
  }
  if (positions_.size() >= kMaxStops) throw InputError("more than 100000 stops", where, "use fewer");
  if (fractions.size() != components_) {
    throw InputError(std::to_string(fractions.size()) + " fractions for " + std::to_string(components_) + " components",
                     where, "give one for each <component>, in their order");
  }
  std::vector<double> repaired(fractions.begin(), fractions.end());
  if (repair_fractions(repaired) > kFractionSlack) {
    throw InputError("fractions that aren't 0 or more with sum 1", where, "make them add up to 1");
  }
  positions_.push_back(position);
  fractions_.insert(fractions_.end(), repaired.begin(), repaired.end());
}

void Stops::read_csv(const std::filesystem::path& file) {
  std::error_code failure;
  std::ifstream stream(file, std::ios::binary);
  if (!std::filesystem::is_regular_file(file, failure) || !stream) {
    throw InputError("can't read the table", file.string(), "its path is relative to the materials file");
  }
  std::string line(kMaxLine, '\0');
  bool is_first = true;
  for (std::size_t number = 1; stream.getline(line.data(), static_cast<std::streamsize>(line.size())); ++number) {
    const std::string_view text(line.data());
    const std::string where = file.string() + ":" + std::to_string(number);
    if (text.find_first_not_of(kBetween) == std::string_view::npos || text.front() == '#') continue;
    const auto numbers = numbers_of(text);
    const bool is_heading = is_first && !numbers;
    is_first = false;
    if (is_heading) continue;
    if (!numbers || numbers->empty()) throw InputError("no line of numbers", where, "write: position, fraction, ...");
    add(numbers->front(), std::span(*numbers).subspan(1), where);
  }
  if (!stream.eof()) throw InputError("a line of more than 64 KiB", file.string(), "is this a table of numbers?");
  if (empty()) throw InputError("a table without a line", file.string(), "write: position, fraction, ...");
}

void Stops::sample(double position, std::span<double> fractions) const {
  const auto above = std::upper_bound(positions_.begin(), positions_.end(), position);
  const auto row = [&](std::size_t i) { return std::span(fractions_).subspan(i * components_, components_); };
  if (above == positions_.begin() || above == positions_.end()) {
    const auto end = row(above == positions_.begin() ? 0 : positions_.size() - 1);
    std::copy(end.begin(), end.end(), fractions.begin());
    return;
  }
  const auto i = static_cast<std::size_t>(above - positions_.begin());
  const double part = (position - positions_[i - 1]) / (positions_[i] - positions_[i - 1]);
  const auto before = row(i - 1);
  const auto behind = row(i);
  for (std::size_t c = 0; c < components_; ++c) fractions[c] = (1.0 - part) * before[c] + part * behind[c];
}

std::string Stops::elements(const std::string& indent) const {
  std::string lines;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    std::string fractions;
    for (std::size_t c = 0; c < components_; ++c) {
      if (c > 0) fractions += ' ';
      fractions += format_double(fractions_[i * components_ + c]);
    }
    lines += indent + "<stop" + attribute_text("at", format_double(positions_[i])) +
             attribute_text("fractions", fractions) + "/>\n";
  }
  return lines;
}

double Stops::steepest() const {
  double most = 0.0;
  for (std::size_t i = components_; i < fractions_.size(); ++i) {
    const std::size_t stop = i / components_;
    const double rise = std::abs(fractions_[i] - fractions_[i - components_]);
    if (rise > 0.0) most = std::max(most, rise / (positions_[stop] - positions_[stop - 1]));
  }
  return most;
}

double Stops::detail() const {
  double least = 0.0;
  for (std::size_t i = 1; i < positions_.size(); ++i) {
    const double gap = positions_[i] - positions_[i - 1];
    if (gap > 0.0 && (least == 0.0 || gap < least)) least = gap;
  }
  return least;
}

}  // namespace lamella
