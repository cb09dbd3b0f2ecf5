#include "slicing/plan/tool_paths.h"

#include <algorithm>
#include <limits>

namespace lamella {

namespace {

constexpr ChangeCost kImpossible{std::numeric_limits<std::int64_t>::max() / 4, 0, 0};

}  // namespace

ToolPaths::ToolPaths(std::uint32_t set, const std::vector<std::vector<ChangeCost>>& cost, int most_exact)
    : cost_(&cost) {
  for (std::uint8_t tool = 0; tool < 32; ++tool) {
    if ((set >> tool & 1U) != 0) tools_.push_back(tool);
  }
  paths_.resize(size() * size());
  if (is_uniform()) {
    fill_uniform();
    return;
  }
  for (std::size_t first = 0; first < size(); ++first) {
    if (size() <= static_cast<std::size_t>(most_exact)) {
      fill_exact(first);
      continue;
    }
    for (std::size_t last = 0; last < size(); ++last) {
      if (allows(first, last)) fill_nearest(first, last);
    }
  }
}

bool ToolPaths::is_exact() const {
  return std::all_of(paths_.begin(), paths_.end(), [](const Path& path) { return path.cost == path.bound; });
}

bool ToolPaths::is_uniform() const {
  for (std::size_t a = 0; a < size(); ++a) {
    for (std::size_t b = 0; b < size(); ++b) {
      if (a != b && between(a, b) != between(0, 1)) return false;
    }
  }
  return true;
}

void ToolPaths::add_up(Path& path) const {
  path.cost = {};
  for (std::size_t i = 1; i < path.tools.size(); ++i) {
    path.cost = path.cost + (*cost_)[path.tools[i - 1]][path.tools[i]];
  }
}

/// Every order costs the same: the lowest first.
void ToolPaths::fill_uniform() {
  for (std::size_t first = 0; first < size(); ++first) {
    for (std::size_t last = 0; last < size(); ++last) {
      if (!allows(first, last)) continue;
      Path& path = at(first, last);
      path.tools.push_back(tools_[first]);
      for (std::size_t place = 0; place < size(); ++place) {
        if (place != first && place != last) path.tools.push_back(tools_[place]);
      }
      if (last != first) path.tools.push_back(tools_[last]);
      add_up(path);
      path.bound = path.cost;
      work_ += size();
    }
  }
}

/// best[set][last]: the least cost from `first` through all of the set to `last`.
void ToolPaths::fill_exact(std::size_t first) {
  const std::size_t n = size();
  const std::size_t sets = std::size_t{1} << n;
  std::vector<ChangeCost> best(sets * n, kImpossible);
  std::vector<std::uint8_t> before(sets * n);
  best[(std::size_t{1} << first) * n + first] = {};
  work_ += path_search_work(n) / n;
  for (std::size_t set = 1; set < sets; ++set) {
    for (std::size_t last = 0; last < n; ++last) {
      const ChangeCost reached = best[set * n + last];
      if (reached == kImpossible) continue;
      for (std::size_t next = 0; next < n; ++next) {
        if ((set >> next & 1U) != 0) continue;
        const std::size_t there = (set | std::size_t{1} << next) * n + next;
        const ChangeCost cost = reached + between(last, next);
        if (cost < best[there]) {
          best[there] = cost;
          before[there] = static_cast<std::uint8_t>(last);
        }
      }
    }
  }
  for (std::size_t last = 0; last < n; ++last) {
    if (!allows(first, last)) continue;
    Path& path = at(first, last);
    path.cost = path.bound = best[(sets - 1) * n + last];
    std::size_t set = sets - 1;
    for (std::size_t place = last;;) {
      path.tools.push_back(tools_[place]);
      if (place == first) break;
      const std::size_t previous = before[set * n + place];
      set ^= std::size_t{1} << place;
      place = previous;
    }
    std::reverse(path.tools.begin(), path.tools.end());
  }
}

void ToolPaths::fill_nearest(std::size_t first, std::size_t last) {
  Path& path = at(first, last);
  std::vector<bool> done(size());
  done[first] = done[last] = true;
  path.tools.push_back(tools_[first]);
  for (std::size_t place = first; path.tools.size() + 1 < size();) {
    std::size_t nearest = size();
    for (std::size_t next = 0; next < size(); ++next) {
      if (!done[next] && (nearest == size() || between(place, next) < between(place, nearest))) nearest = next;
    }
    done[nearest] = true;
    path.tools.push_back(tools_[nearest]);
    place = nearest;
  }
  path.tools.push_back(tools_[last]);
  add_up(path);
  work_ += 2 * size() * size();
  for (std::size_t to = 0; to < size(); ++to) {
    if (to == first) continue;
    ChangeCost least = kImpossible;
    for (std::size_t from = 0; from < size(); ++from) {
      if (from != to && from != last) least = std::min(least, between(from, to));
    }
    path.bound = path.bound + least;
  }
}

const ToolPaths& PathCache::of(std::uint32_t set) {
  const auto found = paths_.find(set);
  if (found != paths_.end()) return found->second;
  const ToolPaths& made = paths_.try_emplace(set, set, cost_, most_exact_).first->second;
  work_ += made.work();
  return made;
}

std::uint64_t path_search_work(std::size_t tools) { return (std::uint64_t{1} << tools) * tools * tools * tools / 2; }

}  // namespace lamella
