#include "slicing/rotation_words.h"

#include "core/xml.h"

namespace lamella {

std::string rotation_text(const Mat3& turn) {
  std::string out;
  for (int i = 0; i < 9; ++i) (out += i == 0 ? "" : " ") += format_double(turn(i / 3, i % 3));
  return out;
}

}  // namespace lamella
