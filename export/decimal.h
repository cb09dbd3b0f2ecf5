#pragma once

#include <string>

namespace lamella {

/// Appends a length, mm, rounded to a nanometre and without trailing zeros: "12.05", "-0.000001", "0".
void append_decimal(std::string& out, double length);

}  // namespace lamella
