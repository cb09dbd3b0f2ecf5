#include "slicing/span/row_cast.h"

#include "slicing/span/arc_balance.h"

namespace lamella::span {

void RowCast::cast(const Section& section, const RowLattice& lattice, std::size_t number, LayerSpans& out) {
  columns_.find(*scene_, section, lattice);
  count_hits(section, lattice, out);
  sweep_.sweep(columns_, out.lattices[number], out);
}

/// All hits of an arc are uncertain that could not be traced or that is on the wrong side at its nodes, else those rows
/// that don't meet it.
void RowCast::count_hits(const Section& section, const RowLattice& lattice, LayerSpans& out) const {
  bool is_balanced = true;
  const Column* last = nullptr;
  for (const Column& column : columns_.columns()) {
    out.cast.hits += column.rows();
    const SectionArc& arc = section.arcs[column.arc()];
    if (last == nullptr || last->arc() != column.arc()) {
      is_balanced = keeps_balance(arc, section, lattice, order_tolerance(scene_->solids[column.solid]));
    }
    last = &column;
    const bool is_doubtful = arc.doubtful || !is_balanced;
    const std::size_t doubts = is_doubtful ? column.rows() : column.failed;
    if (doubts == 0) continue;
    const Check check = arc.doubtful ? Check::arcs : (is_doubtful ? Check::balance : Check::depth);
    out.cast.uncertain_hits += doubts;
    note_failed(out.failed, {check, column.solid, column.face, doubts});
  }
}

}  // namespace lamella::span
