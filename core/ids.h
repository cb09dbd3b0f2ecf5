#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace lamella {

/// A strong index: ids of different tags do not convert into each other or into integers.
/// A default-constructed id refers to nothing (`valid()` is false).
template <class Tag>
class Id {
 public:
  using value_type = std::uint32_t;

  constexpr Id() = default;
  constexpr explicit Id(std::size_t value) : value_(static_cast<value_type>(value)) {}

  [[nodiscard]] constexpr value_type value() const { return value_; }
  [[nodiscard]] constexpr bool valid() const { return value_ != kInvalid; }
  constexpr auto operator<=>(const Id&) const = default;

 private:
  static constexpr value_type kInvalid = std::numeric_limits<value_type>::max();
  value_type value_ = kInvalid;
};

using SolidId = Id<struct SolidTag>;
using ShellId = Id<struct ShellTag>;
using FaceId = Id<struct FaceTag>;
using LoopId = Id<struct LoopTag>;
using HalfEdgeId = Id<struct HalfEdgeTag>;
using EdgeId = Id<struct EdgeTag>;
using VertexId = Id<struct VertexTag>;
using MaterialId = Id<struct MaterialTag>;

/// A contiguous run of ids [first, first + count).
template <class IdT>
struct IdRange {
  IdT first{0};
  std::uint32_t count = 0;

  class Iterator {
   public:
    explicit constexpr Iterator(std::uint32_t value) : value_(value) {}
    constexpr IdT operator*() const { return IdT{value_}; }
    constexpr Iterator& operator++() {
      ++value_;
      return *this;
    }
    constexpr bool operator==(const Iterator&) const = default;

   private:
    std::uint32_t value_;
  };

  [[nodiscard]] constexpr Iterator begin() const { return Iterator{first.value()}; }
  [[nodiscard]] constexpr Iterator end() const { return Iterator{first.value() + count}; }
  [[nodiscard]] constexpr bool empty() const { return count == 0; }
};

/// A vector that only ids of one kind can index, so that a face array is never read with a vertex.
template <class IdT, class T>
class IdVector {
 public:
  IdVector() = default;
  explicit IdVector(std::size_t size, const T& value = T{}) : items_(size, value) {}

  /// Appends `item` and returns its id.
  IdT push_back(T item) {
    items_.push_back(std::move(item));
    return IdT{items_.size() - 1};
  }
  [[nodiscard]] T& operator[](IdT id) { return items_[id.value()]; }
  [[nodiscard]] const T& operator[](IdT id) const { return items_[id.value()]; }
  [[nodiscard]] std::size_t size() const { return items_.size(); }
  [[nodiscard]] bool empty() const { return items_.empty(); }
  [[nodiscard]] IdRange<IdT> ids() const { return {IdT{0}, static_cast<std::uint32_t>(items_.size())}; }
  void reserve(std::size_t size) { items_.reserve(size); }
  void resize(std::size_t size) { items_.resize(size); }
  auto begin() { return items_.begin(); }
  auto end() { return items_.end(); }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }

 private:
  std::vector<T> items_;
};

}  // namespace lamella

template <class Tag>
struct std::hash<lamella::Id<Tag>> {
  std::size_t operator()(const lamella::Id<Tag>& id) const noexcept { return id.value(); }
};
