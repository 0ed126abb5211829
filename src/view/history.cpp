// SPDX-License-Identifier: MIT
#include "spume/view/history.hpp"

#include <algorithm>

namespace spume {

void SeriesHistory::clear() {
  values_.clear();
  stride_ = 1;
  waiting_ = 0;
  ++edition_;
}

void SeriesHistory::add(std::span<const double> row) {
  if (row.size() != width_) {
    clear();
    width_ = row.size();
  }
  if (width_ == 0 || (waiting_ > 0 && waiting_-- > 1)) return;
  waiting_ = stride_;
  if (rows() == most_rows_) {
    const std::size_t kept = (rows() + 1) / 2;
    for (std::size_t k = 1; k < kept; ++k)
      std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(2 * k * width_), width_,
                  values_.begin() + static_cast<std::ptrdiff_t>(k * width_));
    values_.resize(kept * width_);
    stride_ *= 2;
    waiting_ = stride_;
    ++edition_;
  }
  values_.insert(values_.end(), row.begin(), row.end());
}

}  // namespace spume
