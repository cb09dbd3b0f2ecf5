#pragma once

#include <cmath>

namespace lamella {

/// A running sum whose rounding error does not grow with the number of terms (Neumaier's form of Kahan's summation).
/// The result depends on the order of the terms in the last bit at most; sum in a fixed order for equal bytes.
class CompensatedSum {
 public:
  void add(double term) {
    const double sum = sum_ + term;
    // The low bits lost are those of the smaller of the two.
    lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
  }
  [[nodiscard]] double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0.0;
  double lost_ = 0.0;
};

}  // namespace lamella
