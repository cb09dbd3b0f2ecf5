// Sorting networks over rows: each lane of a vector is a row, each vector a slot.

#include <array>
#include <experimental/simd>
#include <limits>
#include <utility>

#include "bench/row_buckets.h"

namespace lamella::bench {
namespace {

namespace stdx = std::experimental;
using Lanes = stdx::fixed_size_simd<float, kRowBlock>;
using Counts = stdx::fixed_size_simd<std::int32_t, kRowBlock>;

struct Comparator {
  std::int32_t low;
  std::int32_t high;
};

/// Batcher's odd-even merge sort (Knuth, The Art of Computer Programming 3, 5.2.2, algorithm M) for 2^k items.
template <class Visit>
constexpr void visit_network(std::int32_t size, Visit visit) {
  for (std::int32_t p = 1; p < size; p *= 2) {
    for (std::int32_t k = p; k >= 1; k /= 2) {
      for (std::int32_t j = k % p; j + k < size; j += 2 * k) {
        for (std::int32_t i = 0; i < k && i + j + k < size; ++i) {
          if ((i + j) / (2 * p) == (i + j + k) / (2 * p)) visit(Comparator{i + j, i + j + k});
        }
      }
    }
  }
}

constexpr std::size_t network_length(std::int32_t size) {
  std::size_t length = 0;
  visit_network(size, [&length](Comparator) { ++length; });
  return length;
}

template <std::int32_t Size>
constexpr auto make_network() {
  std::array<Comparator, network_length(Size)> network{};
  std::size_t next = 0;
  visit_network(Size, [&](Comparator comparator) { network[next++] = comparator; });
  return network;
}

void exchange(Lanes& low, Lanes& high) {
  const Lanes smaller = stdx::min(low, high);
  high = stdx::max(low, high);
  low = smaller;
}

/// Rows without a crossing in a slot get infinity there, which sorts behind all others.
Lanes load_slot(const float* slots, std::int32_t slot, const Counts& counts) {
  Lanes lanes(slots, stdx::element_aligned);
  const stdx::fixed_size_simd<float, kRowBlock> filled = stdx::static_simd_cast<float>(counts);
  stdx::where(filled <= static_cast<float>(slot), lanes) = std::numeric_limits<float>::infinity();
  return lanes;
}

template <std::int32_t Size>
void sort_block(float* slots, std::int32_t stride, const Counts& counts, std::int32_t most) {
  static constexpr auto kNetwork = make_network<Size>();
  std::array<Lanes, Size> lanes;
  for (std::int32_t s = 0; s < Size; ++s) {
    lanes[s] = s < most ? load_slot(slots + s * stride, s, counts) : Lanes(std::numeric_limits<float>::infinity());
  }
  [&]<std::size_t... I>(std::index_sequence<I...>) { (exchange(lanes[kNetwork[I].low], lanes[kNetwork[I].high]), ...); }
  (std::make_index_sequence<kNetwork.size()>{});
  for (std::int32_t s = 0; s < most; ++s) lanes[s].copy_to(slots + s * stride, stdx::element_aligned);
}

/// Any number of slots, by insertion row by row.
void sort_long_block(float* slots, std::int32_t stride, const std::int32_t* counts) {
  for (std::int32_t i = 0; i < kRowBlock; ++i) {
    for (std::int32_t s = 1; s < counts[i]; ++s) {
      const float value = slots[s * stride + i];
      std::int32_t to = s;
      for (; to > 0 && slots[(to - 1) * stride + i] > value; --to) {
        slots[to * stride + i] = slots[(to - 1) * stride + i];
      }
      slots[to * stride + i] = value;
    }
  }
}

}  // namespace

void sort_slots(float* slots, const std::int32_t* counts, std::int32_t stride, std::int32_t rows) {
  for (std::int32_t i = 0; i < rows; i += kRowBlock) {
    const Counts block(counts + i, stdx::element_aligned);
    const std::int32_t most = stdx::hmax(block);
    if (most < 2) continue;
    if (most == 2) {
      sort_block<2>(slots + i, stride, block, most);
    } else if (most <= 4) {
      sort_block<4>(slots + i, stride, block, most);
    } else if (most <= 8) {
      sort_block<8>(slots + i, stride, block, most);
    } else if (most <= 16) {
      sort_block<16>(slots + i, stride, block, most);
    } else if (most <= 32) {
      sort_block<32>(slots + i, stride, block, most);
    } else {
      sort_long_block(slots + i, stride, counts + i);
    }
  }
}

}  // namespace lamella::bench
