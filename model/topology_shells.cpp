#include "model/topology_detail.h"

namespace lamella::topology {

void orient_shells(Scene& scene, SolidId solid, FaultLog& log) {
  (void)scene;
  (void)solid;
  (void)log;
}

}  // namespace lamella::topology
