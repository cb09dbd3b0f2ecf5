#include <cstdio>

#include "core/xml.h"
#include "slicing/plan/build_plan.h"

namespace lamella {

namespace {

std::string show(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// One number of every step of a material, looked through layer by layer.
struct Feature {
  double sum = 0.0;
  double worst = 0.0;
  std::uint32_t worst_layer = 0;
  std::uint32_t first_layer = 0;
  std::uint32_t layers = 0;

  void add(double value, std::uint32_t layer) {
    if (!(value > 0.0)) return;
    if (layers++ == 0) first_layer = layer;
    if (value > worst) {
      worst = value;
      worst_layer = layer;
    }
    sum += value;
  }
};

class MisfitFinder {
 public:
  MisfitFinder(const BuildPlan& plan, const BuildInfo& info, const Machine& machine)
      : plan_(plan), info_(info), machine_(machine) {}

  [[nodiscard]] std::vector<PlanFinding> run() {
    find_volume();
    find_pitch();
    for (std::size_t m = 0; m < plan_.materials.size(); ++m) find_features(m);
    find_unpriced();
    return std::move(findings_);
  }

 private:
  void add(Severity severity, std::optional<std::uint32_t> layer, const std::string& material, std::string what,
           std::string hint) {
    findings_.push_back({severity, layer, material, std::move(what), std::move(hint)});
  }

  void find_volume() {
    if (plan_.fits) return;
    const auto triple = [](const Vec3& v) { return show(v.x()) + " x " + show(v.y()) + " x " + show(v.z()); };
    add(Severity::error, std::nullopt, "",
        "the part needs " + triple(plan_.size) + " mm, the machine has " + triple(machine_.volume) + " mm",
        "turn the part or choose a larger machine");
  }

  void find_pitch() {
    const Vec3& pitch = info_.plan.grid.pitch;
    for (int axis = 0; axis < 2; ++axis) {
      if (pitch[axis] <= machine_.pitch[axis] * (1.0 + 1e-6)) continue;
      const char* name = axis == 0 ? "x" : "y";
      add(Severity::warning, std::nullopt, "",
          std::string("the build's pitch along ") + name + " is " + show(pitch[axis]) +
              " mm, coarser than the machine's " + show(machine_.pitch[axis]) + " mm",
          "slice again with --machine");
    }
  }

  void find_features(std::size_t m) {
    const std::string& name = plan_.materials[m].name;
    Feature specks;
    Feature unsupported;
    Feature thin;
    double area = 0.0;
    double shortest = 0.0;
    std::uint32_t shortest_layer = 0;
    for (const PlanLayer& layer : plan_.layers) {
      for (const PlanStep& step : layer.steps) {
        if (step.material.value() != m) continue;
        const MaterialStatistics& s = step.statistics;
        specks.add(s.specks, layer.index);
        unsupported.add(s.unsupported, layer.index);
        thin.add(s.thin, layer.index);
        area += s.area;
        if (s.shortest > 0.0 && (shortest == 0.0 || s.shortest < shortest)) {
          shortest = s.shortest;
          shortest_layer = layer.index;
        }
      }
    }
    if (area <= 0.0) return;
    if (shortest < machine_.width) report_shortest(name, shortest, shortest_layer);
    report_thin(name, thin, area);
    report_specks(name, specks);
    report_unsupported(name, unsupported);
  }

  void report_shortest(const std::string& name, double shortest, std::uint32_t layer) {
    const bool is_lost = shortest < machine_.pitch.x();
    add(Severity::note, layer, name,
        "the shortest run is " + show(shortest) + " mm, less than " +
            (is_lost ? "the pitch of " + show(machine_.pitch.x()) : "the width of " + show(machine_.width)) + " mm",
        "the ends of curved faces do that; thin walls show as a share of the area");
  }

  void report_thin(const std::string& name, const Feature& thin, double area) {
    constexpr double kNotable = 0.01;  // of the area: what ends of curved faces alone don't reach
    if (thin.sum < kNotable * area) return;
    add(Severity::warning, thin.worst_layer, name,
        show(100.0 * thin.sum / area) + " % of the area is in runs shorter than the width of " + show(machine_.width) +
            " mm, most of it on this layer",
        "walls along the rows are too thin for the machine");
  }

  void report_specks(const std::string& name, const Feature& specks) {
    if (specks.layers == 0) return;
    add(Severity::warning, specks.worst_layer, name,
        show(specks.sum) + " islands on " + std::to_string(specks.layers) + " layers are narrower than the width of " +
            show(machine_.width) + " mm, most on this layer",
        "they may come out thicker or be lost");
  }

  void report_unsupported(const std::string& name, const Feature& unsupported) {
    if (unsupported.layers == 0) return;
    std::string hint = "turn the part, or build support below";
    if (machine_.support) hint = "the machine builds support of " + machine_.support->material + " below";
    const bool is_carried = machine_.support && machine_.support->fill == SupportFill::box;
    add(is_carried ? Severity::note : Severity::warning, unsupported.worst_layer, name,
        show(unsupported.sum) + " mm^2 on " + std::to_string(unsupported.layers) +
            " layers lie over nothing, from layer " + std::to_string(unsupported.first_layer) + " on, " +
            show(unsupported.worst) + " mm^2 of it on this layer",
        hint);
  }

  void find_unpriced() {
    for (const PlanMaterial& material : plan_.materials) {
      if (material.tools.empty()) continue;
      if (!material.mass) {
        add(Severity::note, std::nullopt, material.name, "the density is unknown, and with it the mass",
            "give it in materials.xml");
      }
      if (!material.cost) {
        add(Severity::note, std::nullopt, material.name, "the material has no price and isn't in the cost",
            "give a price in machine.xml, and a density if it is per kg");
      }
    }
  }

  const BuildPlan& plan_;
  const BuildInfo& info_;
  const Machine& machine_;
  std::vector<PlanFinding> findings_;
};

}  // namespace

std::vector<PlanFinding> find_misfits(const BuildPlan& plan, const BuildInfo& info, const Machine& machine) {
  return MisfitFinder(plan, info, machine).run();
}

}  // namespace lamella
