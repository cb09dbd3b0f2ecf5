#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lamella {

/// Fractions by position: straight between stops, constant before the first and behind the last.
class Stops {
 public:
  explicit Stops(std::size_t components) : components_(components) {}

  /// Appends a stop. Two stops may share a position: the fractions jump there. Throws InputError that names `where` for
  /// positions that descend or aren't finite, for a wrong number of fractions, one below 0, or a sum that isn't 1
  /// within kFractionSlack; within it they are scaled.
  void add(double position, std::span<const double> fractions, const std::string& where);

  /// Appends the lines of a text file: a position and a fraction a component, with commas, semicolons or blanks
  /// between; empty lines and those that begin with # are left out, as is a first line of words. Throws InputError
  /// with file and line.
  void read_csv(const std::filesystem::path& file);

  void sample(double position, std::span<double> fractions) const;

  /// The <stop>s of materials.xml, a line each behind `indent`.
  [[nodiscard]] std::string elements(const std::string& indent) const;

  [[nodiscard]] std::size_t components() const { return components_; }
  [[nodiscard]] bool empty() const { return positions_.empty(); }
  [[nodiscard]] double last() const { return positions_.back(); }
  /// The largest change of a fraction by mm; infinite where fractions jump.
  [[nodiscard]] double steepest() const;
  /// The smallest distance between stops, 0 without two positions.
  [[nodiscard]] double detail() const;

 private:
  std::size_t components_;
  std::vector<double> positions_;  ///< mm, ascending
  std::vector<double> fractions_;  ///< stop by stop
};

}  // namespace lamella
