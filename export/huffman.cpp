#include "export/huffman.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace lamella {

namespace {

constexpr int kMostBits = 15;

/// Depths of the leaves of Huffman's tree over ascending weights, at least two of them. Inner nodes arise in ascending
/// order too, so that the two lightest nodes are always at the heads of two queues (van Leeuwen, 1976).
std::vector<int> leaf_depths(const std::vector<std::uint64_t>& weights) {
  const std::size_t leaves = weights.size();
  std::vector<std::uint64_t> weight = weights;
  std::vector<std::size_t> parent(2 * leaves - 1);
  std::size_t leaf = 0;
  std::size_t inner = leaves;
  const auto take_lightest = [&] {
    const bool takes_leaf = leaf < leaves && (inner >= weight.size() || weight[leaf] <= weight[inner]);
    const std::size_t node = takes_leaf ? leaf++ : inner++;
    parent[node] = weight.size();
    return weight[node];
  };
  while (weight.size() < 2 * leaves - 1) {
    const std::uint64_t first = take_lightest();
    const std::uint64_t second = take_lightest();
    weight.push_back(first + second);
  }
  std::vector<int> depth(2 * leaves - 1);
  for (std::size_t node = 2 * leaves - 2; node-- > 0;) depth[node] = depth[parent[node]] + 1;
  depth.resize(leaves);
  return depth;
}

std::vector<std::uint8_t> limited_lengths(std::span<const std::uint32_t> counts, int limit) {
  std::vector<std::uint8_t> lengths(counts.size());
  std::vector<std::size_t> symbols;
  for (std::size_t s = 0; s < counts.size(); ++s) {
    if (counts[s] > 0) symbols.push_back(s);
  }
  if (symbols.size() == 1) lengths[symbols[0]] = 1;
  if (symbols.size() < 2) return lengths;
  std::stable_sort(symbols.begin(), symbols.end(), [&](auto a, auto b) { return counts[a] < counts[b]; });
  std::vector<std::uint64_t> weights;
  for (const std::size_t s : symbols) weights.push_back(counts[s]);
  std::vector<int> depth = leaf_depths(weights);
  // Halving the weights evens them out and in the end makes them equal, which gives the shortest longest code.
  while (*std::max_element(depth.begin(), depth.end()) > limit) {
    for (std::uint64_t& weight : weights) weight = (weight + 1) / 2;
    depth = leaf_depths(weights);
  }
  for (std::size_t n = 0; n < symbols.size(); ++n) lengths[symbols[n]] = static_cast<std::uint8_t>(depth[n]);
  return lengths;
}

std::vector<std::uint16_t> canonical_codes(std::span<const std::uint8_t> lengths) {
  std::array<unsigned, kMostBits + 2> next{};
  for (const std::uint8_t length : lengths) next[length + 1U] += length > 0 ? 1 : 0;
  for (std::size_t length = 1; length < next.size(); ++length) next[length] = (next[length] + next[length - 1]) << 1;
  std::vector<std::uint16_t> codes(lengths.size());
  for (std::size_t s = 0; s < lengths.size(); ++s) {
    if (lengths[s] == 0) continue;
    const unsigned code = next[lengths[s]]++;
    unsigned reversed = 0;
    for (int bit = 0; bit < lengths[s]; ++bit) reversed |= (code >> bit & 1U) << (lengths[s] - 1 - bit);
    codes[s] = static_cast<std::uint16_t>(reversed);
  }
  return codes;
}

}  // namespace

HuffmanCode::HuffmanCode(std::span<const std::uint32_t> counts, int limit)
    : lengths(limited_lengths(counts, limit)), codes(canonical_codes(lengths)) {}

}  // namespace lamella
