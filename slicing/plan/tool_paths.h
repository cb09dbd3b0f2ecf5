#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "slicing/plan/order_tools.h"

namespace lamella {

/// The paths through one set of tools, from every first to every last. Places are ranks in the set, tools ascending.
class ToolPaths {
 public:
  /// `cost` must outlive it. Of more than `most_exact` tools that differ the paths aren't searched through.
  ToolPaths(std::uint32_t set, const std::vector<std::vector<ChangeCost>>& cost, int most_exact = kMaxExactTools);

  /// Steps that finding the paths took, a few nanoseconds each.
  [[nodiscard]] std::uint64_t work() const { return work_; }
  /// Whether every path is proved to be the best.
  [[nodiscard]] bool is_exact() const;
  [[nodiscard]] std::size_t size() const { return tools_.size(); }
  [[nodiscard]] std::uint8_t tool(std::size_t place) const { return tools_[place]; }
  /// Whether a path may lead from `first` to `last`: they differ, but for a set of one.
  [[nodiscard]] bool allows(std::size_t first, std::size_t last) const { return size() == 1 || first != last; }
  [[nodiscard]] const ChangeCost& cost(std::size_t first, std::size_t last) const { return at(first, last).cost; }
  [[nodiscard]] const ChangeCost& bound(std::size_t first, std::size_t last) const { return at(first, last).bound; }
  [[nodiscard]] const std::vector<std::uint8_t>& path(std::size_t first, std::size_t last) const {
    return at(first, last).tools;
  }

 private:
  struct Path {
    ChangeCost cost;
    ChangeCost bound;
    std::vector<std::uint8_t> tools;
  };
  [[nodiscard]] const Path& at(std::size_t first, std::size_t last) const { return paths_[first * size() + last]; }
  [[nodiscard]] Path& at(std::size_t first, std::size_t last) { return paths_[first * size() + last]; }

  [[nodiscard]] bool is_uniform() const;
  void fill_uniform();
  void fill_exact(std::size_t first);
  void fill_nearest(std::size_t first, std::size_t last);
  [[nodiscard]] ChangeCost between(std::size_t from, std::size_t to) const {
    return (*cost_)[tools_[from]][tools_[to]];
  }
  void add_up(Path& path) const;

  const std::vector<std::vector<ChangeCost>>* cost_;
  std::vector<std::uint8_t> tools_;
  std::vector<Path> paths_;
  std::uint64_t work_ = 0;
};

/// The paths of the sets that were asked for.
class PathCache {
 public:
  /// `cost` must outlive it.
  explicit PathCache(const std::vector<std::vector<ChangeCost>>& cost, int most_exact = kMaxExactTools)
      : cost_(cost), most_exact_(most_exact) {}

  [[nodiscard]] const std::vector<std::vector<ChangeCost>>& cost() const { return cost_; }
  [[nodiscard]] const ToolPaths& of(std::uint32_t set);
  /// Steps spent so far.
  [[nodiscard]] std::uint64_t work() const { return work_; }

 private:
  const std::vector<std::vector<ChangeCost>>& cost_;
  int most_exact_;
  std::map<std::uint32_t, ToolPaths> paths_;
  std::uint64_t work_ = 0;
};

/// Steps that ToolPaths of so many unlike tools takes, searched through.
[[nodiscard]] std::uint64_t path_search_work(std::size_t tools);

}  // namespace lamella
