#include "export/decimal.h"

#include <fmt/format.h>
#include <iterator>

namespace lamella {

void append_decimal(std::string& out, double length) {
  const std::size_t begin = out.size();
  fmt::format_to(std::back_inserter(out), "{:.6f}", length);
  out.erase(out.find_last_not_of('0') + 1);
  if (out.back() == '.') out.pop_back();
  if (out.compare(begin, std::string::npos, "-0") == 0) out.erase(begin, 1);
}

}  // namespace lamella
