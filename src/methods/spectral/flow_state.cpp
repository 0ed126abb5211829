// SPDX-License-Identifier: MIT
// What a checkpoint holds of the flow.
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/spectral/flow.hpp"

namespace spume::spectral {

template <class T>
void Flow<T>::save(StateWriter& writer) const {
  const double scalars[] = {
      time_,          earlier_dt_,         peak_.speed,       peak_.rate,  integrated_gain_, integrated_dissipation_,
      budget_.energy, budget_.dissipation, budget_.injection, budget_.work};
  const std::int64_t counters[] = {steps_, has_history_ ? 1 : 0, static_cast<std::int64_t>(layout_.points[0]),
                                   static_cast<std::int64_t>(layout_.points[1]),
                                   static_cast<std::int64_t>(layout_.points[2])};
  writer.f64("scalars", scalars);
  writer.i64("counters", counters);
  writer.f64("lengths", layout_.lengths);
  const char* const axes[3] = {"x", "y", "z"};
  const auto put = [&](const std::string& name, const Modes<T>& set) {
    // Without the padding of rows and planes: the file does not depend on the precision or the vector width.
    Array<double> values(2 * layout_.points[0] * layout_.points[1] * layout_.modes_z);
    for (std::size_t c = 0; c < 3; ++c) {
      parallel_for(layout_.points[0] * layout_.points[1], [&](std::size_t line) {
        const Complex* from =
            &set[c][line / layout_.points[1] * layout_.plane + line % layout_.points[1] * layout_.row];
        double* to = &values[2 * line * layout_.modes_z];
        for (std::size_t iz = 0; iz < layout_.modes_z; ++iz) {
          to[2 * iz] = static_cast<double>(from[iz].real());
          to[2 * iz + 1] = static_cast<double>(from[iz].imag());
        }
      });
      writer.f64(name + "_" + axes[c], values);
    }
  };
  put("potential", potential_);
  if (has_history_) put("tendency", earlier_);
}

template <class T>
void Flow<T>::load(StateReader& reader) {
  Array<double> scalars, lengths;
  Array<std::int64_t> counters;
  reader.f64("scalars", scalars);
  reader.i64("counters", counters);
  reader.f64("lengths", lengths);
  const bool fits = scalars.size() == 10 && counters.size() == 5 && lengths.size() == 3 &&
                    counters[2] == static_cast<std::int64_t>(layout_.points[0]) &&
                    counters[3] == static_cast<std::int64_t>(layout_.points[1]) &&
                    counters[4] == static_cast<std::int64_t>(layout_.points[2]);
  if (!fits) throw FileError("the checkpoint was written on another grid or by another version of the method");
  const char* const axes[3] = {"x", "y", "z"};
  const auto get = [&](const std::string& name, Modes<T>& set) {
    Array<double> values;
    for (std::size_t c = 0; c < 3; ++c) {
      reader.f64(name + "_" + axes[c], values);
      if (values.size() != 2 * layout_.points[0] * layout_.points[1] * layout_.modes_z)
        throw FileError("the checkpoint's array '" + name + "' does not have one value per mode");
      parallel_for(layout_.points[0] * layout_.points[1], [&](std::size_t line) {
        Complex* to = &set[c][line / layout_.points[1] * layout_.plane + line % layout_.points[1] * layout_.row];
        const double* from = &values[2 * line * layout_.modes_z];
        for (std::size_t iz = 0; iz < layout_.modes_z; ++iz)
          to[iz] = {static_cast<T>(from[2 * iz]), static_cast<T>(from[2 * iz + 1])};
      });
    }
  };
  get("potential", potential_);
  has_history_ = counters[1] != 0;
  if (has_history_) get("tendency", earlier_);
  time_ = scalars[0];
  earlier_dt_ = scalars[1];
  peak_ = {scalars[2], scalars[3]};
  integrated_gain_ = scalars[4];
  integrated_dissipation_ = scalars[5];
  budget_ = {scalars[6], scalars[7], scalars[8], scalars[9]};
  steps_ = counters[0];
}

template void Flow<double>::save(StateWriter&) const;
template void Flow<float>::save(StateWriter&) const;
template void Flow<double>::load(StateReader&);
template void Flow<float>::load(StateReader&);

}  // namespace spume::spectral
