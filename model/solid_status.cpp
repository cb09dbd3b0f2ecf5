#include "model/solid_status.h"

namespace lamella {

std::string status_word(const SolidInfo& solid) {
  switch (solid.status) {
    case SolidStatus::open:
      return "open";
    case SolidStatus::invalid:
      return "invalid";
    case SolidStatus::empty:
      return "empty";
    case SolidStatus::ok:
      break;
  }
  return solid.closed ? "ok" : "open";
}

}  // namespace lamella
