#include "bench/exact_sample.h"

#include <algorithm>
#include <map>
#include <random>

#include "bench/child.h"

namespace lamella::bench {
namespace {

constexpr int kLayers = 48;
constexpr int kRowsPerLayer = 64;
constexpr int kRowsAtOnce = 4;  ///< of a layer, before the next one's turn

std::vector<std::int32_t> random_numbers(std::int32_t count, int size, std::mt19937& random) {
  std::uniform_int_distribution<std::int32_t> number(0, count - 1);
  std::vector<std::int32_t> numbers(static_cast<std::size_t>(size));
  for (std::int32_t& value : numbers) value = number(random);
  return numbers;
}

/// Casts one batch with `peer` and adds its rows to `rows`, also those that meet nothing.
void add_rows(Peer& peer, const Batch& batch, std::map<std::pair<std::int32_t, std::int32_t>, ExactRow>& rows) {
  for (const std::int32_t row : batch.rows) rows[{batch.first_layer, row}] = {batch.first_layer, row, {}};
  peer.cast(batch);
  peer.visit([&](std::size_t, std::int32_t layer, std::int32_t row, std::span<const double> x) {
    std::vector<double>& all = rows[{layer, row}].x;
    all.insert(all.end(), x.begin(), x.end());
  });
}

}  // namespace

std::vector<ExactRow> sample_rows(const ExactModel& model, const Lattice& lattice, double seconds, std::uint32_t seed) {
  std::mt19937 random(seed);
  const std::vector<std::int32_t> layers = random_numbers(lattice.layers, kLayers, random);
  const std::unique_ptr<Peer> peer = make_reference_peer(model, lattice);
  peer->prepare();
  std::map<std::pair<std::int32_t, std::int32_t>, ExactRow> rows;
  const double start = cpu_seconds();
  for (int done = 0; done < kRowsPerLayer; done += kRowsAtOnce) {
    for (const std::int32_t layer : layers) {
      if (cpu_seconds() - start > seconds) break;
      Batch batch{layer, layer + 1, random_numbers(lattice.rows, kRowsAtOnce, random)};
      std::sort(batch.rows.begin(), batch.rows.end());
      batch.rows.erase(std::unique(batch.rows.begin(), batch.rows.end()), batch.rows.end());
      add_rows(*peer, batch, rows);
    }
  }
  std::vector<ExactRow> sample;
  for (auto& [key, row] : rows) {
    std::sort(row.x.begin(), row.x.end());
    sample.push_back(std::move(row));
  }
  return sample;
}

std::string to_bytes(const std::vector<ExactRow>& rows) {
  nlohmann::json json = nlohmann::json::array();
  for (const ExactRow& row : rows) json.push_back({row.layer, row.row, row.x});
  const std::vector<std::uint8_t> bytes = nlohmann::json::to_cbor(json);
  return {bytes.begin(), bytes.end()};
}

std::vector<ExactRow> rows_from_bytes(const std::string& bytes) {
  std::vector<ExactRow> rows;
  for (const nlohmann::json& row : nlohmann::json::from_cbor(bytes)) {
    rows.push_back({row[0].get<std::int32_t>(), row[1].get<std::int32_t>(), row[2].get<std::vector<double>>()});
  }
  return rows;
}

}  // namespace lamella::bench
