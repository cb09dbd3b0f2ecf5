#include "bench/measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "bench/child.h"

namespace lamella::bench {
namespace {

constexpr int kRowsPerBatch = 32;  ///< random rows of one layer that a slow peer gets at once
constexpr std::size_t kExamples = 5;
constexpr int kBatches = 100'000;  ///< more than any slow peer gets through

std::vector<Batch> all_slabs(const Lattice& lattice, std::int32_t layers) {
  std::vector<Batch> slabs;
  for (std::int32_t k = 0; k < lattice.layers; k += layers)
    slabs.push_back({k, std::min(k + layers, lattice.layers), {}});
  return slabs;
}

Batch random_rows(const Lattice& lattice, std::mt19937& random) {
  std::uniform_int_distribution<std::int32_t> layer(0, lattice.layers - 1);
  std::uniform_int_distribution<std::int32_t> row(0, lattice.rows - 1);
  Batch batch;
  batch.first_layer = layer(random);
  batch.last_layer = batch.first_layer + 1;
  for (int i = 0; i < kRowsPerBatch; ++i) batch.rows.push_back(row(random));
  std::sort(batch.rows.begin(), batch.rows.end());
  batch.rows.erase(std::unique(batch.rows.begin(), batch.rows.end()), batch.rows.end());
  return batch;
}

/// Differences from the exact crossings, over rows where both have as many.
class Errors {
 public:
  void add(const ExactRow& exact, const std::vector<double>& found) {
    ++rows_;
    if (exact.x.size() != found.size()) {
      ++mismatches_;
      if (examples_.size() < kExamples) {
        examples_.push_back({{"layer", exact.layer}, {"row", exact.row}, {"exact", exact.x}, {"found", found}});
      }
      return;
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double error = std::abs(found[i] - exact.x[i]);
      sum_ += error;
      largest_ = std::max(largest_, error);
    }
    hits_ += found.size();
  }

  [[nodiscard]] nlohmann::json json() const {
    return {{"rows", rows_},   {"count_mismatches", mismatches_},
            {"hits", hits_},   {"mean", hits_ > 0 ? sum_ / static_cast<double>(hits_) : 0.0},
            {"max", largest_}, {"examples", examples_}};
  }

 private:
  std::uint64_t rows_ = 0;
  std::uint64_t mismatches_ = 0;
  std::uint64_t hits_ = 0;
  double sum_ = 0.0;
  double largest_ = 0.0;
  nlohmann::json examples_ = nlohmann::json::array();  ///< rows with another number of crossings, to look into
};

}  // namespace

Measurement::Measurement(const PeerEntry& entry, const Lattice& lattice, const std::vector<ExactRow>& exact,
                         const MeasureOptions& options)
    : entry_(entry), lattice_(lattice), exact_(exact), options_(options) {
  forget_peak();
  base_mebibytes_ = peak_mebibytes();
}

void Measurement::prepare_peer() {
  peer_.reset();
  peer_ = entry_.make();
  const double start = cpu_seconds();
  peer_->prepare();
  prepare_seconds_.push_back(cpu_seconds() - start);
}

nlohmann::json Measurement::prepare() {
  prepare_peer();
  while (prepare_seconds_.size() < 3 && prepare_seconds_.front() < options_.least_seconds) prepare_peer();
  std::sort(prepare_seconds_.begin(), prepare_seconds_.end());
  if (peer_->casts_single_rows()) {
    plan_rows();
  } else {
    plan_slabs();
  }
  return {{"prepare_s", prepare_seconds_[prepare_seconds_.size() / 2]}, {"share", share_}, {"passes", passes_}};
}

/// All slabs if they take the time allowed, else every n-th. This pass also warms the peer up.
void Measurement::plan_slabs() {
  const std::vector<Batch> slabs = all_slabs(lattice_, peer_->slab_layers());
  std::size_t done = 0;
  const double start = cpu_seconds();
  while (done < slabs.size() && cpu_seconds() - start < options_.most_seconds) peer_->cast(slabs[done++]);
  const double seconds = cpu_seconds() - start;
  const std::size_t step = (slabs.size() + done - 1) / done;
  for (std::size_t i = step / 2; i < slabs.size(); i += step) batches_.push_back(slabs[i]);
  share_ = static_cast<double>(batches_.size()) / static_cast<double>(slabs.size());
  passes_ = step > 1 ? 1 : static_cast<std::int64_t>(std::ceil(options_.least_seconds / std::max(1e-6, seconds)));
}

/// As many random rows as take the least time allowed.
void Measurement::plan_rows() {
  std::mt19937 random(options_.seed);
  const double start = cpu_seconds();
  double rows = 0.0;
  while (static_cast<int>(batches_.size()) < kBatches && cpu_seconds() - start < options_.least_seconds) {
    batches_.push_back(random_rows(lattice_, random));
    rows += static_cast<double>(batches_.back().rows.size());
    peer_->cast(batches_.back());
  }
  share_ = rows / (static_cast<double>(lattice_.rows) * lattice_.layers);
}

double Measurement::run() {
  const double start = cpu_seconds();
  for (std::int64_t pass = 0; pass < passes_; ++pass) {
    for (const Batch& batch : batches_) peer_->cast(batch);
  }
  return (cpu_seconds() - start) / static_cast<double>(passes_);
}

nlohmann::json Measurement::check() {
  nlohmann::json result;
  result["peak_mib"] = peak_mebibytes() - base_mebibytes_;
  std::uint64_t hits = 0;
  std::uint64_t rows = 0;
  std::uint64_t odd = 0;
  CastCounters counters;
  for (const Batch& batch : batches_) {
    peer_->cast(batch);
    peer_->visit([&](std::size_t, std::int32_t, std::int32_t, std::span<const double> x) {
      hits += x.size();
      odd += x.size() % 2;
      ++rows;
    });
    counters += peer_->counters();
  }
  result["hits"] = hits;
  result["solid_rows"] = rows;
  result["odd_rows"] = odd + counters.unclosed_rays;
  result["repaired_rows"] = counters.repaired_rays;
  result["uncertain_hits"] = counters.uncertain_hits;
  result["error"] = compare();
  return result;
}

nlohmann::json Measurement::compare() {
  std::map<std::int32_t, std::map<std::int32_t, std::vector<double>>> found;
  std::map<std::int32_t, Batch> batches;
  for (const ExactRow& exact : exact_) {
    found[exact.layer][exact.row];
    const std::int32_t size = peer_->casts_single_rows() ? 1 : peer_->slab_layers();
    const std::int32_t first = exact.layer / size * size;
    Batch& batch = batches[first];
    batch.first_layer = first;
    batch.last_layer = std::min(first + size, lattice_.layers);
    batch.rows.push_back(exact.row);
  }
  for (const auto& [layer, batch] : batches) {
    peer_->cast(batch);
    peer_->visit([&](std::size_t, std::int32_t at, std::int32_t row, std::span<const double> x) {
      const auto rows = found.find(at);
      if (rows == found.end()) return;
      const auto wanted = rows->second.find(row);
      if (wanted != rows->second.end()) wanted->second.insert(wanted->second.end(), x.begin(), x.end());
    });
  }
  Errors errors;
  for (const ExactRow& exact : exact_) {
    std::vector<double>& x = found[exact.layer][exact.row];
    std::sort(x.begin(), x.end());
    errors.add(exact, x);
  }
  return errors.json();
}

}  // namespace lamella::bench
