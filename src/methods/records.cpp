// SPDX-License-Identifier: MIT
#include "spume/methods/records.hpp"

namespace spume {

RecordTable spectrum_table() {
  return {"spectrum",
          "energy spectra",
          {{"t", "time"}, {"wavenumber", "1/length"}, {"energy", "velocity^2 length"}},
          RecordTable::When::spectrum};
}

void add_spectrum(double t, std::span<const double> wavenumber, std::span<const double> energy,
                  std::vector<double>& rows) {
  for (std::size_t i = 0; i < wavenumber.size(); ++i) rows.insert(rows.end(), {t, wavenumber[i], energy[i]});
}

}  // namespace spume
